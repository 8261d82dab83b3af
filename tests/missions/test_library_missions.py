"""Every mission of the library solves, and every answer is certified and flies as it says."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import skyknot as sk
from skyknot import missions
from skyknot.verification import Certificate

SMOOTH = ("city_hop", "vertiport_hop", "yaw_point_transfer")
"""Missions whose control is meant for actuators: no bang-bang."""


@cache
def answer(name: str) -> tuple[missions.Mission, sk.Solution, Certificate]:
    mission = missions.load(name)
    solution = sk.solve(mission.problem, **mission.settings())
    return mission, solution, solution.verify()


@pytest.fixture(params=missions.names())
def flown(request: pytest.FixtureRequest) -> tuple[missions.Mission, sk.Solution, Certificate]:
    return answer(request.param)


def test_the_mission_solves(
    flown: tuple[missions.Mission, sk.Solution, Certificate],
) -> None:
    _, solution, _ = flown
    assert solution.success, solution.message


def test_the_answer_is_certified(
    flown: tuple[missions.Mission, sk.Solution, Certificate],
) -> None:
    _, _, certificate = flown
    assert certificate.passed, certificate.sentence


def test_its_control_flown_open_loop_stays_within_two_millimetres(
    flown: tuple[missions.Mission, sk.Solution, Certificate],
) -> None:
    _, _, certificate = flown
    assert certificate.checks["open-loop flight"].value < 0.002


def test_its_mesh_is_refined_until_it_is_accurate_and_not_for_ever(
    flown: tuple[missions.Mission, sk.Solution, Certificate],
) -> None:
    _, solution, _ = flown
    assert solution.rounds[-1].error <= solution.record.accuracy
    assert len(solution.rounds) <= 8
    assert solution.record.segments < 800


@pytest.mark.parametrize("name", SMOOTH)
def test_the_control_is_smooth_and_not_bang_bang(name: str) -> None:
    mission, solution, _ = answer(name)
    lower, upper = mission.problem.control_lower, mission.problem.control_upper
    at_a_bound = np.minimum(solution.controls - lower, upper - solution.controls) < 1e-3 * (
        upper - lower
    )
    assert np.mean(at_a_bound) < 0.15


def test_refining_the_report_transfer_costs_at_most_three_solves_on_a_hundred_segments() -> None:
    """Counted as iterations times segments, which is what the time of a solve grows with."""
    mission, refined, _ = answer("report_transfer")
    even = {"transcription": sk.HermiteSimpson(100), "accuracy": None}
    solution = sk.solve(mission.problem, **(mission.settings() | even))
    work = sum(entry.iterations * entry.segments for entry in refined.rounds)
    assert work <= 3 * solution.iterations * solution.record.segments


def test_three_times_the_segments_of_the_report_transfer_laid_evenly_fly_far_worse() -> None:
    mission, refined, certificate = answer("report_transfer")
    even = {"transcription": sk.HermiteSimpson(3 * refined.record.segments), "accuracy": None}
    solution = sk.solve(mission.problem, **(mission.settings() | even))
    misses = [each.checks["open-loop flight"].value for each in (certificate, solution.verify())]
    assert misses[0] < 2e-4
    assert misses[1] > 50 * misses[0]


def test_the_city_has_at_least_six_buildings_of_different_heights() -> None:
    obstacles = missions.load("city_hop").file.airspace.obstacles
    heights = {obstacle.height for obstacle in obstacles if obstacle.kind == "building"}
    assert len(obstacles) >= 6
    assert len(heights) >= 6


def test_the_vertiport_hop_rises_and_sinks_almost_vertically() -> None:
    mission, solution, _ = answer("vertiport_hop")
    states = solution.state(np.linspace(0.0, solution.times[-1], 200))
    low = -states[:, 2] < 25.0
    pads = np.array([mission.file.start.ned[:2], mission.file.goal.ned[:2]])
    away = np.linalg.norm(states[low, None, :2] - pads[None], axis=2).min(axis=1)
    assert len(away) > 20
    assert np.max(away) < 10.0


def test_passengers_feel_no_more_than_they_were_promised() -> None:
    _, solution, _ = answer("vertiport_hop")
    rates = solution.trajectory.state_rate(solution.times)
    acceleration = np.linalg.norm(rates[:, 3:6], axis=1) / 9.81
    assert np.max(acceleration) < 0.3 * (1 + 1e-3)
    assert np.max(acceleration) > 0.25


@pytest.mark.parametrize("name", missions.names())
def test_every_mission_has_a_title_and_a_description(name: str) -> None:
    mission = missions.load(name)
    assert 10 < len(mission.title) < 70
    assert len(mission.description) > 100
