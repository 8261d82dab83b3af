"""Claim: ``solve`` finds the known optimum of the continuous problem, on a mesh fine enough."""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot import bank as problems
from skyknot.solvers import SOLVERS

# (problem, transcription, relative tolerance, why this tolerance)
CASES = {
    "hager": (problems.hager, sk.HermiteSimpson(40), 1e-8, "order 4"),
    "garg": (problems.garg, sk.HermiteSimpson(80), 1e-6, "order 4"),
    "scalar regulator": (problems.scalar_regulator, sk.HermiteSimpson(40), 1e-8, "order 4"),
    "van der pol": (problems.van_der_pol, sk.HermiteSimpson(80), 1e-5, "order 4, coarse"),
    "van der pol, bounds": (
        lambda: problems.van_der_pol(-0.25, 1.0),
        sk.HermiteSimpson(200),
        1e-4,
        "the bounds are entered and left inside segments",
    ),
    "brachistochrone": (problems.brachistochrone, sk.HermiteSimpson(40), 1e-8, "order 4"),
    "steering": (problems.steering, sk.HermiteSimpson(40), 1e-8, "order 4"),
    "cart-pole": (problems.cart_pole, sk.HermiteSimpson(80), 1e-7, "order 4"),
    "quadrotor transfer": (problems.quadrotor_transfer, sk.HermiteSimpson(40), 2e-5, "order 4"),
    "minimum time": (problems.minimum_time, sk.HermiteSimpson(80), 1e-4, "one switch, order 2"),
}


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("case", CASES)
def test_the_objective_is_the_known_optimum(case, solver):
    make, transcription, relative, _ = CASES[case]
    reference = make()
    solution = sk.solve(
        reference.problem, transcription, solver, guess=reference.guess, tolerance=1e-9
    )
    assert solution.success, solution.message
    assert solution.objective == pytest.approx(reference.optimum, rel=relative)


@pytest.mark.parametrize("segments", [1, 2, 3, 7])
@pytest.mark.parametrize("controls", ["quadratic", "linear"])
def test_the_cubic_of_least_energy_is_exact_on_any_mesh(segments, controls):
    reference = problems.minimum_energy()
    solution = sk.solve(
        reference.problem,
        sk.HermiteSimpson(segments, controls=controls),
        solver="ipopt",
        tolerance=1e-10,
    )
    t = np.linspace(0, 1, 50)
    assert solution.objective == pytest.approx(reference.optimum, rel=1e-13)
    np.testing.assert_allclose(solution.state(t), reference.state(t), atol=1e-13)
    np.testing.assert_allclose(solution.control(t), reference.control(t), atol=1e-12)
    costates = reference.costate(solution.times)
    np.testing.assert_allclose(solution.costates, costates, atol=1e-11)


def test_the_cubic_of_least_energy_is_exact_on_an_uneven_mesh():
    mesh = [0.0, 0.1, 0.15, 0.6, 1.0]
    solution = sk.solve(
        problems.minimum_energy().problem, sk.HermiteSimpson(mesh=mesh), tolerance=1e-10
    )
    assert solution.objective == pytest.approx(6.0, rel=1e-13)
    np.testing.assert_allclose(solution.times, mesh)


@pytest.mark.parametrize(("level", "contact"), [(1 / 9, True), (0.1, True), (0.2, False)])
def test_bryson_denham_follows_its_three_regimes(level, contact):
    reference = problems.bryson_denham(level)
    solution = sk.solve(reference.problem, sk.HermiteSimpson(60), tolerance=1e-9)
    assert solution.objective == pytest.approx(reference.optimum, rel=1e-4)
    assert solution.controls[0, 0] < 0
    on_bound = solution.times[solution.states[:, 0] > level - 1e-6]
    if contact:
        # the bound is met on [3l, 1 − 3l], to within a segment
        assert on_bound[0] == pytest.approx(3 * level, abs=1.5 / 60)
        assert on_bound[-1] == pytest.approx(1 - 3 * level, abs=1.5 / 60)
    else:
        np.testing.assert_allclose(on_bound, 0.5, atol=1.5 / 60)


def test_bryson_denham_unconstrained_costs_two():
    solution = sk.solve(problems.bryson_denham(0.3).problem, sk.HermiteSimpson(10), tolerance=1e-10)
    assert solution.objective == pytest.approx(2.0, rel=1e-9)


