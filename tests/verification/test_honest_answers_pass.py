"""A correct answer passes every check, whatever the scheme, and the values mean what they say."""

from dataclasses import replace

import numpy as np
import pytest
from drone_on_rail import problem

from skyknot.problem.constraints import PathConstraint
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.problem.variables import State
from skyknot.solve import solve
from skyknot.transcription import Euler, HermiteSimpson, Trapezoid
from skyknot.verification import certify
from skyknot.verification.evidence import Evidence

EVERYTHING = {
    "horizon",
    "ends",
    "points",
    "state bounds",
    "control bounds",
    "path",
    "rates",
    "defects",
    "interpolant",
    "state bounds between nodes",
    "control bounds between nodes",
    "path between nodes",
    "path guaranteed",
    "dynamics between nodes",
    "open-loop flight",
    "arrival",
    "saturation",
}


@pytest.mark.parametrize(
    "transcription",
    [
        HermiteSimpson(40),
        HermiteSimpson(40, form="compressed"),
        HermiteSimpson(40, controls="linear"),
        HermiteSimpson(mesh=np.linspace(0, 1, 41) ** 1.2),
        Trapezoid(200),
        Euler(1600),
    ],
    ids=["free midpoint", "compressed", "linear", "uneven mesh", "trapezoid", "Euler"],
)
def test_a_correct_answer_passes_every_check(transcription):
    asked = problem()
    certificate = certify(asked, solve(asked, transcription).trajectory)
    assert set(certificate.checks) == EVERYTHING
    assert certificate.passed, certificate.table()


def test_a_free_horizon_and_a_free_parameter_pass_with_the_values_found():
    asked = Problem(
        "least time with a free brake",
        ["x", "v"],
        ["a"],
        lambda x, u, p: [x[1], u[0] - p.brake * x[1]],
        Free(0.5, 9),
        initial=[0, 0],
        final=[1, 0],
        control_bounds=(-1, 1),
        terminal_cost=lambda x, tf: tf,
        parameters={"brake": Free(0.05, 1.0)},
    )
    solution = solve(asked, Trapezoid(200))
    found = solution.record.parameters
    assert found["brake"] != pytest.approx(asked.parameter_values()["brake"], abs=0.01)
    assert certify(asked, solution.trajectory, found).checks["defects"].passed
    assert not certify(asked, solution.trajectory).checks["defects"].passed


def test_a_small_scale_does_not_ask_for_more_than_the_tolerance_of_solvers():
    """Tolerances are in the user's units: 5e-7 m is within 1e-6 m, however small the scale."""
    fine = problem(states=[State("x", "m", scale=1e-4), State("v", "m/s", scale=1e-4)])
    answer = solve(fine, HermiteSimpson(40)).trajectory
    nudged = replace(answer, states=answer.states + [[5e-7, 0]] * (np.arange(41) == 7)[:, None])
    assert certify(fine, nudged).checks["defects"].passed


def test_only_what_the_problem_has_is_checked():
    bare = Problem("free fall", ["x", "v"], ["a"], lambda x, u: [x[1], u[0]], 1.0, [0, 0], [1, 0])
    checks = certify(bare, solve(bare, HermiteSimpson(4)).trajectory).checks
    assert not {"path", "points", "rates", "state bounds", "control bounds"} & set(checks)


def test_the_flight_of_a_least_energy_transfer_is_the_closed_form():
    asked = Problem(
        "least energy",
        ["x", "v"],
        ["a"],
        lambda x, u: [x[1], u[0]],
        1.0,
        initial=[0, 0],
        final=[1, 0],
        running_cost=lambda x, u: 0.5 * u[0] ** 2,
    )
    trajectory = solve(asked, HermiteSimpson(5), tolerance=1e-9).trajectory
    t = trajectory.times
    flown = Evidence(asked, trajectory, {}).flown
    assert np.allclose(flown[:, 0], 3 * t**2 - 2 * t**3, atol=1e-7)
    assert certify(asked, trajectory).checks["open-loop flight"].value < 1e-7


def test_the_dynamics_between_nodes_are_measured_in_time_and_seen_by_the_checks():
    """x' = t with x'' ≠ 0 flown by Euler: the error of a segment is ∫ (t − t_k) dt = h²/2."""
    asked = Problem("clock", ["x"], ["u"], lambda x, u, t: [t + 0 * u[0]], 1.0, initial=[0])
    trajectory = solve(asked, Euler(10)).trajectory
    check = certify(asked, trajectory).checks["dynamics between nodes"]
    assert check.value == pytest.approx(0.1**2 / 2, rel=1e-9)
    assert certify(asked, trajectory).checks["defects"].passed


def test_a_path_constraint_on_controls_is_judged_by_its_mean_one_on_states_by_its_peak():
    on_state = PathConstraint("speed", lambda x, u: x[1], upper=0.7)
    on_control = PathConstraint("effort", lambda x, u: u[0], upper=1.4)
    asked = problem()
    trajectory = solve(asked, HermiteSimpson(40)).trajectory
    peak = trajectory.state(np.linspace(0, 2, 4001))[:, 1].max() - 0.7
    excess = np.maximum(trajectory.control(np.linspace(0, 2, 4001))[:, 0] - 1.4, 0)
    speed = certify(problem(path=[on_state]), trajectory).checks["path between nodes"]
    effort = certify(problem(path=[on_control]), trajectory).checks["path between nodes"]
    assert speed.value == pytest.approx(peak, rel=1e-3)
    assert excess.max() > 0
    assert effort.value == pytest.approx(excess.mean(), rel=1e-2)
