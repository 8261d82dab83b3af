"""A ROS 2 bag, one MCAP file: the flight as one MultiDOFJointTrajectory.

Axes are those of ROS REP 103: world ENU (header frame "map"), body FLU ("base_link"). Linear and
angular velocity and acceleration are all in the header's frame, as in ethz-asl/mav_comm, whose
conversions read angular_velocity_W. Quaternions are x, y, z, w. A second topic tells in JSON what
the first cannot: mission, certificate, axes. Written by rosbags, without ROS.
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.export.base import EPOCH, Encoded, Format, Request, optional
from skyknot.export.frames import (
    enu_attitude_from_ned,
    enu_from_ned,
    flu_from_frd,
    rotated,
    x_first,
)

Array = NDArray[np.float64]

TRAJECTORY_TOPIC, ABOUT_TOPIC = "/command/trajectory", "/skyknot/about"
TRAJECTORY, TEXT = "trajectory_msgs/msg/MultiDOFJointTrajectory", "std_msgs/msg/String"
WORLD, BODY = "map", "base_link"


def encode(request: Request) -> Encoded:
    """Return the bag; point i is to be reached ``time_from_start`` after the start."""
    rosbag2 = optional("rosbags.rosbag2", "Writing a ROS 2 bag")
    typesys = optional("rosbags.typesys", "Writing a ROS 2 bag")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    kinds = store.types
    about = kinds[TEXT](data=json.dumps(_about(request), ensure_ascii=False))
    messages = (
        (ABOUT_TOPIC, TEXT, about),
        (TRAJECTORY_TOPIC, TRAJECTORY, _trajectory(request, kinds)),
    )
    with tempfile.TemporaryDirectory() as folder:
        plugin = rosbag2.StoragePlugin.MCAP
        with rosbag2.Writer(Path(folder) / "bag", version=9, storage_plugin=plugin) as writer:
            for topic, kind, message in messages:
                connection = writer.add_connection(topic, kind, typestore=store)
                content = store.serialize_cdr(message, kind)
                writer.write(connection, int(EPOCH.timestamp()) * 10**9, content)
        (path,) = (Path(folder) / "bag").glob("*.mcap")
        return Encoded(path.read_bytes(), "double precision, times to a nanosecond")


def _about(request: Request) -> dict[str, str]:
    return {
        "mission": request.title,
        "certificate": request.verdict,
        "axes": f"'{WORLD}': x east, y north, z up; '{BODY}': x forward, y left, z up; "
        f"twists and accelerations, angular ones too, in '{WORLD}'",
        "units": "m, rad, s",
    }


def _trajectory(request: Request, kinds: dict[str, Any]) -> Any:
    flight = request.sampled
    assert flight.attitude is not None
    attitude = enu_attitude_from_ned(flight.attitude.quaternions)
    turning = (flight.attitude.rates, flight.attitude.accelerations)
    angular = [rotated(attitude, flu_from_frd(body)) for body in turning]
    linear = [enu_from_ned(world) for world in (flight.velocity, flight.acceleration)]
    columns = (
        *(enu_from_ned(flight.position), x_first(attitude)),
        *(linear[0], angular[0], linear[1], angular[1]),
    )
    kind = "builtin_interfaces/msg/Time"
    return kinds[TRAJECTORY](
        header=kinds["std_msgs/msg/Header"](stamp=kinds[kind](sec=0, nanosec=0), frame_id=WORLD),
        joint_names=[BODY],
        points=[
            _point(kinds, float(time), *row)
            for time, *row in zip(flight.times, *columns, strict=True)
        ],
    )


def _point(kinds: dict[str, Any], time: float, place: Array, turn: Array, *twists: Array) -> Any:
    velocity, rates, acceleration, angular = (_vector(kinds, entry) for entry in twists)
    seconds, nanoseconds = divmod(round(time * 1e9), 10**9)
    twist = kinds["geometry_msgs/msg/Twist"]
    x, y, z, w = (float(entry) for entry in turn)
    return kinds["trajectory_msgs/msg/MultiDOFJointTrajectoryPoint"](
        transforms=[
            kinds["geometry_msgs/msg/Transform"](
                translation=_vector(kinds, place),
                rotation=kinds["geometry_msgs/msg/Quaternion"](x=x, y=y, z=z, w=w),
            )
        ],
        velocities=[twist(linear=velocity, angular=rates)],
        accelerations=[twist(linear=acceleration, angular=angular)],
        time_from_start=kinds["builtin_interfaces/msg/Duration"](sec=seconds, nanosec=nanoseconds),
    )


def _vector(kinds: dict[str, Any], values: Array) -> Any:
    x, y, z = (float(entry) for entry in values)
    return kinds["geometry_msgs/msg/Vector3"](x=x, y=y, z=z)


ROS2 = Format(
    name="ros2",
    title="ROS 2 bag (MCAP) with a MultiDOFJointTrajectory",
    file_name="flight.mcap",
    encode=encode,
    frames=("enu",),
    rate=50.0,
    needs=("attitude",),
)
