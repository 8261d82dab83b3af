"""Claim: the error estimate is the error: it has the right size, order and place."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import skyknot as sk
from skyknot.transcription.pointwise import PointFunctions
from skyknot.transcription.segment_error import segment_error, state_sizes


def pendulum(**extras):
    asked = {
        "name": "pendulum",
        "states": ["angle", "rate"],
        "controls": ["torque"],
        "dynamics": lambda x, u: [x[1], -sk_sin(x[0]) + u[0]],
        "horizon": 3.0,
        "initial": [0.0, 0.0],
        "final": [1.5, 0.0],
        "running_cost": lambda x, u: u[0] ** 2,
    }
    return sk.Problem(**(asked | extras))


def sk_sin(angle):
    return angle.sin()


def measured(problem, scheme):
    solution = sk.solve(problem, scheme, tolerance=1e-9)
    assert solution.success, solution.message
    functions = PointFunctions.of(problem)
    error = segment_error(
        problem, solution.trajectory, solution.record.parameters, functions, near=np.inf
    )
    return error, solution


def flown(solution, x, start, end):
    """Return the state at ``end`` when the solution's control is flown from x at ``start``."""

    def rates(t, x):
        u = solution.control(min(max(t, start), end - 1e-12 * end))
        return [x[1], -np.sin(x[0]) + u[0]]

    return solve_ivp(rates, (start, end), x, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]


SCHEMES = {
    "euler": (sk.Euler, 2, 2),
    "trapezoid": (sk.Trapezoid, 3, 3),
    "hermite-simpson": (sk.HermiteSimpson, 4, 5),
}


@pytest.mark.parametrize("name", SCHEMES)
def test_a_segments_miss_is_that_of_an_accurate_flight(name):
    make, _, _ = SCHEMES[name]
    error, solution = measured(pendulum(), make(12))
    t, sizes = solution.times, error.sizes
    for k in range(12):
        end = flown(solution, solution.states[k], t[k], t[k + 1])
        missed = (end - solution.states[k + 1]) / sizes
        np.testing.assert_allclose(error.missed[k], missed, rtol=0.02, atol=1e-10)


@pytest.mark.parametrize("name", SCHEMES)
def test_the_flight_is_that_of_the_whole_horizon(name):
    make, _, _ = SCHEMES[name]
    error, solution = measured(pendulum(), make(12))
    x = solution.states[0]
    for k in range(12):
        x = flown(solution, x, solution.times[k], solution.times[k + 1])
        np.testing.assert_allclose(
            error.apart[k + 1],
            (x - solution.states[k + 1]) / error.sizes,
            rtol=0.02,
            atol=0.02 * error.flight,
        )
    assert error.flight > 0


@pytest.mark.parametrize("name", SCHEMES)
def test_the_estimates_fall_with_the_order_that_refinement_counts_on(name):
    make, between, missed = SCHEMES[name]
    coarse, _ = measured(pendulum(), make(20))
    fine, _ = measured(pendulum(), make(40))
    orders = {
        "between": np.log2(coarse.between.max() / fine.between.max()),
        "missed": np.log2(np.abs(coarse.missed).max() / np.abs(fine.missed).max()),
    }
    assert orders["between"] == pytest.approx(between, abs=0.35)
    assert orders["missed"] == pytest.approx(missed, abs=0.35)


def test_the_integral_between_the_nodes_is_that_of_a_fine_quadrature():
    error, solution = measured(pendulum(), sk.HermiteSimpson(10))
    trajectory = solution.trajectory
    for k in range(10):
        edges = np.linspace(trajectory.times[k], trajectory.times[k + 1], 2001)
        t = 0.5 * (edges[1:] + edges[:-1])
        x, u, slope = trajectory.state(t), trajectory.control(t), trajectory.state_rate(t)
        rates = np.stack([x[:, 1], -np.sin(x[:, 0]) + u[:, 0]], axis=1)
        integral = np.sum(np.abs(slope - rates), axis=0) * (edges[1] - edges[0])
        np.testing.assert_allclose(
            error.between[k], integral / error.sizes, rtol=0.15, atol=0.05 * error.dynamics
        )


