"""Claim: the bag is one that ROS tools open, and its message is the one they expect."""

from __future__ import annotations

import builtins

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from scipy.spatial.transform import Rotation

from export.flights import CERTIFIED, flown
from export.readers import read_ros2
from skyknot.errors import UserError
from skyknot.export import write_export

SOLUTION = flown("asymmetric path")


@pytest.fixture
def bag(tmp_path):
    return write_export(SOLUTION, tmp_path / "f.mcap", rate=20, certificate=CERTIFIED).path


def test_rosbags_reads_what_mcap_reads(bag):
    with AnyReader([bag]) as reader:
        kinds = {connection.topic: connection.msgtype for connection in reader.connections}
        (raw,) = [
            (connection.msgtype, content)
            for connection, _, content in reader.messages()
            if connection.topic == "/command/trajectory"
        ]
        trajectory = reader.deserialize(raw[1], raw[0])
    assert kinds == {
        "/command/trajectory": "trajectory_msgs/msg/MultiDOFJointTrajectory",
        "/skyknot/about": "std_msgs/msg/String",
    }
    places = [point.transforms[0].translation for point in trajectory.points]
    np.testing.assert_array_equal([[p.x, p.y, p.z] for p in places], read_ros2(bag).position)


def test_the_order_of_the_quaternion_is_x_y_z_w(bag):
    """The nose, turned by the message's quaternion as SciPy reads it, points along the motion of
    the nose in the trajectory."""
    read = read_ros2(bag)
    nose = Rotation.from_quat(read.quaternions[:, [1, 2, 3, 0]]).apply([1.0, 0, 0])
    phi, theta, psi = SOLUTION.trajectory.state(read.times)[:, 6:9].T
    assert np.ptp(phi) > 0
    truth = [np.cos(theta) * np.sin(psi), np.cos(theta) * np.cos(psi), np.sin(theta)]
    np.testing.assert_allclose(nose, np.stack(truth, axis=1), atol=1e-8)


def test_twists_are_derivatives_of_poses_in_the_header_frame(bag):
    read = read_ros2(bag)
    step = read.times[1] - read.times[0]
    turn = Rotation.from_quat(read.quaternions[:, [1, 2, 3, 0]])
    world = (turn[2:] * turn[:-2].inv()).as_rotvec() / (2 * step)
    np.testing.assert_allclose(world, read.world_rates[1:-1], atol=1e-3)
    moved = (read.position[2:] - read.position[:-2]) / (2 * step)
    np.testing.assert_allclose(moved, read.velocity[1:-1], atol=1e-9)


def test_without_rosbags_the_extra_is_named(tmp_path, monkeypatch):
    real = builtins.__import__

    def without(name, *rest):
        if name.startswith("rosbags"):
            raise ImportError(f"No module named '{name}'")
        return real(name, *rest)

    monkeypatch.setattr("importlib.import_module", without)
    with pytest.raises(UserError, match="ROS 2 bag needs a library") as caught:
        write_export(SOLUTION, tmp_path / "f.mcap", certificate=CERTIFIED)
    assert "pip install 'skyknot[export]'" in caught.value.do
    assert not any(tmp_path.iterdir())
