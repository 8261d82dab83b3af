"""Prices of limits are those of closed forms, and solving again confirms them."""

from dataclasses import replace

import numpy as np
import pytest
from gallery import flight, flight_problem, rail, unsolved, without_problem

from skyknot.cli.trials import moved, tried
from skyknot.problem import airspace
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.report import Enclosure
from skyknot.report.binding import Binding, Confirmation, bindings_of
from skyknot.report.page import report_page
from skyknot.report.reading import Reading
from skyknot.report.reproduction import reproduction
from skyknot.report.what_binds import binds_section, lead_sentence, presented, unit_step
from skyknot.solve import solve
from skyknot.transcription import HermiteSimpson


@pytest.fixture(scope="module")
def bryson_denham():
    """A. E. Bryson and Y.-C. Ho, Applied Optimal Control, 1975, section 3.11: J = 4/(9 l)."""
    problem = Problem(
        "bryson-denham", ["x", "v"], ["a"], lambda x, u: [x[1], u[0]], 1.0, [0, 1], [0, -1],
        running_cost=lambda x, u: 0.5 * u[0] ** 2, state_bounds=([None, None], [1 / 9, None]),
    )  # fmt: skip
    return solve(problem, HermiteSimpson(60))


@pytest.fixture(scope="module")
def sprint():
    """From rest to rest over 1 m with −b ≤ u ≤ a: T² = 2 (1/a + 1/b)."""
    problem = Problem(
        "sprint", ["x", "v"], ["u"], lambda x, u: [x[1], u[0]], Free(0.5, 9.0, 2.5), [0, 0], [1, 0],
        running_cost=lambda x, u: 1.0, control_bounds=(-1, 1),
    )  # fmt: skip
    return solve(problem, HermiteSimpson(40))


def test_the_price_of_a_state_limit_is_the_closed_form(bryson_denham):
    """dJ/dl = −4/(9 l²) = −36 at l = 1/9."""
    (binding,) = bindings_of(bryson_denham)
    assert (binding.kind, binding.names, binding.upper) == ("state", ("x",), True)
    assert binding.price == pytest.approx(36.0, rel=1e-2)
    assert binding.bound == pytest.approx(1 / 9)
    assert 0.2 < binding.moment < 0.8


def test_solving_again_confirms_the_price(bryson_denham):
    ((binding, trial),) = tried(bryson_denham, {"transcription": HermiteSimpson(60)})
    wide, narrow = binding.moved, binding.bound
    assert trial.success
    assert trial.saving == pytest.approx(4 / 9 * (1 / narrow - 1 / wide), rel=1e-2)
    assert trial.saving == pytest.approx(binding.expected, rel=2e-2)
    assert trial.shorter == pytest.approx(0.0, abs=1e-9)


def test_the_prices_of_control_limits_are_the_closed_form(sprint):
    """∂T/∂a = −1/(T a²) = −1/2 at a = b = 1, and the same for b."""
    bindings = bindings_of(sprint)
    assert {(b.names, b.upper) for b in bindings} == {(("u",), True), (("u",), False)}
    assert [b.price for b in bindings] == pytest.approx([0.5, 0.5], rel=2e-2)
    assert [b.active for b in bindings] == pytest.approx([0.5, 0.5], abs=0.1)


def test_an_objective_that_is_the_time_is_told_in_seconds(sprint):
    sentence = lead_sentence(Reading(sprint), [(bindings_of(sprint)[0], None)])
    assert "would save 0.05 s" in sentence
    assert "0.1 unit" not in sentence


def test_a_limit_on_the_flight_time_has_a_price():
    """min ∫ u² dt, x' = u, over 1 m in T ≤ 2 s: J = 1/T, dJ/dT = −1/4."""
    problem = Problem(
        "slow", ["x"], ["u"], lambda x, u: [u[0]], Free(0.5, 2.0, 1.0), [0], [1],
        running_cost=lambda x, u: u[0] ** 2,
    )  # fmt: skip
    solution = solve(problem, HermiteSimpson(5))
    ((binding, trial),) = tried(solution, {"transcription": HermiteSimpson(5)})
    assert binding.kind == "horizon"
    assert binding.price == pytest.approx(0.25, rel=1e-3)
    assert trial.saving == pytest.approx(1 / 2 - 1 / binding.moved, rel=1e-3)
    assert trial.shorter == pytest.approx(-binding.step, rel=1e-3)


