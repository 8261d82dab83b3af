"""Every way of being wrong is caught by the check that is named for it."""

from dataclasses import replace

import numpy as np
import pytest
from drone_on_rail import bumped, flat, problem, with_segments

from skyknot.problem.airspace import cylinder
from skyknot.problem.constraints import PathConstraint, PointConstraint
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.solve import solve
from skyknot.trajectory import Trajectory
from skyknot.transcription import Euler, HermiteSimpson
from skyknot.verification import certify


@pytest.fixture(scope="module")
def answer():
    return solve(problem(), HermiteSimpson(40)).trajectory


def failed(asked, trajectory, **choices):
    return {check.name for check in certify(asked, trajectory, **choices).failures}


TRAJECTORY_FAULTS = {
    "one node state": (
        lambda a: replace(a, states=bumped(a.states, (7, 1), 1e-4)),
        "defects",
    ),
    "one interior state": (
        lambda a: with_segments(
            a, interior_states=bumped(a.segments.interior_states, (7, 0, 1), 1e-4)
        ),
        "defects",
    ),
    "one control": (
        lambda a: with_segments(
            a, control_values=bumped(a.segments.control_values, (7, 1, 0), 1e-2)
        ),
        "defects",
    ),
    "one control at a node only": (
        lambda a: replace(a, controls=bumped(a.controls, (7, 0), 1e-2)),
        "interpolant",
    ),
    "one stored rate": (
        lambda a: with_segments(a, rates=bumped(a.segments.rates, (7, 1, 0), 1e-2)),
        "interpolant",
    ),
    "one mesh time": (lambda a: replace(a, times=bumped(a.times, (7,), 1e-3)), "defects"),
    "all times stretched": (lambda a: replace(a, times=1.001 * a.times), "horizon"),
    "last state": (lambda a: replace(a, states=bumped(a.states, (-1, 0), -1e-3)), "ends"),
    "a state beyond its bound": (
        lambda a: replace(a, states=bumped(a.states, (20, 1), 0.3)),
        "state bounds",
    ),
    "a control beyond its bound": (
        lambda a: replace(a, controls=bumped(a.controls, (20, 0), 4.0)),
        "control bounds",
    ),
    "a control value beyond its bound": (
        lambda a: with_segments(
            a, control_values=bumped(a.segments.control_values, (20, 1, 0), -4.0)
        ),
        "control bounds",
    ),
}


@pytest.mark.parametrize("fault", TRAJECTORY_FAULTS)
def test_a_fault_in_the_trajectory_is_caught_by_name(answer, fault):
    spoil, name = TRAJECTORY_FAULTS[fault]
    assert failed(problem(), answer) == set()
    assert name in failed(problem(), spoil(answer))


PROBLEM_FAULTS = {
    "another drag": ({"parameters": {"drag": 0.21}}, "defects"),
    "another start": ({"initial": [0.01, 0]}, "ends"),
    "another goal": ({"final": [1.01, 0]}, "ends"),
    "more time": ({"horizon": 2.01}, "horizon"),
    "time outside a range": ({"horizon": Free(2.5, 4)}, "horizon"),
    "a tighter speed bound": ({"state_bounds": (None, [None, 0.7])}, "state bounds"),
    "a tighter control bound": ({"control_bounds": (-1, 1)}, "control bounds"),
    "a tighter rate": ({"rates": [1.0]}, "rates"),
    "a closer fence": (
        {"path": [PathConstraint("fence", lambda x, u: x[0], upper=0.9, unit="m")]},
        "path",
    ),
    "an earlier gate": (
        {"points": [PointConstraint("gate", lambda x, u: x[0], at=0.25, lower=0.45)]},
        "points",
    ),
}


@pytest.mark.parametrize("fault", PROBLEM_FAULTS)
def test_an_answer_to_another_problem_is_caught_by_name(answer, fault):
    changes, name = PROBLEM_FAULTS[fault]
    assert name in failed(problem(**changes), answer)


def test_the_worst_is_told_by_name_time_and_unit(answer):
    check = certify(problem(), replace(answer, states=bumped(answer.states, (7, 1), 0.25)))
    defect = check.checks["defects"]
    assert defect.worst == f"v at {answer.times[7]:.4g} s"
    assert defect.unit == "m/s"
    assert defect.value == pytest.approx(0.25, rel=0.02)


