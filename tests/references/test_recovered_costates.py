"""Claim: costates recovered from multipliers are those of closed forms, for every scheme.

Legend: p costate with H = ℓ + pᵀf; on a regulator p = P(t) x with Ṗ = −Q − AᵀP − PA + PBR⁻¹BᵀP,
read here from the exponential of the Hamiltonian matrix, [x; p]' = [A, −BR⁻¹Bᵀ; −Q, −Aᵀ] [x; p].
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import skyknot as sk
from skyknot import bank as problems
from skyknot.bank import regulator

T = 1.5
GLOBAL = {
    "lobatto": (sk.Lobatto(1, 24), 1e-10),
    "lobatto, hp": (sk.Lobatto(6, 9), 1e-10),
    "lobatto, discontinuous": (sk.Lobatto(6, 9, controls="discontinuous"), 1e-10),
    "radau": (sk.Radau(1, 24), 1e-10),
    "radau, hp": (sk.Radau(6, 8), 1e-9),
    # Clenshaw and Curtis's weights: h⁴ at the nodes, h² inside, however many points
    "chebyshev, hp": (sk.Chebyshev(60, 7), 1e-4),
}


def random_regulator():
    random = np.random.default_rng(5)
    A, B = random.normal(size=(3, 3)), random.normal(size=(3, 2))
    Q, R = random.normal(size=(3, 3)), random.normal(size=(2, 2))
    A, Q, R, x0 = 0.5 * A, Q @ Q.T, R @ R.T + np.eye(2), random.normal(size=3)
    Q_final = 0.5 * Q
    H = np.block([[A, -B @ np.linalg.solve(R, B.T)], [-Q, -A.T]])
    end = expm(H * T)
    # p(T) = Q_final x(T) fixes p(0)
    left = end[3:, 3:] - Q_final @ end[:3, 3:]
    p0 = np.linalg.solve(left, (Q_final @ end[:3, :3] - end[3:, :3]) @ x0)
    first = np.concatenate([x0, p0])
    return (
        regulator(A, B, Q, R, x0, T, Q_final),
        lambda t: np.array([expm(H * s) @ first for s in np.atleast_1d(t)])[:, 3:],
    )


def interior_times(solution):
    places = solution.trajectory.segments.interior_points
    return solution.times[:-1, None] + np.diff(solution.times)[:, None] * places


def errors(solution, costate):
    t = interior_times(solution)
    inside = solution.interior_costates.reshape(t.size, -1) - costate(t.ravel())
    dense = np.linspace(0, solution.times[-1], 57)
    return (
        np.abs(solution.costates - costate(solution.times)).max(),
        np.abs(inside).max(),
        np.abs(solution.costate(dense) - costate(dense)).max(),
    )


@pytest.mark.parametrize("solver", ["interior-point", "ipopt"])
@pytest.mark.parametrize("scheme", GLOBAL)
def test_costates_of_a_regulator_are_P_x(scheme, solver):
    problem, costate = random_regulator()
    transcription, limit = GLOBAL[scheme]
    solution = sk.solve(problem, transcription, solver, tolerance=1e-12)
    assert max(errors(solution, costate)) < limit


@pytest.mark.parametrize("scheme", [name for name in GLOBAL if "chebyshev" not in name])
def test_costates_of_a_nonlinear_problem_are_the_closed_form(scheme):
    reference = problems.garg()
    solution = sk.solve(
        reference.problem, GLOBAL[scheme][0], guess=reference.guess, tolerance=1e-12
    )
    assert max(errors(solution, reference.costate)) < 1e-8


@pytest.mark.parametrize(
    "scheme", [sk.HermiteSimpson(40), sk.Lobatto(10, 4), sk.Radau(10, 3), sk.Chebyshev(30, 5)]
)
def test_each_control_minimises_the_hamiltonian_with_the_costate_of_its_point(scheme):
    """With ½u² + … and ẋ = … + u the minimum is u = −p: the mapping's own identity, to rounding."""
    solution = sk.solve(problems.hager().problem, scheme, tolerance=1e-12)
    inside = solution.trajectory.segments
    places = np.isin(inside.control_points, inside.interior_points)
    u = inside.control_values[:, places]
    np.testing.assert_allclose(u, -solution.interior_costates, atol=1e-11)


def test_a_scheme_without_interior_points_has_no_interior_costates():
    solution = sk.solve(problems.hager().problem, sk.Trapezoid(10))
    assert solution.interior_costates.shape == (10, 0, 1)
    np.testing.assert_allclose(solution.costate(solution.times), solution.costates)
    assert solution.costate(0.25).shape == (1,)


def test_the_first_costate_is_the_slope_of_the_optimum():
    """dJ/dx₀ = p(0), by central differences of the optimum itself."""
    reference, step, values = problems.garg(), 1e-4, []
    for shift in (step, -step, 0.0):
        problem = sk.Problem(
            "garg, shifted",
            ["y"],
            ["u"],
            reference.problem.dynamics,
            horizon=2.0,
            initial=[1.0 + shift],
            terminal_cost=lambda y, tf: -y[0],
        )
        values.append(sk.solve(problem, sk.Radau(8, 4), guess=reference.guess, tolerance=1e-12))
    slope = (values[0].objective - values[1].objective) / (2 * step)
    assert values[2].costates[0, 0] == pytest.approx(slope, rel=1e-6)


def test_a_solution_without_its_scheme_says_so():
    solution = replace(sk.solve(problems.hager().problem, sk.Trapezoid(4)), witness=None)
    with pytest.raises(sk.UserError, match="does not carry its scheme") as caught:
        solution.costate(0.0)
    assert "Solve again" in caught.value.do
