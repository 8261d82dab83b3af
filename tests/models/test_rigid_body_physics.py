"""Claim: the 12-state model is Newton's and Euler's, with NED signs, and nothing else."""

from __future__ import annotations

import newton_euler
import numpy as np
import pytest
from craft import GRAVITY, random_state, random_wrench, sample_vehicle
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

ANGLE = st.floats(-np.pi, np.pi)
TILT = st.floats(-1.3, 1.3)
SMALL = st.floats(-5.0, 5.0)
STATES = st.tuples(*[SMALL] * 6, TILT, TILT, ANGLE, *[SMALL] * 3).map(np.array)
WRENCHES = st.tuples(st.floats(0.0, 30.0), *[st.floats(-1.0, 1.0)] * 3).map(np.array)


@pytest.fixture
def vehicle():
    return sample_vehicle()


def integrate(vehicle, x0, u, duration):
    return solve_ivp(
        lambda _, x: np.array(vehicle.dynamics(x, u), dtype=float),
        (0.0, duration),
        x0,
        method="DOP853",
        rtol=1e-12,
        atol=1e-12,
        dense_output=True,
    )


@given(x=STATES, u=WRENCHES)
def test_dynamics_agree_with_independent_matrices(x, u):
    vehicle = sample_vehicle()
    expected = newton_euler.derivative(x, u, vehicle.mass, vehicle.inertia, vehicle.gravity)
    found = np.array(vehicle.dynamics(x, u), dtype=float)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-11)


def test_hover_stands_still(vehicle):
    rates = np.array(vehicle.dynamics(np.zeros(12), vehicle.hover), dtype=float)
    np.testing.assert_allclose(rates, 0.0, atol=1e-14)


def test_free_fall_goes_down_with_gravity(vehicle):
    fall = integrate(vehicle, np.zeros(12), np.zeros(4), 2.0).y[:, -1]
    assert fall[2] == pytest.approx(0.5 * GRAVITY * 4.0, rel=1e-10)  # z down is positive
    assert fall[5] == pytest.approx(GRAVITY * 2.0, rel=1e-10)
    np.testing.assert_allclose(np.delete(fall, [2, 5]), 0.0, atol=1e-12)


def test_excess_thrust_climbs_towards_negative_z(vehicle):
    rates = vehicle.dynamics(np.zeros(12), 1.5 * vehicle.hover)
    assert rates[5] == pytest.approx(-0.5 * GRAVITY)


def test_nose_down_flies_forward_and_right_roll_flies_right(vehicle):
    pitched, rolled = np.zeros(12), np.zeros(12)
    pitched[7], rolled[6] = -0.1, 0.1
    assert vehicle.dynamics(pitched, vehicle.hover)[3] == pytest.approx(GRAVITY * np.sin(0.1))
    assert vehicle.dynamics(rolled, vehicle.hover)[4] == pytest.approx(GRAVITY * np.sin(0.1))


@given(x=STATES, u=WRENCHES, shift=st.tuples(SMALL, SMALL, SMALL))
def test_translation_changes_nothing(x, u, shift):
    vehicle, moved = sample_vehicle(), x.copy()
    moved[:3] += shift
    np.testing.assert_array_equal(
        np.array(vehicle.dynamics(x, u)), np.array(vehicle.dynamics(moved, u))
    )


@given(x=STATES, u=WRENCHES, angle=ANGLE)
def test_turning_about_the_vertical_turns_the_motion(x, u, angle):
    vehicle, turn = sample_vehicle(drag=(0.2, 0.1, 0.3)), newton_euler.axis_rotation(2, angle)
    turned = x.copy()
    turned[:3], turned[3:6], turned[8] = turn @ x[:3], turn @ x[3:6], x[8] + angle
    before, after = np.array(vehicle.dynamics(x, u)), np.array(vehicle.dynamics(turned, u))
    np.testing.assert_allclose(after[:3], turn @ before[:3], atol=1e-10)
    np.testing.assert_allclose(after[3:6], turn @ before[3:6], atol=1e-10)
    np.testing.assert_allclose(after[6:], before[6:], atol=1e-9, rtol=1e-9)


def test_tumbling_without_torque_keeps_energy_and_angular_momentum(vehicle):
    x0 = np.zeros(12)
    x0[3:6], x0[9:] = [3.0, -1.0, -4.0], [1.0, 0.3, -2.0]
    inertia = np.array(vehicle.inertia)
    flight = integrate(vehicle, x0, np.zeros(4), 1.2)
    assert np.max(np.abs(flight.y[7])) < 1.5  # the tumble stays off the Euler singularity
    momenta, energies, spins = [], [], []
    for x in flight.sol(np.linspace(0.0, 1.2, 40)).T:
        omega = x[9:]
        momenta.append(newton_euler.attitude(x[6:9]) @ (inertia * omega))
        energies.append(0.5 * vehicle.mass * x[3:6] @ x[3:6] - vehicle.weight * x[2])
        spins.append(0.5 * omega @ (inertia * omega))
    assert np.ptp(np.array(flight.sol(1.2))[9:]) > 0.5  # it does tumble
    np.testing.assert_allclose(np.ptp(momenta, axis=0), 0.0, atol=1e-10)
    assert np.ptp(energies) < 1e-9
    assert np.ptp(spins) < 1e-11


def test_work_of_the_torque_is_the_gain_of_spin_energy(vehicle):
    u = np.array([0.0, 0.01, -0.004, 0.006])
    flight = integrate(vehicle, np.zeros(12), u, 1.0)
    times = np.linspace(0.0, 1.0, 2001)
    omega = flight.sol(times)[9:]
    power = u[1:] @ omega
    work = np.sum((power[:-2:2] + 4 * power[1:-1:2] + power[2::2]) / 6) * (times[2] - times[0])
    gained = 0.5 * omega[:, -1] @ (np.array(vehicle.inertia) * omega[:, -1])
    assert work == pytest.approx(gained, rel=1e-9)


def test_vectorised_and_single_evaluations_agree(vehicle):
    random = np.random.default_rng(5)
    states = np.array([random_state(random) for _ in range(7)])
    controls = np.array([random_wrench(random) for _ in range(7)])
    together = np.array(vehicle.dynamics(states.T, controls.T)).T
    alone = [vehicle.dynamics(x, u) for x, u in zip(states, controls, strict=True)]
    np.testing.assert_allclose(together, np.array(alone), rtol=1e-15, atol=1e-15)
