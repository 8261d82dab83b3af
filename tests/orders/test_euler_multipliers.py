"""Claim: with explicit Euler the multiplier of a defect is the costate, to rounding.

Legend: λ_k multiplier of d_k = x_k + h f_k − x_{k+1}, P_k cost-to-go of the discrete regulator
with A_d = I + hA, B_d = hB, Q_d = hQ, R_d = hR. On it λ_k = P_{k+1} x_{k+1}.
"""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot.bank import regulator

N, T = 24, 1.5


def random_regulator(seed):
    random = np.random.default_rng(seed)
    A, B = random.normal(size=(3, 3)), random.normal(size=(3, 2))
    Q, R = random.normal(size=(3, 3)), random.normal(size=(2, 2))
    return A, B, Q @ Q.T, R @ R.T + np.eye(2), random.normal(size=3), Q @ Q.T / 2


def riccati(A, B, Q, R, Q_final):
    P = [Q_final]
    for _ in range(N):
        G = B.T @ P[0]
        P.insert(0, Q + A.T @ P[0] @ A - A.T @ G.T @ np.linalg.solve(R + G @ B, G @ A))
    return np.array(P)


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize(("objective", "weight"), [("integral", T / N), ("sum", 1.0)])
def test_the_multiplier_of_an_euler_defect_is_P_x_of_the_next_node(seed, objective, weight):
    A, B, Q, R, x0, Q_final = random_regulator(seed)
    solution = sk.solve(
        regulator(A, B, Q, R, x0, T, Q_final),
        sk.Euler(N, objective=objective),
        solver="ipopt",
        tolerance=1e-12,
    )
    h = T / N
    P = riccati(np.eye(3) + h * A, h * B, weight * Q, weight * R, Q_final)
    expected = np.einsum("kij,kj->ki", P[1:], solution.states[1:])
    np.testing.assert_allclose(solution.multipliers["defects"][:, 0], expected, atol=1e-9)
    assert solution.objective == pytest.approx(0.5 * x0 @ P[0] @ x0, rel=1e-10)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_node_costates_of_euler_are_P_x_at_the_node(seed):
    A, B, Q, R, x0, Q_final = random_regulator(seed)
    solution = sk.solve(regulator(A, B, Q, R, x0, T, Q_final), sk.Euler(N), tolerance=1e-12)
    h = T / N
    P = riccati(np.eye(3) + h * A, h * B, h * Q, h * R, Q_final)
    expected = np.einsum("kij,kj->ki", P, solution.states)
    np.testing.assert_allclose(solution.costates, expected, atol=1e-9)
