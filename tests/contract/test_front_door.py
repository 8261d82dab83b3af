"""Claim: ``solve`` tells every outcome in the closed vocabulary and carries what it promised."""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from agreement.variants import oscillator
from skyknot import bank as problems

CART_POLE = problems.cart_pole().problem


@pytest.fixture(scope="module")
def solution():
    return sk.solve(CART_POLE, sk.HermiteSimpson(20), "ipopt", tolerance=1e-9)


def test_a_solution_carries_what_the_contract_names(solution):
    N, nx, nu = 20, 4, 1
    assert solution.success is True
    assert solution.status == "solved"
    assert solution.times.shape == (N + 1,)
    assert solution.states.shape == solution.costates.shape == (N + 1, nx)
    assert solution.controls.shape == (N + 1, nu)
    assert solution.midpoint_states.shape == (N, nx)
    assert solution.midpoint_controls.shape == (N, nu)
    assert solution.history.shape[1] == 7
    assert solution.kkt_residual < 1e-7
    assert solution.max_defect < 1e-9
    assert solution.solve_time > 0
    assert solution.problem is CART_POLE


def test_the_message_is_sentences_with_the_objective(solution):
    assert solution.message.startswith("Solved: objective 58.7027 after")
    assert "optimality conditions hold" in solution.message


def test_the_record_tells_how_the_solution_came_to_be(solution):
    record = solution.record
    assert record.problem == "cart-pole"
    assert record.transcription == "Hermite–Simpson, quadratic control"
    assert (record.solver, record.segments, record.tolerance) == ("ipopt", 20, 1e-9)
    assert record.frame == "NED"
    assert set(record.versions) >= {"skyknot", "casadi", "numpy", "python"}
    assert set(record.timings) == {"transcription", "solver", "recovery"}
    assert len(record.inputs_hash) == 64


def test_equal_inputs_have_equal_hashes_and_others_do_not(solution):
    def hashed(**changes):
        return sk.solve(
            problems.cart_pole().problem, sk.HermiteSimpson(**({"segments": 20} | changes))
        ).record.inputs_hash

    assert hashed() == solution.record.inputs_hash
    assert hashed(segments=21) != solution.record.inputs_hash
    assert hashed(controls="linear") != solution.record.inputs_hash


@pytest.mark.parametrize(
    "changes", [{"rates": [5.0, 0.2]}, {"control_bounds": (-2.0, 2.0)}, {"horizon": 2.5}]
)
def test_a_changed_problem_has_another_hash(changes):
    scheme = sk.HermiteSimpson(4)
    plain, changed = oscillator(rates=[6.0, 0.2]), oscillator(**({"rates": [6.0, 0.2]} | changes))
    hashes = {sk.solve(problem, scheme).record.inputs_hash for problem in (plain, changed)}
    assert len(hashes) == 2


def test_another_quadrature_has_another_hash():
    sums = [sk.solve(oscillator(), sk.Trapezoid(4, objective=o)) for o in ("integral", "sum")]
    assert sums[0].record.inputs_hash != sums[1].record.inputs_hash


@pytest.mark.parametrize(
    ("first", "then"),
    [
        (sk.HermiteSimpson(mesh=np.linspace(0, 1, 21) ** 3), sk.HermiteSimpson(20)),
        (sk.Trapezoid(mesh=np.linspace(0, 1, 41) ** 3), sk.HermiteSimpson(20)),
    ],
)
def test_a_solution_on_other_nodes_is_read_by_time_not_by_position(first, then):
    """Both pairs have decision vectors of the same length, which mean different times."""
    coarse = sk.solve(CART_POLE, first)
    starts = []
    for guess in (coarse, coarse.trajectory):
        seen = []
        assert sk.solve(CART_POLE, then, guess=guess, callback=seen.append).success
        starts.append((seen[0].objective, seen[0].primal_infeasibility))
    assert starts[0] == starts[1]


def test_free_quantities_are_reported_by_name():
    solution = sk.solve(problems.minimum_time().problem, sk.HermiteSimpson(20))
    assert solution.record.parameters["horizon"] == pytest.approx(solution.times[-1])
    assert solution.objective == pytest.approx(solution.times[-1])


def test_the_guess_is_not_changed():
    guess = problems.brachistochrone().guess
    before = guess.states.copy()
    sk.solve(problems.brachistochrone().problem, sk.HermiteSimpson(5), guess=guess)
    np.testing.assert_array_equal(guess.states, before)


def test_every_status_has_a_sentence_and_failures_have_advice():
    for status in sk.Status:
        assert status.sentence.endswith(".")
        assert status.success == (status in ("solved", "solved to acceptable"))
        if not status.success:
            assert status.advice.endswith(".")


FAILURES = {
    "locally infeasible": ({"control_bounds": (-0.1, 0.1)}, {}),
    "iteration limit": ({}, {"solver": sk.Ipopt(max_iterations=1)}),
    "time limit": ({}, {"solver": sk.Ipopt(max_seconds=1e-9)}),
    "interrupted": ({}, {"callback": lambda record: True}),
    "evaluation error": ({"running_cost": lambda x, u: (x[0] - 5) ** 0.5}, {}),
}


@pytest.mark.parametrize("scheme", ["euler", "trapezoid", "hermite-simpson"])
@pytest.mark.parametrize("status", FAILURES)
def test_a_numerical_failure_is_a_solution_not_an_exception(status, scheme):
    changes, arguments = FAILURES[status]
    asked = {
        "name": "hard",
        "states": ["x", "v"],
        "controls": ["a"],
        "dynamics": lambda x, u: [x[1], u[0] - x[0] ** 3],
        "horizon": 1.0,
        "initial": [0.0, 0.0],
        "final": [1.0, 0.0],
        "running_cost": lambda x, u: u[0] ** 2 + x[0] ** 4,
    }
    solution = sk.solve(
        sk.Problem(**(asked | changes)), {"scheme": scheme, "segments": 10}, **arguments
    )
    assert solution.status == status
    assert solution.success is False
    assert solution.status.sentence in solution.message
    assert solution.status.advice in solution.message
    assert np.all(np.isfinite(solution.states))
    assert solution.state(0.5).shape == (2,)