def test_only_the_limit_named_is_moved():
    problem = rail().problem
    control = Binding("control", ("a",), False, -3.0, "m/s²", 1.0, 0.5, 0.1, 1.0)
    assert moved(problem, control).control_lower == pytest.approx([-3.5])
    assert problem.control_lower == pytest.approx([-3.0])
    fence = Binding("constraint", ("fence",), True, 1.2, "m", 1.0, 0.1, 0.1, 1.0)
    assert moved(problem, fence).path[0].upper == pytest.approx(1.3)
    gate = Binding("constraint", ("gate",), False, 0.45, "m", 1.0, 0.05, 0.1, 1.0)
    assert moved(problem, gate).points[0].lower == pytest.approx(0.4)
    assert moved(problem, gate).path == problem.path


def test_limits_of_a_craft_are_told_upward_and_in_degrees():
    reading = Reading(flight())
    climb = Binding("state", ("vz",), False, -2.5, "m/s", 5.0, 0.01, 0.3, 1.0)
    shown = presented(reading, climb)
    assert (shown.upper, shown.bound, shown.price) == (True, 2.5, 5.0)
    pitch = Binding("state", ("theta",), True, 0.5, "rad", 9.0, 0.0025, 0.1, 1.0)
    shown = presented(reading, pitch)
    assert shown.bound == pytest.approx(np.rad2deg(0.5))
    assert shown.price == pytest.approx(np.deg2rad(9.0))
    assert shown.expected == pytest.approx(pitch.expected)


def test_a_distance_to_an_obstacle_counts_what_is_kept():
    problem = flight_problem(path=[airspace.sphere("ball", (4, 3, -2), 1.0, clearance=0.4)])
    reading = Reading(replace(flight(), problem=problem))
    ball = Binding("constraint", ("ball",), False, 0.0, "m", 2.0, 0.05, 0.01, 1.0)
    html = binds_section(reading, [(ball, Confirmation(0.098, 0.01, "solved", True))])
    assert "distance to &#x27;ball&#x27; ≥ 0.4 m" in html
    assert "nearer saves" in html
    assert "solved again with 0.35 m: 0.098 saved, 0.1 foretold; 0.01 s shorter" in html


def test_a_unit_that_is_too_far_is_told_in_tenths():
    reading = Reading(flight())
    speed = Binding("constraint", ("v",), True, 45.0, "m/s", 1e-6, 0.2, 0.5, 1.0)
    assert unit_step(speed, reading) == 1.0
    assert unit_step(replace(speed, bound=2.5), reading) == 0.1
    assert unit_step(replace(speed, price=1e3 * flight().objective), reading) == pytest.approx(1e-4)


def test_a_trial_that_fails_confirms_nothing():
    binding = Binding("control", ("a",), False, -3.0, "m/s²", 1.0, 0.5, 0.1, 1.0)
    lost = Confirmation(float("nan"), float("nan"), "stalled", False)
    html = binds_section(Reading(rail()), [(binding, lost)])
    assert "not confirmed: solved again with −3.5 m/s², it ended &#x27;stalled&#x27;" in html
    assert "nan" not in html


def test_nothing_binds_is_said():
    assert "No limit of the mission binds" in binds_section(Reading(rail()), [])


def test_prices_without_trials_say_that_they_are_not_confirmed(bryson_denham):
    html = report_page(bryson_denham, None)
    assert "What binds</h2>" in html
    assert "not confirmed: it was not solved again" in html


def test_what_is_not_solved_or_has_no_multipliers_has_no_prices():
    assert bindings_of(unsolved()) == []
    assert bindings_of(without_problem()) == []
    assert tried(unsolved(), {"transcription": HermiteSimpson(12)}) == []


def test_the_mission_and_the_vehicle_are_enclosed():
    html = reproduction(rail(), Enclosure("title = 'a <b>'", "mass = 1"))
    assert "<summary>mission.toml</summary>\n<pre>title = &#x27;a &lt;b&gt;&#x27;</pre>" in html
    assert "<pre>mass = 1</pre>" in html
    assert "skyknot solve mission.toml" in html
