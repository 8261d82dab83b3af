"""Claim: on request, a solution is examined by solving again."""

from dataclasses import replace

import numpy as np
import pytest

import skyknot as sk
from agreement.variants import PROBLEMS
from skyknot.examination import examine
from skyknot.verification import Limits

NAMES = {"mesh convergence", "sensitivity", "second solver"}


@pytest.fixture(scope="module")
def solution():
    return sk.solve(PROBLEMS["plain"], sk.HermiteSimpson(10), tolerance=1e-8)


@pytest.fixture(scope="module")
def certificate(solution):
    return examine(solution)


def test_three_checks_are_added_and_pass(solution, certificate):
    assert set(certificate.checks) == set(solution.verify().checks) | NAMES
    assert all(certificate.checks[name].passed for name in NAMES)


def test_the_observed_order_is_told(certificate):
    told = certificate.checks["mesh convergence"].worst
    assert float(told.split("order ")[1].split(",")[0]) > 1.5


def test_the_slope_at_the_start_is_that_of_the_objective(solution, certificate):
    assert certificate.checks["sensitivity"].value < 1e-3
    moved = PROBLEMS["plain"].varied(initial=[0.4 + 1e-4, 0.0])
    again = sk.solve(moved, sk.HermiteSimpson(10), tolerance=1e-8)
    slope = (again.objective - solution.objective) / 1e-4
    assert solution.witness.state_bounds[0, 0, 0] == pytest.approx(-slope, abs=1e-3)


def test_the_second_solver_is_another(certificate):
    assert "'ipopt'" in certificate.checks["second solver"].how
    other = sk.solve(PROBLEMS["plain"], sk.HermiteSimpson(10), "ipopt")
    assert "'interior-point'" in examine(other).checks["second solver"].how


def test_wrong_multipliers_of_the_start_are_caught(solution):
    bounds = 1.3 * solution.witness.state_bounds
    spoilt = replace(solution, witness=replace(solution.witness, state_bounds=bounds))
    assert not examine(spoilt).checks["sensitivity"].passed


def test_an_answer_of_another_objective_is_caught(solution):
    other = sk.solve(
        sk.Problem(
            **{
                **{k: getattr(solution.problem, k) for k in ("name", "states", "controls")},
                "dynamics": solution.problem.dynamics,
                "horizon": 2.0,
                "initial": [0.4, 0.0],
                "final": [None, 0.5],
                "running_cost": lambda x, u: u[0] ** 2 + 3 * u[1] ** 2 + x[1] ** 2,
                "control_bounds": ([-1.0, -0.5], [1.0, 0.5]),
            }
        ),
        sk.HermiteSimpson(10),
    )
    swapped = replace(other, problem=solution.problem)
    assert not examine(swapped).checks["second solver"].passed


def test_a_mesh_on_which_the_objective_has_not_settled_is_caught():
    coarse = sk.solve(PROBLEMS["plain"], sk.Euler(3))
    check = examine(coarse).checks["mesh convergence"]
    assert not check.passed
    fine = sk.solve(PROBLEMS["plain"], sk.Euler(6))
    change = abs(fine.objective - coarse.objective) / max(1.0, abs(coarse.objective))
    assert check.value == pytest.approx(change, rel=1e-4)


def test_a_limit_of_its_own_is_kept(solution):
    check = examine(solution, limits=Limits(minimum=1e-12)).checks["mesh convergence"]
    assert not check.passed
    assert check.limit == 1e-12


def test_a_scheme_of_another_size_has_to_be_given():
    scheme = sk.Lobatto(4, points=6)
    solution = sk.solve(PROBLEMS["plain"], scheme, tolerance=1e-8)
    with pytest.raises(sk.UserError, match=r"(?s)scheme of this solution is not known.*Lobatto"):
        examine(solution)
    with pytest.raises(sk.UserError, match="scheme of this solution is not known"):
        examine(solution, transcription=sk.Lobatto(4, points=5))
    checks = examine(solution, transcription={"scheme": "lobatto", "points": 6}).checks
    assert all(checks[name].passed for name in NAMES)


def test_a_loaded_solution_asks_for_its_problem(solution, tmp_path):
    loaded = sk.load(solution.save(tmp_path / "s.npz"))
    with pytest.raises(sk.UserError, match=r"(?s)cannot be examined.*no problem"):
        examine(loaded)
    checks = examine(loaded, PROBLEMS["plain"]).checks
    assert all(checks[name].passed for name in NAMES)
    assert np.isfinite(checks["sensitivity"].value)
