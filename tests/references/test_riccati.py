"""Claim: on quadratic regulators ``solve`` gives what the Riccati equation gives.

Legend: P(t) cost-to-go matrix, J = ½ x0ᵀ P(0) x0, u = −R⁻¹BᵀP x, costate p = P x.
P(t) comes from the Hamiltonian flow [X; Y]' = [[A, −BR⁻¹Bᵀ], [−Q, −Aᵀ]] [X; Y], P = Y X⁻¹.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm, solve_continuous_are

import skyknot as sk
from skyknot.bank import regulator

A = np.array([[0.0, 1.0, 0.0], [-1.0, -0.3, 0.5], [0.2, 0.0, 0.4]])
B = np.array([[0.0, 0.1], [1.0, 0.0], [0.0, 1.0]])
Q = np.array([[2.0, 0.3, 0.0], [0.3, 1.0, 0.1], [0.0, 0.1, 0.5]])
R = np.array([[1.0, 0.2], [0.2, 0.5]])
X0 = np.array([1.0, -0.5, 0.8])
T = 2.0


def cost_to_go(t: float, Q_final: np.ndarray) -> np.ndarray:
    S = B @ np.linalg.solve(R, B.T)
    flow = expm(np.block([[A, -S], [-Q, -A.T]]) * (t - T))
    XY = flow @ np.vstack([np.eye(3), Q_final])
    return XY[3:] @ np.linalg.inv(XY[:3])


def solved(Q_final, segments=40):
    return sk.solve(
        regulator(A, B, Q, R, X0, T, Q_final),
        sk.HermiteSimpson(segments),
        solver="ipopt",
        tolerance=1e-10,
    )


def test_the_flow_used_here_solves_the_riccati_equation():
    def rate(_, p):
        P = p.reshape(3, 3)
        return -(A.T @ P + P @ A - P @ B @ np.linalg.solve(R, B.T @ P) + Q).ravel()

    backward = solve_ivp(rate, (T, 0), np.zeros(9), rtol=1e-10, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(backward.reshape(3, 3), cost_to_go(0, np.zeros((3, 3))), atol=1e-8)


def test_the_optimal_cost_over_a_finite_horizon_is_half_x_P_x():
    solution = solved(np.zeros((3, 3)))
    P = cost_to_go(0, np.zeros((3, 3)))
    assert solution.objective == pytest.approx(0.5 * X0 @ P @ X0, rel=1e-7)


def test_costates_are_P_x_all_along():
    solution = solved(np.zeros((3, 3)))
    expected = [
        cost_to_go(t, np.zeros((3, 3))) @ x
        for t, x in zip(solution.times, solution.states, strict=True)
    ]
    np.testing.assert_allclose(solution.costates, expected, atol=2e-6)


def test_controls_are_the_feedback_of_the_states():
    solution = solved(np.zeros((3, 3)), 80)
    t, x = solution.times[40], solution.states[40]
    u = -np.linalg.solve(R, B.T @ cost_to_go(t, np.zeros((3, 3))) @ x)
    np.testing.assert_allclose(solution.controls[40], u, atol=5e-4)


def test_the_stationary_terminal_weight_makes_the_horizon_infinite():
    P = solve_continuous_are(A, B, Q, R)
    solution = solved(P)
    assert solution.objective == pytest.approx(0.5 * X0 @ P @ X0, rel=1e-7)
    np.testing.assert_allclose(solution.costates, solution.states @ P, atol=2e-6)


@pytest.mark.parametrize(
    ("T", "P11", "P12"),
    [(1.0, 0.9648356849434979, 0.3895711205045925), (5.0, 1.730850599104355, 0.9989606790579709)],
)
def test_the_double_integrator_has_its_tabulated_cost(T, P11, P12):
    """Q = I, R = 1; entries of P(0) from the Hamiltonian flow in 30-digit arithmetic."""
    double = np.array([[0.0, 1.0], [0.0, 0.0]])
    problem = regulator(
        double, np.array([[0.0], [1.0]]), np.eye(2), np.eye(1), np.array([1.0, 0.0]), T
    )
    solution = sk.solve(problem, sk.HermiteSimpson(60), solver="ipopt", tolerance=1e-10)
    assert solution.objective == pytest.approx(0.5 * P11, rel=2e-6)
    np.testing.assert_allclose(solution.costates[0], [P11, P12], atol=2e-5)
