"""Clearance, mesh, power and Hamiltonian are measured right: against closed forms."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gallery import flight, flight_problem, flown_along, rail

from skyknot.problem import airspace
from skyknot.problem.problem import Problem
from skyknot.report.along_the_way import clearances, constraint_lines
from skyknot.report.costate_figure import hamiltonian
from skyknot.report.figures import illustrate
from skyknot.report.mesh_figure import segment_errors
from skyknot.report.panels import arcs_at
from skyknot.report.reading import Line, Reading
from skyknot.solve import solve
from skyknot.transcription import HermiteSimpson


def test_clearance_is_the_distance_to_the_obstacle_less_what_is_to_be_kept():
    ball = airspace.sphere("ball", (0.0, 3.0, -1.0), 1.0, clearance=0.5)
    solution = flown_along([(-10, 0, -1), (10, 0, -1)])
    problem = flight_problem(vehicle="hummingbird", horizon=20.0, final=None, path=[ball])
    (line,) = clearances(Reading(replace(solution, problem=problem)))
    north = solution.state(line.times)[:, 0]
    assert np.allclose(line.values, np.hypot(north, 3.0) - 1.5, atol=1e-5)


def test_a_band_leaves_the_smaller_of_both_rooms():
    band = airspace.altitude_band("band", 1.0, 4.0)
    solution = flown_along([(0, 0, -1), (10, 0, -4)])
    problem = flight_problem(vehicle="hummingbird", horizon=20.0, final=None, path=[band])
    (line,) = clearances(Reading(replace(solution, problem=problem)))
    height = -solution.state(line.times)[:, 2]
    assert np.allclose(line.values, np.minimum(height - 1, 4 - height))


def test_the_least_clearance_is_told_with_its_name_and_time():
    caption = illustrate(flight(), "clearance").caption
    assert "Least: " in caption
    assert any(f"'{line.label}'" in caption for line in clearances(Reading(flight())))


def test_other_constraints_keep_their_bounds_and_unit():
    ((line, shaped),) = constraint_lines(Reading(rail()))
    assert not shaped
    assert (line.label, line.unit, line.upper) == ("fence", "m", 1.2)
    assert np.allclose(line.values, rail().state(line.times)[:, 0])


def test_active_arcs_are_the_times_on_a_bound():
    times = np.linspace(0, 10, 1001)
    values = np.minimum(times, 6.0)
    line = Line("v", "m/s", times, values, times, values, 0.0, 6.0)
    ((start, end),) = arcs_at(line, 6.0)
    assert (start, end) == (pytest.approx(6.0, abs=0.02), 10.0)
    assert arcs_at(replace(line, upper=np.inf), np.inf) == []


def test_errors_of_segments_fall_with_the_order_of_the_interpolant():
    """x' = u, u quadratic and x cubic are exact; a swing is wrong by the third power and less."""

    def swing(segments):
        problem = Problem(
            "swing", ["x", "v"], ["u"], lambda x, u: [x[1], u[0] - 9 * x[0]], 2.0,
            initial=[1, 0], final=[0, 0], running_cost=lambda x, u: u[0] ** 2,
        )  # fmt: skip
        return np.max(segment_errors(Reading(solve(problem, HermiteSimpson(segments)))))

    assert swing(20) / swing(40) > 7
    problem = Problem("line", ["x"], ["u"], lambda x, u: [u[0]], 1.0, [0], [1],
                      running_cost=lambda x, u: u[0] ** 2)  # fmt: skip
    assert np.max(segment_errors(Reading(solve(problem, HermiteSimpson(4))))) < 1e-12


def test_meshes_of_a_refinement_are_shown_where_there_are_some():
    rounds = tuple(SimpleNamespace(segments=20 * 2**i, error=10.0**-i) for i in (2, 3, 4))
    refined = replace(rail(), record=replace(rail().record, rounds=rounds, accuracy=1e-4))
    picture = illustrate(refined, "mesh")
    assert "3 meshes" in picture.caption
    assert [text.get_text() for text in picture.figure.axes[2].texts] == ["80", "160", "320"]
    assert "meshes" not in illustrate(rail(), "mesh").caption


def test_power_in_hover_is_the_power_of_hovering():
    solution = flown_along([(0, 0, -1), (0, 0, -1)], duration=36.0)
    power, energy = illustrate(solution, "power").figure.axes
    hover = solution.problem.vehicle.hover_power
    assert power.lines[0].get_ydata() == pytest.approx(hover)
    assert energy.lines[0].get_ydata()[-1] == pytest.approx(hover * 36 / 3600)


def test_the_hamiltonian_of_the_minimum_energy_line_is_its_closed_form():
    """min ∫ u² dt, x' = u, from 0 to 1 in 2 s: u = 1/2, p = −1, H = u² + p u = −1/4."""
    problem = Problem("line", ["x"], ["u"], lambda x, u: [u[0]], 2.0, [0], [1],
                      running_cost=lambda x, u: u[0] ** 2)  # fmt: skip
    solution = solve(problem, HermiteSimpson(5))
    assert hamiltonian(Reading(solution)) == pytest.approx(-0.25, abs=1e-6)