def test_a_thin_obstacle_between_two_nodes_is_seen():
    """A pole of 2 cm radius stands where the straight way has no node."""
    asked = Problem(
        "past a pole",
        ["x", "y"],
        ["u"],
        lambda x, u: [1 + 0 * u[0], 0],
        2.0,
        initial=[0, 0],
        path=[cylinder("pole", (0.95, 0.0), 0.04)],
    )
    straight = solve(replace_path(asked), HermiteSimpson(20)).trajectory
    found = failed(asked, straight)
    assert "path between nodes" in found
    assert "path" not in found
    assert certify(asked, straight).checks["path between nodes"].worst.startswith("pole at 0.9")


def replace_path(asked):
    return Problem(
        asked.name, asked.state_names, asked.control_names, asked.dynamics, 2.0, initial=[0, 0]
    )


def test_a_state_that_bulges_between_nodes_is_seen():
    """x = t − t² peaks at 0.25 between the nodes 1/3 and 2/3, where it is 2/9."""
    asked = Problem(
        "bulge",
        ["x", "v"],
        ["a"],
        lambda x, u: [x[1], u[0]],
        1.0,
        initial=[0, 1],
        final=[0, -1],
        running_cost=lambda x, u: u[0] ** 2,
        state_bounds=(None, [0.23, None]),
    )
    found = failed(asked, solve(asked, HermiteSimpson(3, enforce="nodes")).trajectory)
    assert found == {"state bounds between nodes"}


def test_a_control_that_overshoots_in_every_segment_is_seen():
    """The parabola through −1, 1, 1 exceeds 1 by 1/12 on average."""
    asked = Problem("overshoot", ["x"], ["u"], lambda x, u: [0 * u[0]], 2.0, control_bounds=(-1, 1))
    zigzag = flat([0, 1, 2], [[0], [0], [0]], [[[-1], [1], [1]]] * 2, 0.0)
    check = certify(asked, zigzag).checks["control bounds between nodes"]
    assert not check.passed
    assert check.value == pytest.approx(1 / 12, rel=0.02)
    assert certify(asked, zigzag).checks["control bounds"].passed


def test_a_held_control_that_jumps_too_fast_is_seen():
    asked = problem(rates=None)
    jumping = solve(asked, Euler(50)).trajectory
    largest = np.abs(np.diff(jumping.segments.control_values[:, 0, 0])).max() / (2 / 50)
    assert "rates" in failed(problem(rates=[0.99 * largest]), jumping)
    assert "rates" not in failed(problem(rates=[1.01 * largest]), jumping)


def test_a_coarse_mesh_fails_in_flight_and_not_in_its_own_equations():
    asked = problem(points=[], parameters={"drag": 2.0}, control_bounds=None)
    found = failed(asked, solve(asked, Euler(8)).trajectory)
    assert {"open-loop flight", "arrival", "dynamics between nodes"} <= found
    assert not {"defects", "ends", "interpolant"} & found


def test_a_straight_guess_fails_and_does_not_raise():
    guess = Trajectory([0, 1, 2], [[0, 0], [0.5, 0.4], [1, 0]], [[1], [0], [-1]])
    found = failed(problem(), guess)
    assert {"defects", "interpolant", "open-loop flight"} <= found


def test_a_guess_whose_columns_do_satisfy_the_equations_passes():
    """Constant speed is linear in time: straight lines between nodes are exact."""
    asked = problem(parameters={"drag": 0.0}, final=None, initial=None, points=[])
    coasting = Trajectory([0, 1, 2], [[0, 0.5], [0.5, 0.5], [1, 0.5]], [[0], [0], [0]])
    assert certify(asked, coasting).passed


def test_a_flight_that_leaves_the_numbers_is_a_failed_check():
    asked = Problem("blow-up", ["x"], ["u"], lambda x, u: [x[0] ** 2 + 0 * u[0]], 2.0, initial=[1])
    guess = Trajectory([0, 1, 2], [[1], [2], [3]], [[0], [0], [0]])
    check = certify(asked, guess).checks["open-loop flight"]
    assert not check.passed
    assert not np.isfinite(check.value)


def test_a_model_that_is_not_a_number_is_a_failed_check():
    asked = Problem("root", ["x"], ["u"], lambda x, u: [(x[0] - 5) ** 0.5 + u[0]], 2.0, initial=[1])
    guess = Trajectory([0, 1, 2], [[1], [2], [3]], [[0], [0], [0]])
    certificate = certify(asked, guess)
    assert not certificate.passed
    assert {"defects", "interpolant", "open-loop flight", "arrival"} <= {
        check.name for check in certificate.failures
    }
