"""Claim: drag opposes motion relative to the air, axis by body axis, and is off by default."""

from __future__ import annotations

import casadi
import newton_euler
import numpy as np
import pytest
from craft import random_state, random_wrench, sample_vehicle

DRAG = (0.3, 0.2, 0.5)


@pytest.fixture
def point():
    random = np.random.default_rng(17)
    return random_state(random), random_wrench(random)


def test_zero_drag_is_equation_four_to_the_bit(point):
    plain = sample_vehicle().dynamics(*point)
    windy = sample_vehicle().wrench_model().with_wind([9.0, 9.0, 9.0]).dynamics(*point)
    assert [float(value) for value in plain] == [float(value) for value in windy]


def test_drag_agrees_with_independent_matrices(point):
    vehicle, wind = sample_vehicle(drag=DRAG), (3.0, -1.0, 0.5)
    body = (vehicle.mass, vehicle.inertia, vehicle.gravity)
    expected = newton_euler.derivative(*point, *body, DRAG, wind)
    found = vehicle.wrench_model().with_wind(wind).dynamics(*point)
    np.testing.assert_allclose(np.array(found, dtype=float), expected, rtol=1e-12)


def test_drag_takes_energy_from_motion_relative_to_the_air(point):
    x, u = point
    clean, dragging = sample_vehicle(), sample_vehicle(drag=DRAG).wrench_model()
    for wind in ([0.0, 0.0, 0.0], [5.0, -4.0, 2.0]):
        force = np.subtract(dragging.with_wind(wind).dynamics(x, u), clean.dynamics(x, u))[3:6]
        assert force @ (x[3:6] - wind) < 0.0


def test_air_moving_with_the_craft_makes_no_drag(point):
    x, u = point
    carried = sample_vehicle(drag=DRAG).wrench_model().with_wind(x[3:6].tolist())
    np.testing.assert_allclose(carried.dynamics(x, u), sample_vehicle().dynamics(x, u), atol=1e-14)


def test_a_level_craft_is_slowed_per_axis_by_its_own_coefficient():
    vehicle = sample_vehicle(drag=DRAG)
    for axis in range(3):
        x = np.zeros(12)
        x[3 + axis] = 2.0
        acceleration = vehicle.dynamics(x, vehicle.hover)[3 + axis]
        assert acceleration == pytest.approx(-DRAG[axis] * 2.0 / vehicle.mass)


def test_a_craft_turned_east_meets_the_east_wind_with_its_nose():
    x = np.zeros(12)
    x[8] = np.pi / 2
    model = sample_vehicle(drag=DRAG).wrench_model().with_wind([0.0, -3.0, 0.0])
    rates = model.dynamics(x, model.trim_control)
    assert rates[4] == pytest.approx(-DRAG[0] * 3.0 / model.mass)


def test_wind_may_be_a_casadi_parameter(point):
    wind = casadi.SX.sym("wind", 3)
    model = sample_vehicle(drag=DRAG).rotor_model()
    x, u = casadi.SX.sym("x", 12), casadi.SX.sym("u", 4)
    f = casadi.Function("f", [x, u, wind], [casadi.vertcat(*model.with_wind(wind).dynamics(x, u))])
    thrusts = [3.0, 4.0, 2.0, 5.0]
    expected = model.with_wind([1.0, 2.0, 3.0]).dynamics(point[0], thrusts)
    found = f(point[0], thrusts, [1.0, 2.0, 3.0]).full().ravel()
    np.testing.assert_allclose(found, np.array(expected, dtype=float), rtol=1e-12)
