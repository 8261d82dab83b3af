"""Claim: lifted states and controls fly the flat path they came from."""

from __future__ import annotations

import casadi
import newton_euler
import numpy as np
import pytest
from craft import GRAVITY, sample_vehicle
from numpy.polynomial import Polynomial

from skyknot.errors import UserError
from skyknot.models import lift

NAMES = ("position", "velocity", "acceleration", "jerk", "snap")


def smooth_path(seed):
    """Return four polynomials of degree 7 in time on [0, 1]: x, y, z and yaw."""
    random = np.random.default_rng(seed)
    return [Polynomial(random.normal(size=8) * [1, 1, 1, 0.6, 0.4, 0.2, 0.1, 0.05]) for _ in "xyzw"]


def flat_outputs(path, times):
    samples = {
        name: np.column_stack([axis.deriv(order)(times) for axis in path[:3]])
        for order, name in enumerate(NAMES)
    }
    for order, name in enumerate(("yaw", "yaw_rate", "yaw_acceleration")):
        samples[name] = path[3].deriv(order)(times)
    return samples


def lifted(path, times):
    return lift(sample_vehicle(), **flat_outputs(path, times))


def differentiated_states(path):
    """Return t -> (x, dx/dt), differentiated exactly by CasADi from path and thrust direction."""
    t = casadi.SX.sym("t")
    x, y, z, yaw = (sum(c * t**k for k, c in enumerate(axis.coef)) for axis in path)
    position = casadi.vertcat(x, y, z)
    velocity = casadi.jacobian(position, t)
    down = casadi.vertcat(0, 0, GRAVITY) - casadi.jacobian(velocity, t)
    along = casadi.cos(yaw) * down[0] + casadi.sin(yaw) * down[1]
    right = casadi.cos(yaw) * down[1] - casadi.sin(yaw) * down[0]
    pitch = casadi.atan(along / down[2])
    roll = -casadi.asin(right / casadi.norm_2(down))
    angles = casadi.vertcat(roll, pitch, yaw)
    rates = casadi.jacobian(angles, t)
    sf, cf, st, ct = casadi.sin(roll), casadi.cos(roll), casadi.sin(pitch), casadi.cos(pitch)
    omega = casadi.vertcat(
        rates[0] - st * rates[2],
        cf * rates[1] + sf * ct * rates[2],
        cf * ct * rates[2] - sf * rates[1],
    )
    states = casadi.vertcat(position, velocity, angles, omega)
    return casadi.Function("states", [t], [states, casadi.jacobian(states, t)])


@pytest.mark.parametrize("seed", range(6))
def test_lifted_states_and_controls_satisfy_the_dynamics(seed):
    path, times, vehicle = smooth_path(seed), np.linspace(0.0, 1.0, 21), sample_vehicle()
    states, controls = lifted(path, times)
    exact = differentiated_states(path)
    for time, x, u in zip(times, states, controls, strict=True):
        expected, rate = (value.full().ravel() for value in exact(time))
        np.testing.assert_allclose(x, expected, rtol=1e-9, atol=1e-11)
        np.testing.assert_allclose(np.array(vehicle.dynamics(x, u)), rate, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_thrust_and_attitude_make_the_asked_acceleration_exactly(seed):
    path, times, vehicle = smooth_path(seed), np.linspace(0.0, 1.0, 11), sample_vehicle()
    states, controls = lifted(path, times)
    for row, x, u in zip(flat_outputs(path, times)["acceleration"], states, controls, strict=True):
        body = (vehicle.mass, vehicle.inertia, vehicle.gravity)
        np.testing.assert_allclose(newton_euler.derivative(x, u, *body)[3:6], row, atol=1e-12)


def test_standing_still_lifts_to_hover():
    zeros = np.zeros((4, 3))
    states, controls = lift(
        sample_vehicle(),
        np.tile([1.0, 2.0, -3.0], (4, 1)),
        *[zeros] * 4,
        np.full(4, 0.7),
        *[np.zeros(4)] * 2,
    )
    np.testing.assert_allclose(controls, np.tile(sample_vehicle().hover, (4, 1)), atol=1e-14)
    expected = np.array([1, 2, -3, 0, 0, 0, 0, 0, 0.7, 0, 0, 0])
    np.testing.assert_allclose(states, np.tile(expected, (4, 1)), atol=1e-14)


def test_a_level_circle_banks_by_the_textbook_angle():
    radius, speed = 5.0, 6.0
    rate = speed / radius
    t = np.linspace(0.0, 4.0, 33)
    powers = [radius * rate**order for order in range(5)]
    samples = {
        name: np.column_stack(
            [
                powers[order] * np.cos(rate * t + order * np.pi / 2),
                powers[order] * np.sin(rate * t + order * np.pi / 2),
                np.zeros_like(t),
            ]
        )
        for order, name in enumerate(NAMES)
    }
    yaw = rate * t + np.pi / 2  # nose along the flight path
    vehicle = sample_vehicle()
    states, controls = lift(
        vehicle,
        **samples,
        yaw=yaw,
        yaw_rate=np.full_like(t, rate),
        yaw_acceleration=np.zeros_like(t),
    )
    bank = np.arctan(speed**2 / (radius * vehicle.gravity))
    np.testing.assert_allclose(states[:, 6], bank, rtol=1e-12)  # turning right, rolled right
    np.testing.assert_allclose(states[:, 7], 0.0, atol=1e-12)
    np.testing.assert_allclose(controls[:, 0], vehicle.weight / np.cos(bank), rtol=1e-12)
    np.testing.assert_allclose(
        states[:, 9:], [[0, rate * np.sin(bank), rate * np.cos(bank)]] * 33, atol=1e-12
    )


def test_free_fall_and_horizontal_thrust_are_refused_with_the_sample():
    path = {name: np.zeros((3, 3)) for name in NAMES}
    yaw = {name: np.zeros(3) for name in ("yaw", "yaw_rate", "yaw_acceleration")}
    vehicle = sample_vehicle()
    path["acceleration"][1] = [0.0, 0.0, vehicle.gravity]
    with pytest.raises(UserError, match="free fall") as caught:
        lift(vehicle, **path, **yaw)
    assert caught.value.where == "acceleration, sample 1"
    path["acceleration"][1] = [5.0, 0.0, vehicle.gravity]
    with pytest.raises(UserError, match=r"90\.0 deg tilt"):
        lift(vehicle, **path, **yaw)


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("jerk", np.zeros((3, 2)), "jerk has the wrong shape"),
        ("yaw", np.zeros((3, 1)), "yaw has the wrong shape"),
        ("snap", np.full((3, 3), np.nan), "snap is not finite"),
        ("yaw_rate", np.zeros(4), "not sampled at the same times"),
    ],
)
def test_bad_samples_are_refused_by_name(name, value, sentence):
    good = {name: np.zeros((3, 3)) for name in NAMES}
    good |= {name: np.zeros(3) for name in ("yaw", "yaw_rate", "yaw_acceleration")}
    with pytest.raises(UserError, match=sentence):
        lift(sample_vehicle(), **(good | {name: value}))
