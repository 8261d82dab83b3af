"""Claim: the gains of a solution are those of the Riccati equation, and steer back to the optimum.

Legend: x' = A x + B u, cost ½∫(xᵀQx + uᵀRu) + ½ xᵀQ_f x, P(t) from the Hamiltonian flow,
K(t) = R⁻¹BᵀP(t) (Bryson & Ho 1975, section 5.2).
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import skyknot as sk
from references.test_riccati import X0, A, B, Q, R, T, cost_to_go
from skyknot.bank import quadrotor_transfer, regulator

ONE = np.eye(3)


def exact_gains(times: np.ndarray) -> np.ndarray:
    return np.array([np.linalg.solve(R, B.T @ cost_to_go(t, ONE)) for t in times])


def error(scheme: sk.transcription.Transcription) -> float:
    solution = sk.solve(regulator(A, B, Q, R, X0, T, ONE), scheme, tolerance=1e-9)
    times = solution.times[:-1]  # nothing lies ahead of the last node
    return float(np.max(np.abs(solution.feedback(times) - exact_gains(times))))


SCHEMES = [
    (sk.HermiteSimpson, {"controls": "quadratic"}, 2, 1e-3),
    (sk.HermiteSimpson, {"controls": "linear"}, 2, 1e-3),
    (sk.HermiteSimpson, {"controls": "hold"}, 1, 0.1),
    (sk.Trapezoid, {"controls": "linear"}, 1, 0.1),
    (sk.Euler, {}, 1, 0.1),
    (sk.Lobatto, {"points": 4}, 3, 1e-5),
    (sk.Lobatto, {"points": 5, "controls": "discontinuous"}, 4, 1e-7),
    (sk.Chebyshev, {"points": 5}, 2, 1e-3),
    (sk.Radau, {"points": 3}, 1, 0.02),
]


@pytest.mark.parametrize(("door", "choice", "order", "limit"), SCHEMES)
def test_gains_of_a_regulator_approach_those_of_the_riccati_equation(door, choice, order, limit):
    coarse, fine = error(door(40, **choice)), error(door(80, **choice))
    assert coarse < limit
    assert np.log2(coarse / fine) > order - 0.15


def test_gains_between_nodes_follow_the_control_parametrisation() -> None:
    problem = regulator(A, B, Q, R, X0, T, ONE)
    held = sk.solve(problem, sk.Euler(10))
    np.testing.assert_array_equal(held.feedback([0.21, 0.39]), held.gains[[1, 1]])
    np.testing.assert_array_equal(held.feedback(T), held.gains[-1])
    for scheme in (sk.Trapezoid(10), sk.Lobatto(10, 4, controls="discontinuous")):
        solution = sk.solve(problem, scheme)
        middle = 0.5 * (solution.gains[1] + solution.gains[2])
        np.testing.assert_allclose(solution.feedback(0.3), middle, rtol=1e-12)


@pytest.mark.parametrize("scheme", [sk.Lobatto(1, 12), sk.Radau(10, 3, controls="linear")])
def test_gains_that_would_mislead_are_not_offered(scheme):
    solution = sk.solve(regulator(A, B, Q, R, X0, T, ONE), scheme)
    with pytest.raises(sk.UserError, match="no feedback gains") as caught:
        solution.feedback(0.0)
    assert "several segments" in caught.value.do


def scaled_regulator(state_scales, control_scales) -> sk.Problem:
    return sk.Problem(
        name="regulator",
        states=[sk.State(f"x{i}", scale=scale) for i, scale in enumerate(state_scales)],
        controls=[sk.Control(f"u{i}", scale=scale) for i, scale in enumerate(control_scales)],
        dynamics=lambda x, u: ca.mtimes(A, x) + ca.mtimes(B, u),
        horizon=T,
        initial=list(X0),
        running_cost=lambda x, u: ca.bilin(Q, x, x) / 2 + ca.bilin(R, u, u) / 2,
    )


def test_gains_are_in_the_users_units_whatever_the_scales() -> None:
    plain = sk.solve(scaled_regulator([1, 1, 1], [1, 1]), sk.HermiteSimpson(20))
    scaled = sk.solve(scaled_regulator([2, 5, 0.1], [3, 0.5]), sk.HermiteSimpson(20))
    np.testing.assert_allclose(scaled.gains, plain.gains, atol=1e-9)


def test_a_warm_start_at_the_optimum_has_the_same_gains() -> None:
    problem = regulator(A, B, Q, R, X0, T, ONE)
    first = sk.solve(problem, sk.HermiteSimpson(20), tolerance=1e-8)
    again = sk.solve(problem, sk.HermiteSimpson(20), guess=first, tolerance=1e-6)
    assert again.iterations == 0
    np.testing.assert_allclose(again.gains, first.gains, atol=1e-8)


def test_a_failed_solve_offers_no_gains() -> None:
    problem = regulator(A, B, Q, R, X0, T, ONE)
    stopped = sk.solve(problem, sk.HermiteSimpson(20), solver={"max_iterations": 0})
    assert stopped.gains is None
    with pytest.raises(sk.UserError, match="no feedback gains"):
        stopped.feedback(0.0)


def flown(solution: sk.Solution, start: np.ndarray, closed: bool) -> np.ndarray:
    """Return the final state of a flight from ``start``, with or without feedback."""
    problem = solution.problem
    x, u = ca.SX.sym("x", problem.nx), ca.SX.sym("u", problem.nu)
    rates = ca.Function("f", [x, u], [problem.rates_of(x, u, {}, 0.0)])

    def rate(t, at):
        control = solution.control(t)
        if closed:
            control = control - solution.feedback(t) @ (at - solution.state(t))
        return np.asarray(rates(at, control)).ravel()

    T = solution.times[-1]
    return solve_ivp(rate, (0, T), start, max_step=T / 100, rtol=1e-7, atol=1e-9).y[:, -1]


def test_feedback_contracts_a_perturbed_quadrotor_flight() -> None:
    reference = quadrotor_transfer()
    craft, target = reference.problem, np.asarray(reference.guess.states[-1])

    def off(x):
        return ca.dot(x - ca.DM(target), x - ca.DM(target))

    problem = sk.Problem(
        name="transfer",
        states=craft.states,
        controls=craft.controls,
        dynamics=craft.dynamics,
        horizon=4.0,
        initial=[0.0] * 12,
        running_cost=lambda x, u: off(x) + craft.running_cost(x, u),
        terminal_cost=lambda x, tf: 10 * off(x),
        control_bounds=(0.0, 10.0),
        target=target,
    )
    solution = sk.solve(problem, sk.HermiteSimpson(60))
    assert solution.success
    start = solution.states[0]
    pushed = start + np.r_[0.2, -0.1, 0.1, 0.1, 0.1, -0.1, 0.05, 0.05, 0.05, np.zeros(3)]
    left = {
        closed: np.linalg.norm(flown(solution, pushed, closed) - flown(solution, start, closed))
        for closed in (True, False)
    }
    assert left[True] < 0.2 * np.linalg.norm(pushed - start)
    assert left[True] < 0.1 * left[False]