def test_the_sum_of_all_effects_bounds_the_flight():
    error, _ = measured(pendulum(), sk.HermiteSimpson(10))
    assert np.sum(error.effect) >= 0.95 * error.flight
    assert np.all(error.effect >= 0.999 * np.max(np.abs(error.missed), axis=1))


def test_a_linear_motion_with_a_quadratic_control_has_no_error_at_all():
    problem = sk.Problem(
        name="cart",
        states=["x", "v"],
        controls=["a"],
        dynamics=lambda x, u: [x[1], u[0]],
        horizon=1.0,
        initial=[0.0, 0.0],
        final=[1.0, 0.0],
        running_cost=lambda x, u: u[0] ** 2,
    )
    error, _ = measured(problem, sk.HermiteSimpson(3))
    assert error.missed == pytest.approx(0.0, abs=1e-12)
    assert error.flight < 1e-12


def test_limits_passed_between_the_nodes_are_seen_and_placed():
    wall = sk.PathConstraint("wall", lambda x, u: x[0], upper=0.2)
    problem = pendulum(path=[wall], final=[0.0, 0.0], initial=[0.0, 0.9])
    error, solution = measured(problem, sk.HermiteSimpson(6, enforce="nodes"))
    dense = np.linspace(0.0, 3.0, 4001)
    over = solution.state(dense)[:, 0] - 0.2
    assert over.max() > 1e-3
    assert error.constraints == pytest.approx(over.max(), rel=0.1)
    assert np.argmax(error.passed) == np.searchsorted(solution.times, dense[np.argmax(over)]) - 1


def test_limits_that_involve_controls_are_judged_by_their_mean():
    effort = sk.PathConstraint("effort", lambda x, u: u[0] + 0.3 * x[0], upper=0.4)
    problem = pendulum(path=[effort])
    error, solution = measured(problem, sk.HermiteSimpson(6, enforce="nodes"))
    dense = np.linspace(0.0, 3.0, 6 * 500 + 1)[:-1] + 3.0 / 6000
    over = solution.control(dense)[:, 0] + 0.3 * solution.state(dense)[:, 0] - 0.4
    means = np.maximum(over, 0.0).reshape(6, 500).mean(axis=1) / 0.4
    assert means.max() > 1e-3
    np.testing.assert_allclose(error.passed, means, rtol=0.1, atol=0.02 * means.max())


def test_sizes_are_those_given_else_one_more_than_the_largest_value():
    problem = pendulum(states=["angle", sk.State("rate", scale=50.0)])
    solution = sk.solve(problem, sk.HermiteSimpson(10))
    sizes = state_sizes(problem, solution.trajectory)
    assert sizes[0] == pytest.approx(1 + np.max(np.abs(solution.states[:, 0])))
    assert sizes[1] == 50.0


def test_a_flight_that_diverges_is_an_infinite_error():
    explosive = sk.Problem(
        name="explosive",
        states=["x"],
        controls=["u"],
        dynamics=lambda x, u: [x[0] ** 3 + u[0]],
        horizon=1.0,
        initial=[3.0],
    )
    N = 4
    times = np.linspace(0.0, 1.0, N + 1)
    segments = sk.trajectory.SegmentData(
        rate_points=np.array([0.0, 1.0]),
        rates=np.zeros((N, 2, 1)),
        control_points=np.array([0.0]),
        control_values=np.zeros((N, 1, 1)),
        interior_points=np.zeros(0),
        interior_states=np.zeros((N, 0, 1)),
    )
    held = sk.Trajectory(times, np.full((N + 1, 1), 3.0), np.zeros((N + 1, 1)), segments)
    error = segment_error(explosive, held, {}, PointFunctions.of(explosive), near=np.inf)
    assert error.flight == np.inf
    assert error.dynamics == np.inf
