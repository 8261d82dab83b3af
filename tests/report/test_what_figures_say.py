"""Numbers in the figures are those of the solution, in the units that are named."""

from dataclasses import replace

import numpy as np
import pytest
from gallery import flight, flight_problem, flown_along, rail

from skyknot.report import draw
from skyknot.report.comparison import fly_guess, straight_guess
from skyknot.report.figures import illustrate
from skyknot.report.path_figure import PATH_FIGURE
from skyknot.report.progress import power_of_ten
from skyknot.report.reading import Reading
from skyknot.trajectory import Trajectory


def test_altitude_is_drawn_upward_and_angles_in_degrees():
    reading = Reading(flight())
    assert reading.state_line("z").node_values[-1] == pytest.approx(5.0, abs=1e-6)
    pitch = reading.state_line("theta")
    assert pitch.unit == "deg"
    assert np.allclose(pitch.node_values, np.rad2deg(flight().states[:, 7]))
    assert pitch.upper == pytest.approx(np.rad2deg(flight().problem.state_upper[7]))


def test_upward_quantities_swap_their_bounds():
    problem = flight_problem(state_bounds=([None] * 12, [None] * 5 + [2.0] + [None] * 6))
    line = Reading(replace(flight(), problem=problem)).state_line("vz")
    assert (line.lower, line.upper) == (-2.0, np.inf)


def test_lines_follow_the_interpolant_and_dots_are_nodes():
    line = Reading(flight()).state_line("x")
    assert np.allclose(line.values, flight().state(line.times)[:, 0])
    assert np.array_equal(line.node_values, flight().states[:, 0])
    assert len(line.times) > 10 * len(line.node_times)


def test_rotor_thrusts_of_a_wrench_add_up_to_the_thrust():
    lines = Reading(flight()).rotor_lines()
    total = sum(line.values for line in lines)
    assert np.allclose(total, Reading(flight()).controls[:, 0])
    assert lines[0].upper == flight().problem.vehicle.thrust_max


def test_rotor_thrusts_of_the_rotor_model_are_its_controls():
    solution = flight("rotor")
    lines = Reading(solution).rotor_lines()
    assert np.array_equal(lines[2].node_values, solution.controls[:, 2])


def test_a_rotor_asked_for_too_much_is_named():
    solution = flown_along([(0, 0, -1), (5, 0, -1)], "report")
    vehicle = solution.problem.vehicle
    weak = np.tile([4 * vehicle.thrust_max, 0.0, 0.0, -0.1], (21, 1))
    overdriven = replace(solution, trajectory=replace(solution.trajectory, controls=weak))
    assert "beyond its limits" in illustrate(overdriven, "rotors").caption
    assert "beyond its limits" not in illustrate(solution, "rotors").caption


def test_the_craft_is_said_to_be_larger_than_life_only_when_it_is():
    far = flown_along([(0, 0, -1), (80, 0, -10)])
    assert "20 times its size" in illustrate(far, "path").caption
    near = flown_along([(0, 0, -1), (1, 0, -1.2)])
    assert "to scale" in illustrate(near, "path").caption


def test_a_stretched_altitude_is_admitted():
    flat = flown_along([(0, 0, 0), (4000, 100, -50)])
    assert "heights are stretched" in illustrate(flat, "path").caption
    assert "stretched" not in illustrate(flight(), "path").caption


def test_obstacles_and_rooms_are_explained():
    caption = illustrate(flight(), "path").caption
    assert "grey: obstacles" in caption
    assert "light blue: the room to stay in" in caption
    assert "obstacles" not in illustrate(flown_along([(0, 0, 0), (9, 0, -3)]), "path").caption


def test_a_missed_goal_is_marked():
    away = flown_along([(0, 0, -1), (4, 0, -1)])
    aimed = replace(away, problem=flight_problem(target=[8.0, 0, -1] + [0] * 9, final=None))
    assert "diamond: the goal" in illustrate(aimed, "path").caption
    assert "diamond" not in illustrate(flight(), "path").caption


def test_a_hover_guess_flown_stays_where_it_starts():
    reading = Reading(flight())
    guess = straight_guess(reading)
    assert np.allclose(guess.states[-1, :3], [8, 6, -5])
    times, flown = fly_guess(reading, guess)
    assert times[-1] == pytest.approx(6.0)
    assert np.allclose(flown, 0.0, atol=1e-9)


def test_a_given_guess_is_flown_by_its_own_controls():
    """x'' = a − 0.2 x' under a = 1 from rest: v = 5 (1 − exp(−t/5))."""
    reading = Reading(rail(), Trajectory([0, 2], [[0, 0], [1, 0]], [[1], [1]]))
    times, flown = fly_guess(reading, reading.guess)
    assert np.allclose(flown[:, 1], 5 * (1 - np.exp(-times / 5)), atol=1e-6)


def test_a_guess_that_tumbles_away_is_drawn_as_far_as_it_goes():
    wild = np.array([flight().problem.vehicle.hover * 2 + [0, 0.5, 0.3, 0.1]] * 2)
    guess = Trajectory([0, 6], flight().states[[0, -1]], wild)
    figure = draw(flight(), "before_after", guess)
    low, high = figure.axes[0].get_ylim()
    assert high - low < 40


def test_the_small_picture_of_the_overview_is_the_same_scene():
    assert PATH_FIGURE.applies(Reading(flight()))
    texts = [t.get_text() for t in draw(flight(), "overview").axes[0].texts]
    assert "altitude −z [m]" in texts


def test_powers_of_ten_are_plain_characters():
    assert power_of_ten(1e-6) == "10⁻⁶"
    assert power_of_ten(100.0) == "10²"
