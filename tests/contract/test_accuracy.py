"""Claim: ``accuracy`` refines the mesh until the answer is as accurate as that, or says why not."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest

import skyknot as sk
from skyknot import bank as problems
from skyknot.errors import UserError
from skyknot.transcription.switches import smeared
from skyknot.verification.evidence import Evidence
from transcription.test_switches import DURATION, SWITCH, clipped, least_time

COARSE = sk.HermiteSimpson(8)


@cache
def bang_bang(controls="quadratic"):
    scheme = sk.HermiteSimpson(8, controls=controls)
    return sk.solve(least_time(), scheme, tolerance=1e-8, accuracy=1e-4)


@cache
def cart_pole():
    return sk.solve(problems.cart_pole().problem, COARSE, accuracy=1e-5)


def flown_apart(solution):
    evidence = Evidence(solution.problem, solution.trajectory, solution.record.parameters)
    sizes = 1.0 + np.max(np.abs(solution.states), axis=0)
    return np.max(np.abs(evidence.flown - solution.states) / sizes)


@pytest.mark.parametrize("solve", [bang_bang, cart_pole])
def test_the_flight_by_another_integrator_is_as_accurate_as_asked(solve):
    solution = solve()
    assert solution.success, solution.message
    assert flown_apart(solution) <= 1.01 * solution.record.accuracy
    assert solution.verify().passed


def test_the_equations_are_solved_more_closely_where_defects_would_add_up():
    problem = problems.cart_pole().problem
    close = sk.solve(problem, sk.HermiteSimpson(30), accuracy=1e-8)
    assert close.success, close.message
    assert flown_apart(close) <= 1.2e-8
    assert close.record.tolerance == pytest.approx(1e-10)
    assert cart_pole().record.tolerance == pytest.approx(1e-7)
    assert bang_bang().record.tolerance == 1e-8  # what was asked for is never loosened


@pytest.mark.parametrize("controls", ["quadratic", "linear", "hold"])
def test_a_switch_of_the_control_gets_nodes_to_a_thousandth_of_the_horizon(controls):
    solution = bang_bang(controls)
    assert solution.success, solution.message
    shares = solution.times / solution.trajectory.duration
    assert np.min(np.abs(shares - SWITCH / DURATION)) < 1e-3
    assert solution.trajectory.duration == pytest.approx(DURATION, rel=1e-4)
    around = np.abs(shares - SWITCH / DURATION) < 0.05
    assert np.min(np.diff(shares[around])) < 0.3 * np.max(np.diff(shares))


def test_an_even_mesh_of_three_times_the_segments_knows_the_jump_less_well():
    refined = bang_bang()
    even = sk.solve(least_time(), sk.HermiteSimpson(3 * refined.record.segments), tolerance=1e-8)
    spread = [np.max(smeared(least_time(), each.trajectory)) for each in (refined, even)]
    assert spread[0] <= 1e-3 < spread[1]
    late = [abs(each.trajectory.duration - DURATION) for each in (refined, even)]
    assert late[0] < late[1]


def test_the_rounds_tell_segments_errors_and_time_of_every_mesh():
    solution = cart_pole()
    rounds = solution.rounds
    assert len(rounds) >= 2
    assert rounds[0].segments == 8
    assert rounds[-1].segments == solution.record.segments == len(solution.times) - 1
    assert [entry.error > 1e-5 for entry in rounds] == [True] * (len(rounds) - 1) + [False]
    for entry in rounds:
        assert entry.error == max(
            entry.dynamics, entry.flight, entry.constraints / 30, entry.switching / 10
        )
        assert entry.seconds > 0
        assert entry.status == "solved"


def test_iterations_history_and_work_are_those_of_all_rounds():
    solution = cart_pole()
    assert solution.iterations == sum(entry.iterations for entry in solution.rounds)
    assert f"{solution.iterations} iterations on {len(solution.rounds)} meshes" in solution.message
    np.testing.assert_array_equal(solution.history[:, 0], np.arange(len(solution.history)))
    assert len(solution.history) >= solution.iterations
    assert solution.record.work["factorisations"] >= solution.iterations
    assert {"transcription", "solver", "recovery", "refinement"} <= set(solution.record.timings)


def test_the_rounds_survive_saving(tmp_path):
    solution = cart_pole()
    loaded = sk.load(solution.save(tmp_path / "cart_pole"))
    assert loaded.rounds == solution.rounds
    assert loaded.record.accuracy == 1e-5


def test_a_good_first_mesh_is_the_only_one():
    problem = problems.cart_pole().problem
    refined = sk.solve(problem, sk.HermiteSimpson(80), accuracy=1e-2)
    plain = sk.solve(problem, sk.HermiteSimpson(80))
    assert len(refined.rounds) == 1
    assert plain.rounds == ()
    assert plain.record.accuracy is None
    np.testing.assert_array_equal(refined.states, plain.states)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-5, 1e-7])
def test_a_certified_answer_stays_certified_when_it_is_refined(accuracy):
    for problem in (problems.cart_pole().problem, clipped(5.0)):
        before = sk.solve(problem, sk.HermiteSimpson(60))
        assert before.verify().passed, before.verify().sentence
        after = sk.solve(problem, sk.HermiteSimpson(60), accuracy=accuracy)
        assert after.success, after.message
        assert after.verify().passed, after.verify().sentence


@pytest.mark.parametrize("scheme", [sk.Trapezoid(20), sk.HermiteSimpson(10, controls="hold")])
def test_other_schemes_refine_as_well(scheme):
    solution = sk.solve(clipped(5.0), scheme, accuracy=1e-4)
    assert solution.success, solution.message
    assert flown_apart(solution) <= 1.01e-4


def test_other_solvers_refine_as_well():
    solution = sk.solve(clipped(5.0), COARSE, "ipopt", accuracy=1e-6)
    assert solution.success, solution.message
    assert len(solution.rounds) >= 2
    assert flown_apart(solution) <= 1.01e-6


def test_a_waypoint_stays_a_node():
    gate = sk.PointConstraint("gate", lambda x, u: x[0], at=0.377, lower=0.3, upper=0.3)
    problem = sk.Problem(
        name="pendulum",
        states=["angle", "rate"],
        controls=["torque"],
        dynamics=lambda x, u: [x[1], u[0] - x[0].sin()],
        horizon=3.0,
        initial=[0.0, 0.0],
        final=[1.5, 0.0],
        running_cost=lambda x, u: u[0] ** 2,
        points=[gate],
    )
    solution = sk.solve(problem, COARSE, accuracy=1e-6)
    assert solution.success, solution.message
    place = np.argmin(np.abs(solution.times / 3.0 - 0.377))
    assert solution.times[place] == pytest.approx(0.377 * 3.0, abs=1e-12)
    assert solution.states[place, 0] == pytest.approx(0.3, abs=1e-6)


def test_inherited_multipliers_save_iterations():
    solution = bang_bang()
    inherited = solution.rounds[-1].iterations
    mesh = solution.times / solution.times[-1]
    mesh[-1] = 1.0
    coarse = sk.solve(least_time(), COARSE, tolerance=1e-8)
    cold = sk.solve(
        least_time(), sk.HermiteSimpson(mesh=mesh), guess=coarse.trajectory, tolerance=1e-8
    )
    assert cold.success
    assert inherited < 0.7 * cold.iterations


LIMITS = {
    "meshes": sk.Refinement(1e-9, rounds=2),
    "segments": sk.Refinement(1e-9, segments=30),
    "s:": sk.Refinement(1e-9, seconds=1e-6),
}


@pytest.mark.parametrize("word", LIMITS)
def test_an_accuracy_out_of_reach_is_a_status_with_a_reason(word):
    problem = problems.cart_pole().problem
    solution = sk.solve(problem, COARSE, accuracy=LIMITS[word])
    assert solution.status == "accuracy not reached"
    assert not solution.success
    assert "Refinement ended at the limit of" in solution.message
    assert word in solution.record.detail
    assert "1e-09 was asked for" in solution.message
    assert any(f"'{name}'" in solution.record.detail for name in problem.state_names)
    assert solution.kkt_residual < 1e-5  # what is returned is the optimum of its own mesh
    best = min(entry.error for entry in solution.rounds)
    assert f"the error is {best:.2g}" in solution.message


def test_a_scheme_that_cannot_get_there_is_told_early():
    solution = sk.solve(problems.cart_pole().problem, sk.Euler(20), accuracy=1e-7)
    assert solution.status == "accuracy not reached"
    assert len(solution.rounds) == 2
    assert "since this scheme needs about" in solution.message


def test_a_jump_that_is_not_resolved_is_told_with_its_time():
    solution = sk.solve(least_time(), COARSE, accuracy=sk.Refinement(1e-6, rounds=1))
    assert solution.status == "accuracy not reached"
    (low, high) = re.findall(
        r"a control jumps between ([\d.]+) s and ([\d.]+) s", solution.message
    )[0]
    assert float(low) <= SWITCH <= float(high)


def test_a_problem_that_does_not_solve_says_what_it_says_without_refinement():
    problem = clipped(3.9)  # less than the 4 that rest to rest in one second takes
    refined, plain = sk.solve(problem, COARSE, accuracy=1e-4), sk.solve(problem, COARSE)
    assert refined.status == plain.status == "locally infeasible"
    assert "The largest violation is" in refined.record.detail
    assert [entry.status for entry in refined.rounds] == ["locally infeasible"] * 2
    assert [entry.segments for entry in refined.rounds] == [8, 20]


def test_a_first_mesh_that_is_too_coarse_is_followed_by_a_finer_one():
    swing_up = sk.Problem(
        name="swing up",
        states=["angle", "rate"],
        controls=["torque"],
        dynamics=lambda x, u: [x[1], u[0] - 9.81 * x[0].sin()],
        horizon=sk.Free(1.0, 10.0),
        initial=[0, 0],
        final=[np.pi, 0],
        running_cost=lambda x, u: 1 + u[0] ** 2,
        control_bounds=([-3], [3]),
    )
    coarse = sk.HermiteSimpson(20, controls="hold")
    assert sk.solve(swing_up, coarse).status == "locally infeasible"
    solution = sk.solve(swing_up, coarse, accuracy=1e-3)
    assert solution.success, solution.message
    assert [entry.segments for entry in solution.rounds[:2]] == [20, 50]


def test_an_interruption_on_a_later_mesh_keeps_the_answer_on_the_last_one():
    starts = []

    def stop_on_the_second_mesh(record):
        starts.append(record.iteration == 0)
        return sum(starts) == 2

    solution = sk.solve(least_time(), COARSE, accuracy=1e-4, callback=stop_on_the_second_mesh)
    assert solution.status == "interrupted"
    assert solution.record.segments == 8
    assert solution.kkt_residual < 1e-5


class Faltering:
    """Solves like the interior point, but gives up some times on more than a few segments."""

    name = "faltering"

    def __init__(self, segments, times=1000):
        self.segments, self.times, self.own = segments, times, sk.InteriorPoint()

    def solve(self, program, tolerance, multipliers=None, callback=None):
        if program.segments <= self.segments or self.times == 0:
            return self.own.solve(program, tolerance, multipliers, callback)
        self.times -= 1
        return sk.InteriorPoint(max_iterations=1).solve(program, tolerance, None, callback)


def test_a_solver_that_fails_on_a_finer_mesh_loses_nothing():
    solution = sk.solve(least_time(), COARSE, Faltering(8), accuracy=1e-4)
    assert solution.status == "accuracy not reached"
    assert solution.record.segments == 8
    assert "where the solve ended as 'iteration limit'" in solution.message
    assert solution.kkt_residual < 1e-5


def test_a_warm_start_that_fails_is_followed_by_a_cold_one():
    solution = sk.solve(least_time(), COARSE, Faltering(8, times=1), accuracy=1e-4)
    assert solution.success, solution.message
    words = [entry.status for entry in solution.rounds]
    assert words[:3] == ["solved", "iteration limit", "solved"]


def test_a_mesh_that_does_not_solve_is_followed_by_one_that_only_splits():
    solution = sk.solve(least_time(), COARSE, Faltering(8, times=2), accuracy=1e-4)
    assert solution.success, solution.message
    words = [entry.status for entry in solution.rounds]
    assert words[:4] == ["solved", "iteration limit", "iteration limit", "solved"]


@pytest.mark.parametrize("accuracy", [0, -1e-4, 1e-12, 2.0, "fine"])
def test_an_accuracy_that_cannot_be_is_refused_before_iterating(accuracy):
    with pytest.raises(UserError, match="The accuracy asked for cannot be"):
        sk.solve(least_time(), COARSE, accuracy=accuracy)
