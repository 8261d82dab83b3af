"""Claim: Ipopt is told the program as it is, warm where possible, and stops on Ctrl-C."""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from agreement.variants import ALL_SCHEMES, CASES, PROBLEMS, program_of, random_point
from skyknot import bank as problems
from skyknot.kernel.evaluation import evaluate, residuals
from skyknot.kernel.program import Multipliers
from skyknot.solvers.nonlinear_program import nonlinear_program
from solvers.probes import status_after_ctrl_c

CART_POLE = problems.cart_pole().problem
MESH = sk.HermiteSimpson(20)


def test_ctrl_c_during_the_solve_returns_an_interrupted_solution():
    assert status_after_ctrl_c("sk.Ipopt(max_iterations=5000)") == "interrupted"


@pytest.mark.parametrize(
    ("name", "reason"), [("nonsense", "does not know"), ("ma57", "not installed")]
)
def test_a_linear_solver_that_is_not_there_is_a_user_error(name, reason):
    with pytest.raises(sk.UserError, match="cannot use this linear solver") as caught:
        sk.solve(CART_POLE, MESH, sk.Ipopt(linear_solver=name))
    assert name in caught.value.found
    assert reason in caught.value.found


@pytest.mark.parametrize("settings", [{"max_iterations": -1}, {"max_seconds": 0.0}])
def test_settings_without_room_to_iterate_are_refused(settings):
    with pytest.raises(sk.UserError, match="needs room to iterate"):
        sk.Ipopt(**settings)


def test_the_graph_written_out_gives_the_same_answer():
    mapped = sk.solve(CART_POLE, MESH, sk.Ipopt(), tolerance=1e-10)
    expanded = sk.solve(CART_POLE, MESH, sk.Ipopt(expand=True), tolerance=1e-10)
    assert expanded.objective == pytest.approx(mapped.objective, rel=1e-12)


def test_work_is_counted():
    solution = sk.solve(CART_POLE, MESH, "ipopt")
    assert solution.record.work["hessian"] == solution.iterations
    assert all(count > 0 for count in solution.record.work.values())
    assert len(solution.history) == solution.iterations + 1


@pytest.mark.parametrize(("problem", "scheme"), CASES)
def test_multipliers_go_down_to_the_graph_and_come_back(problem, scheme):
    program = program_of(PROBLEMS[problem], ALL_SCHEMES[scheme])
    z, m = random_point(program, seed=8)
    m.rates[(m.rates > 0) & ~np.isfinite(program.rates.upper)] = 0.0
    m.rates[(m.rates < 0) & ~np.isfinite(program.rates.lower)] = 0.0
    nlp = nonlinear_program(program)
    scaled = z[nlp.kept] / nlp.scale, m.bounds[nlp.kept] * nlp.scale
    back = nlp.lifted(*scaled, nlp.lowered(m))[1]
    np.testing.assert_allclose(back.defects[:, -1], m.defects[:, -1])
    np.testing.assert_allclose(back.path, m.path)
    np.testing.assert_allclose(back.rates, m.rates)
    free = program.lower < program.upper
    kept = np.zeros_like(free)
    kept[nlp.kept] = True
    np.testing.assert_allclose(back.bounds[free & kept], m.bounds[free & kept])


@pytest.mark.parametrize("form", ["separated", "compressed"])
@pytest.mark.parametrize(
    "name", ["cart_pole", "bryson_denham", "minimum_time", "quadrotor_transfer"]
)
def test_a_solution_as_the_guess_needs_at_most_two_iterations(name, form):
    reference, mesh = getattr(problems, name)(), sk.HermiteSimpson(20, form=form)
    problem = reference.problem
    first = sk.solve(problem, mesh, "ipopt", guess=reference.guess)
    again = sk.solve(problem, mesh, "ipopt", guess=first)
    assert again.success
    assert again.iterations <= 2 < first.iterations
    assert again.objective == pytest.approx(first.objective, rel=1e-5)


def test_a_solution_on_another_mesh_is_a_guess_without_multipliers():
    coarse = sk.solve(CART_POLE, MESH, "ipopt")
    fine = sk.solve(CART_POLE, sk.HermiteSimpson(40), "ipopt", guess=coarse)
    assert fine.success
    assert fine.iterations < coarse.iterations


def test_fixed_variables_get_the_multipliers_that_make_the_gradient_vanish():
    solution = sk.solve(CART_POLE, MESH, "ipopt", tolerance=1e-9)
    program = MESH.program(CART_POLE, solution.trajectory)
    m = Multipliers(**solution.multipliers)
    found = residuals(program, solution.decision, m, evaluate(program, solution.decision))
    assert found.stationarity < 1e-7
    fixed = program.lower == program.upper
    assert np.count_nonzero(m.bounds[fixed]) == 8
