"""Claim: samples are the trajectory's own values, at the times asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from export.flights import DURATION, flown
from report.gallery import flight, rail
from skyknot.errors import UserError
from skyknot.export.frames import rotated
from skyknot.export.samples import rate_derivative, sample_times, sampled

TICK = 1e-3


@pytest.mark.parametrize(("rate", "count"), [(10.0, 41), (1.0, 5), (0.1, 2), (3.0, 13)])
def test_samples_come_at_the_rate_and_end_with_the_flight(rate, count):
    times = sample_times(flown("asymmetric path").trajectory, rate)
    assert len(times) == count
    assert (times[0], times[-1]) == (0.0, DURATION)
    np.testing.assert_allclose(np.diff(times)[:-1], 1 / rate, rtol=1e-9)


def test_without_a_rate_samples_are_the_nodes():
    trajectory = flown("pure yaw").trajectory
    np.testing.assert_array_equal(sample_times(trajectory, None), trajectory.times)


@pytest.mark.parametrize("rate", [30.0, 7.0, 400.0])
def test_times_can_be_whole_milliseconds(rate):
    trajectory = flight("wrench").trajectory
    times = sample_times(trajectory, rate, TICK)
    np.testing.assert_allclose(times / TICK, np.round(times / TICK), atol=1e-6)
    assert np.all(np.diff(times) > 0)
    assert trajectory.times[-1] - TICK < times[-1] <= trajectory.times[-1]


@pytest.mark.parametrize("rate", [0.0, -3.0, float("nan"), float("inf"), 1e9])
def test_a_rate_that_cannot_be_is_refused(rate):
    with pytest.raises(UserError, match="rate cannot be sampled"):
        sample_times(flown("pure yaw").trajectory, rate)


def test_a_flight_that_starts_late_is_told_from_its_start():
    late, early = flown("asymmetric path", offset=100.0), flown("asymmetric path")
    a, b = (sampled(s, sample_times(s.trajectory, 5.0)) for s in (late, early))
    np.testing.assert_allclose(a.times, b.times, atol=1e-12)
    np.testing.assert_allclose(a.position, b.position, atol=1e-9)


def test_derivatives_agree_with_differences_inside_a_segment():
    trajectory = flight("wrench").trajectory
    middle = 0.5 * (trajectory.times[:-1] + trajectory.times[1:]) + 0.01
    step = 1e-4
    before, after = trajectory.state_rate(middle - step), trajectory.state_rate(middle + step)
    first = rate_derivative(trajectory, middle, 1)
    np.testing.assert_allclose(first, (after - before) / (2 * step), atol=1e-6)
    here = trajectory.state_rate(middle)
    second = rate_derivative(trajectory, middle, 2)
    np.testing.assert_allclose(second, (after - 2 * here + before) / step**2, atol=1e-3)


@pytest.mark.parametrize("model", ["wrench", "rotor", "yaw"])
def test_thrust_and_gravity_make_the_acceleration(model):
    """Newton's law at the nodes, where the scheme meets the dynamics: m a = m g − T R e3."""
    solution = flight(model)
    craft = solution.problem.vehicle
    found = sampled(solution, solution.times)
    down = np.tile([0.0, 0.0, 1.0], (len(found.times), 1))
    push = rotated(found.attitude.quaternions, down) * (found.thrust / craft.mass)[:, None]
    np.testing.assert_allclose(found.acceleration, craft.gravity * down - push, atol=1e-6)
    np.testing.assert_allclose(found.rotor_thrusts.sum(axis=1), found.thrust, rtol=1e-12)


@pytest.mark.parametrize("model", ["wrench", "rotor", "yaw"])
def test_torques_make_the_angular_acceleration(model):
    """Euler's law: I ω' + ω × I ω = the torques of the rotors."""
    solution = flight(model)
    craft = solution.problem.vehicle
    found = sampled(solution, solution.times)
    inertia, omega = np.array(craft.inertia), found.attitude.rates
    torque = inertia * found.attitude.accelerations + np.cross(omega, inertia * omega)
    wrench = found.rotor_thrusts @ craft.allocation.matrix.T
    np.testing.assert_allclose(torque, wrench[:, 1:], atol=1e-9)


def test_the_gap_is_what_straight_lines_miss():
    solution = flown("asymmetric path")
    coarse = sampled(solution, sample_times(solution.trajectory, 1.0))
    assert coarse.gap == pytest.approx(np.linalg.norm([1.0, 0.25, -0.5]) / 8, rel=1e-6)
    fine = sampled(solution, sample_times(solution.trajectory, 100.0))
    assert fine.gap == pytest.approx(coarse.gap / 1e4, rel=1e-3)


def test_without_a_vehicle_a_point_has_no_attitude_and_no_thrust():
    point = sampled(replace(flight("yaw"), problem=None), flight("yaw").times)
    assert (point.attitude, point.thrust, point.rotor_thrusts) == (None, None, None)
    body = sampled(replace(flight("wrench"), problem=None), flight("wrench").times)
    assert body.rotor_thrusts is None
    assert body.attitude is not None
    assert body.thrust is not None


def test_what_is_no_flight_is_refused():
    with pytest.raises(UserError, match="not a flight"):
        sampled(rail(), rail().times)


def test_a_flight_in_other_axes_is_refused():
    solution = flown("pure yaw")
    turned = replace(solution, record=replace(solution.record, frame="ENU"))
    with pytest.raises(UserError, match="frame ENU"):
        sampled(turned, turned.times)