def test_the_time_optimal_control_is_bang_bang_with_one_switch():
    solution = sk.solve(problems.minimum_time().problem, sk.HermiteSimpson(60), tolerance=1e-9)
    controls = solution.controls[:, 0]
    extreme = np.minimum(np.abs(controls - 1), np.abs(controls + 2)) < 1e-4
    assert np.sum(~extreme) <= 2
    assert np.sum(np.diff(np.sign(controls[extreme])) != 0) == 1
    # switch at T b/(a + b)
    switch = solution.times[np.argmax(controls < 0)]
    assert switch == pytest.approx(np.sqrt(30) * 2 / 3, abs=2 * solution.times[1])


def test_a_mesh_with_a_node_on_the_switch_gives_the_exact_least_time():
    reference = problems.minimum_time()
    mesh = np.concatenate([np.linspace(0, 2 / 3, 5), np.linspace(2 / 3, 1, 4)[1:]])
    # With a held control the jump falls on the node, and both arcs are polynomials of degree 2.
    solution = sk.solve(
        reference.problem, sk.HermiteSimpson(controls="hold", mesh=mesh), tolerance=1e-10
    )
    assert solution.objective == pytest.approx(reference.optimum, rel=1e-9)


def test_the_hamiltonian_of_a_least_time_is_minus_one_all_along():
    """With J = t_f and autonomous dynamics, H = pᵀf = −∂J/∂t_f = −1 (Bryson & Ho, section 2.7)."""
    reference = problems.brachistochrone()
    solution = sk.solve(
        reference.problem, sk.HermiteSimpson(60), guess=reference.guess, tolerance=1e-10
    )
    v, angle, p = solution.states[:, 2], solution.controls[:, 0], solution.costates
    rates = np.stack([v * np.sin(angle), -v * np.cos(angle), 9.80665 * np.cos(angle)], axis=1)
    np.testing.assert_allclose(np.sum(p * rates, axis=1), -1, atol=1e-6)


def test_the_first_costate_is_the_slope_of_the_optimum():
    """p(0) = ∂J/∂x0, by central differences of the solver's own optima."""
    problem = problems.van_der_pol().problem

    def optimum(start):
        problem.initial_lower = problem.initial_upper = np.array(start)
        return sk.solve(problem, sk.HermiteSimpson(20), tolerance=1e-11)

    here = optimum([0.0, 1.0]).costates[0]
    step = 1e-4
    slopes = [
        (optimum(np.array([0.0, 1.0]) + d).objective - optimum(np.array([0.0, 1.0]) - d).objective)
        / (2 * step)
        for d in step * np.eye(2)
    ]
    np.testing.assert_allclose(here, slopes, rtol=1e-6)


SPECTRAL = {
    "hager": (sk.Lobatto(1, 16), 1e-13),
    "garg": (sk.Lobatto(1, 28), 1e-13),
    "minimum_energy": (sk.Radau(1, 4), 1e-13),
    "brachistochrone": (sk.Lobatto(1, 16), 1e-12),
    "steering": (sk.Radau(4, 12), 1e-9),
    "cart_pole": (sk.Lobatto(20, 9), 1e-10),
    "quadrotor_transfer": (sk.Lobatto(10, 9), 5e-10),
}


@pytest.mark.parametrize("name", SPECTRAL)
def test_a_few_long_segments_reach_the_smooth_optima(name):
    reference, (scheme, limit) = getattr(problems, name)(), SPECTRAL[name]
    solution = sk.solve(reference.problem, scheme, guess=reference.guess, tolerance=1e-11)
    assert solution.success, solution.message
    assert solution.objective == pytest.approx(reference.optimum, rel=limit, abs=limit)


@pytest.mark.parametrize(
    "scheme",
    [
        sk.Lobatto(mesh=[0, 2 / 3, 1], points=3, controls="discontinuous"),
        sk.Radau(mesh=[0, 2 / 3, 1], points=2),
    ],
)
def test_a_node_on_the_switch_makes_bang_bang_exact_where_controls_may_jump(scheme):
    reference = problems.minimum_time()
    solution = sk.solve(reference.problem, scheme, tolerance=1e-11)
    assert solution.objective == pytest.approx(reference.optimum, rel=1e-8)
    # Lobatto's two values on the switch count alike there: only their sum is fixed.
    if scheme.table.points[scheme.table.used[0]] > 0:
        jump = solution.control(solution.times[1] + np.array([-1e-6, 1e-6]))[:, 0]
        assert jump == pytest.approx([1.0, -2.0], abs=1e-5)
