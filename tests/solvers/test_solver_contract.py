"""Claim: every solver in the table keeps the numbered duties of ``solvers/base.py``."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from skyknot import bank as problems
from skyknot.solvers import SOLVERS
from solvers.probes import mover

CART_POLE = problems.cart_pole().problem
MESH = sk.HermiteSimpson(20)

REFUSED = {
    "projected-gradient": {
        "path constraint": {"path": [sk.PathConstraint("fence", lambda x, u: x[0], lower=0.1)]},
        "rate bound": {"rates": (-5.0, 5.0)},
    },
}
"""What a solver cannot hold, by the word it says so with: the only way out of the other duties."""


@pytest.fixture(params=SOLVERS)
def solver(request):
    return request.param


@pytest.fixture(params=[name for name in SOLVERS if "path constraint" not in REFUSED.get(name, {})])
def path_solver(request):
    return request.param


def limited(solver, **settings):
    return type(SOLVERS[solver]())(**settings)


def test_a_solver_finds_the_optimum_and_tells_its_name(solver):
    solution = sk.solve(problems.bryson_denham().problem, MESH, solver, tolerance=1e-9)
    assert solution.status == "solved"
    # Bryson–Denham on 20 segments with bounds at midpoints too lies a little above 4
    assert solution.objective == pytest.approx(4.0, rel=1e-2)
    assert solution.record.solver == solver
    assert solution.kkt_residual < 1e-7
    assert solution.record.work


def test_the_iteration_limit_returns_the_iterate_with_advice(solver):
    solution = sk.solve(CART_POLE, MESH, limited(solver, max_iterations=3))
    assert solution.status == "iteration limit"
    assert not solution.success
    assert solution.iterations == 3
    assert "Raise the iteration limit" in solution.message
    assert "The largest violation is" in solution.message


def test_the_time_limit_has_its_own_status(solver):
    solution = sk.solve(CART_POLE, MESH, limited(solver, max_seconds=1e-9))
    assert solution.status == "time limit"
    assert "Raise the time limit" in solution.message


def test_the_callback_sees_every_iteration_in_order(solver):
    seen = []
    solution = sk.solve(CART_POLE, MESH, solver, callback=seen.append)
    assert [record.iteration for record in seen] == list(range(solution.iterations + 1))
    assert seen[-1].objective == pytest.approx(solution.objective, rel=1e-6)
    assert seen[-1].primal_infeasibility < 1e-5 < seen[0].primal_infeasibility
    assert len(solution.history) == solution.iterations + 1


def test_a_callback_returning_true_stops_the_solve(solver):
    solution = sk.solve(CART_POLE, MESH, solver, callback=lambda record: record.iteration == 4)
    assert solution.status == "interrupted"
    assert solution.iterations == 4
    assert "Solve again with this solution as the guess" in solution.message


def test_ctrl_c_in_a_callback_is_an_interruption(solver):
    def press(record):
        raise KeyboardInterrupt

    assert sk.solve(CART_POLE, MESH, solver, callback=press).status == "interrupted"


def test_an_error_of_the_callback_reaches_its_author(solver):
    def broken(record):
        raise LookupError("no such gauge")

    with pytest.raises(LookupError, match="no such gauge"):
        sk.solve(CART_POLE, MESH, solver, callback=broken)


@pytest.mark.parametrize(
    ("words", "extras"),
    [
        ("The rate of speed", {"dynamics": lambda x, u: [x[1], ca.sqrt(x[0] - 0.5) + u[0]]}),
        ("The running cost", {"running_cost": lambda x, u: u[0] ** 2 + ca.log(x[0] - 1)}),
        (
            "The slope of the rate of speed",
            {"final": [0.0, 0.0], "dynamics": lambda x, u: [x[1], ca.sqrt(x[0]) + u[0]]},
        ),
        ("The terminal cost", {"terminal_cost": lambda x, tf: ca.sqrt(x[0] - 0.5)}),
    ],
)
def test_what_is_not_a_number_is_named(solver, words, extras):
    check_named(mover(**extras), solver, words)


def test_a_path_constraint_that_is_not_a_number_is_named(path_solver):
    tower = sk.PathConstraint("tower", lambda x, u: ca.sqrt(x[0] - 0.5), lower=0.0)
    check_named(mover(path=[tower]), path_solver, "'tower'")


def check_named(problem, solver, words):
    solution = sk.solve(problem, sk.HermiteSimpson(10), solver)
    assert solution.status == "evaluation error"
    assert f"{words} " in solution.message
    assert "is not a number" in solution.message
    assert np.all(np.isfinite(solution.states))


def test_an_infeasible_problem_says_so_and_names_the_worst(solver):
    check_infeasible(mover(control_bounds=(-0.1, 0.1)), solver, "defect")


def test_an_infeasible_path_constraint_is_named(path_solver):
    fence = sk.PathConstraint("fence", lambda x, u: x[0], lower=0.7)
    check_infeasible(mover(path=[fence]), path_solver, "'fence'")


def check_infeasible(problem, solver, words):
    solution = sk.solve(problem, sk.HermiteSimpson(10), solver)
    assert solution.status == "locally infeasible"
    assert words in solution.message
    assert "Relax the constraint named above" in solution.message


@pytest.mark.parametrize(
    ("name", "kind"), [(name, kind) for name, kinds in REFUSED.items() for kind in kinds]
)
def test_what_a_solver_cannot_hold_is_refused_by_name_before_it_iterates(name, kind):
    seen = []
    with pytest.raises(sk.UserError, match=f"cannot hold a {kind}") as caught:
        sk.solve(mover(**REFUSED[name][kind]), MESH, name, callback=seen.append)
    assert f"solver '{name}'" in caught.value.where
    assert all(part.strip() for part in caught.value.parts().values())
    assert not seen


def test_an_impossible_tolerance_ends_at_the_optimum_without_an_exception(solver):
    reachable = sk.solve(CART_POLE, sk.HermiteSimpson(10), solver)
    solution = sk.solve(
        CART_POLE, sk.HermiteSimpson(10), limited(solver, max_iterations=200), tolerance=1e-30
    )
    assert solution.status != "solved"
    assert solution.objective == pytest.approx(reachable.objective, rel=1e-6)


@pytest.mark.parametrize("name", ["cart_pole", "bryson_denham", "minimum_time"])
def test_a_solution_as_the_guess_needs_at_most_two_iterations(solver, name):
    reference = getattr(problems, name)()
    first = sk.solve(reference.problem, MESH, solver, guess=reference.guess)
    again = sk.solve(reference.problem, MESH, solver, guess=first)
    assert again.success
    assert again.iterations <= 2
    assert again.iterations < first.iterations
    assert again.objective == pytest.approx(first.objective, rel=1e-5)


def test_the_same_call_gives_the_same_bits(solver):
    first, again = (sk.solve(CART_POLE, MESH, solver) for _ in range(2))
    assert again.states.tobytes() == first.states.tobytes()
    assert again.costates.tobytes() == first.costates.tobytes()
