"""Claim: whatever a default box allows can be flown by the rotors."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from craft import sample_vehicle

from skyknot.errors import UserError
from skyknot.models import Allocation, Limits, WrenchLimits

HEX_ANGLES = np.deg2rad([30, 90, 150, -150, -90, -30])
ALLOCATIONS = {
    "x": Allocation.x(0.2, 0.02),
    "unequal x": Allocation.x_levers(0.1, 0.25, 0.05),
    "plus": Allocation.plus(0.2, 0.01),
    "shifted": Allocation(
        ((0.3, 0.2), (-0.2, -0.2), (0.3, -0.2), (-0.2, 0.2)), (-1, -1, 1, 1), 0.02
    ),
    "hexarotor": Allocation(
        tuple((float(np.cos(a)), float(np.sin(a))) for a in HEX_ANGLES), (1, -1, 1, -1, 1, -1), 0.02
    ),
}


def corners(bounds):
    return np.array(list(itertools.product(*zip(*bounds, strict=True))))


@pytest.mark.parametrize("name", ALLOCATIONS)
def test_every_corner_of_the_wrench_box_is_within_rotor_limits(name):
    vehicle = sample_vehicle(allocation=ALLOCATIONS[name])
    thrusts = vehicle.rotor_thrusts(corners(vehicle.control_bounds))
    assert thrusts.min() >= vehicle.thrust_min - 1e-9
    assert thrusts.max() <= vehicle.thrust_max + 1e-9


@pytest.mark.parametrize("name", ALLOCATIONS)
def test_wrench_box_holds_hover_and_gives_every_torque_both_ways(name):
    vehicle = sample_vehicle(allocation=ALLOCATIONS[name])
    lower, upper = vehicle.control_bounds
    assert lower[0] < vehicle.weight < upper[0]
    assert np.all(upper[1:] > 0)
    np.testing.assert_array_equal(lower[1:], -upper[1:])


def test_hull_touches_what_the_rotors_can_do_and_holds_all_of_it():
    vehicle = sample_vehicle()
    lower, upper = vehicle.rotor_model().control_bounds
    wrenches = vehicle.allocation.wrench(corners((lower, upper)))
    np.testing.assert_allclose(wrenches.min(axis=0), vehicle.wrench_hull[0], atol=1e-12)
    np.testing.assert_allclose(wrenches.max(axis=0), vehicle.wrench_hull[1], atol=1e-12)


def test_given_wrench_limits_are_taken_as_they_are():
    vehicle = sample_vehicle(wrench_limits=WrenchLimits((0.0, 24.0), (0.5, 0.5, 0.2)))
    np.testing.assert_array_equal(vehicle.control_bounds[0], [0.0, -0.5, -0.5, -0.2])
    np.testing.assert_array_equal(vehicle.control_bounds[1], [24.0, 0.5, 0.5, 0.2])


def test_rotor_model_under_rotor_thrusts_is_the_wrench_model_under_their_wrench():
    vehicle, random = sample_vehicle(), np.random.default_rng(1)
    x, f = random.uniform(-1, 1, 12), random.uniform(1, 8, 4)
    by_rotors = vehicle.rotor_model().dynamics(x, f)
    by_wrench = vehicle.dynamics(x, vehicle.allocation.wrench(f))
    np.testing.assert_allclose(by_rotors, by_wrench, rtol=1e-13)


def test_translational_accelerations_need_no_more_than_thrust_and_tilt():
    for limits in (Limits(), Limits(tilt=0.3)):
        vehicle = sample_vehicle(limits=limits)
        lower, upper = vehicle.translational_yaw_model().control_bounds
        force = np.array([0, 0, vehicle.gravity]) - corners((lower[:3], upper[:3]))
        thrust = vehicle.mass * np.linalg.norm(force, axis=1)
        tilt = np.arctan2(np.hypot(force[:, 0], force[:, 1]), force[:, 2])
        assert thrust.max() <= vehicle.control_bounds[1][0] * (1 + 1e-12)
        assert tilt.max() <= min(limits.tilt or np.inf, np.deg2rad(30)) + 1e-12


def test_limits_bound_velocity_angles_and_rates_with_up_negative():
    limits = Limits(speed=10.0, climb=4.0, descent=2.0, tilt=0.5, body_rates=(3.0, 2.0, 1.0))
    lower, upper = sample_vehicle(limits=limits).state_bounds
    np.testing.assert_array_equal(lower[3:], [-10, -10, -4, -0.5, -0.5, -np.inf, -3, -2, -1])
    np.testing.assert_array_equal(upper[3:], [10, 10, 2, 0.5, 0.5, np.inf, 3, 2, 1])
    assert np.all(np.isinf(lower[:3]))
    yaw_model = sample_vehicle(limits=limits).translational_yaw_model()
    np.testing.assert_array_equal(yaw_model.state_bounds[1][3:6], [10, 10, 2])


def test_a_craft_too_heavy_to_hover_is_refused():
    with pytest.raises(UserError, match="cannot hover within its rotor limits") as caught:
        sample_vehicle(thrust_max=3.0)
    assert "between 0.1 and 3 N" in caught.value.expected
