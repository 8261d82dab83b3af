"""Claim: every file, read by another reader, tells the flight in the axes it says, as closely as
it says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from export.flights import CERTIFIED, MOTIONS, flown
from export.readers import HOME, READERS
from skyknot.export import FORMATS, Origin, write_export

P, D = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]]), np.diag([1.0, -1, -1])
AXES = {"ned": (np.eye(3), np.eye(3)), "enu": (P, D)}
CASES = [(name, frame) for name, known in FORMATS.items() for frame in known.frames or (None,)]
EXACT = {"position": 1e-12, "velocity": 1e-12, "attitude": 1e-12, "rates": 1e-12}
ACCURACY = {
    "csv": EXACT,
    "netcdf": EXACT,
    "plan": {"position": 1e-3, "yaw": 1e-5},
    "mavlink-position": {"position": 2e-6, "velocity": 1e-6, "yaw": 2e-7},
    "mavlink-attitude": {"attitude": 2e-7, "rates": 1e-7},
    "ros2": {"position": 1e-8, "velocity": 1e-8, "attitude": 1e-8, "rates": 1e-8},
    "geojson": {"position": 1e-4},
    "kml": {"position": 1e-4},
}
"""What each format promises: m, m/s, rad, rad/s."""

RATES = {"plan": 2.0}
"""Where a format would otherwise choose its own few points."""


@pytest.fixture(params=MOTIONS)
def motion(request):
    return flown(request.param)


def telling(quantity):
    """Return the decorator of a test of all formats that promise a quantity."""
    cases = [case for case in CASES if quantity in ACCURACY[case[0]]]
    names = ["-".join(filter(None, case)) for case in cases]
    return pytest.mark.parametrize("told", cases, ids=names, indirect=True)


@pytest.fixture
def told(request, motion, tmp_path):
    """Return what a reader finds, the states at its times, its axes, and what was promised."""
    name, frame = request.param
    path = tmp_path / FORMATS[name].file_name
    options = {"rate": RATES.get(name), "frame": frame, "origin": Origin(*HOME)}
    write_export(motion, path, name, certificate=CERTIFIED, **options)
    read = READERS[name](path)
    assert read.frame == (frame or "ned")
    return read, motion.trajectory.state(read.times), AXES[read.frame], ACCURACY[name]


def test_every_format_has_a_reader():
    assert set(READERS) == set(FORMATS) == set(ACCURACY)


@telling("position")
def test_positions(told):
    read, states, (world, _), promised = told
    assert len(read.times) > 4
    np.testing.assert_allclose(read.position @ world.T, states[:, :3], atol=promised["position"])


@telling("velocity")
def test_velocities_and_accelerations(told, motion):
    read, states, (world, _), promised = told
    accuracy = promised["velocity"]
    np.testing.assert_allclose(read.velocity @ world.T, states[:, 3:6], atol=accuracy)
    if read.acceleration is not None:
        rates = motion.trajectory.state_rate(read.times)
        np.testing.assert_allclose(read.acceleration @ world.T, rates[:, 3:6], atol=accuracy)


@telling("attitude")
def test_attitudes(told):
    read, states, (world, body), promised = told
    found = Rotation.from_quat(read.quaternions[:, [1, 2, 3, 0]]).as_matrix()
    truth = Rotation.from_euler("ZYX", states[:, [8, 7, 6]])
    apart = (Rotation.from_matrix(world.T @ found @ body) * truth.inv()).magnitude()
    assert apart.max() <= promised["attitude"]


@telling("rates")
def test_rates(told):
    read, states, (world, body), promised = told
    assert (read.rates is None) != (read.world_rates is None)
    if read.rates is not None:
        np.testing.assert_allclose(read.rates @ body.T, states[:, 9:12], atol=promised["rates"])
    if read.world_rates is not None:
        R = Rotation.from_euler("ZYX", states[:, [8, 7, 6]]).as_matrix()
        truth = np.einsum("mij,mj->mi", R, states[:, 9:12])
        np.testing.assert_allclose(read.world_rates @ world.T, truth, atol=promised["rates"])


@telling("yaw")
def test_headings(told, motion):
    read, states, _, promised = told
    apart = np.angle(np.exp(1j * (read.yaw - states[:, 8])))
    np.testing.assert_allclose(apart, 0.0, atol=promised["yaw"])
    if read.yaw_rate is not None:
        rates = motion.trajectory.state_rate(read.times)
        np.testing.assert_allclose(read.yaw_rate, rates[:, 8], atol=promised["yaw"])
