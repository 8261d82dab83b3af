"""The library's three reference missions have the reference objectives.

Objectives: Ipopt with tolerance 1e-9 on the same Hermite-Simpson programs, rounded to the digits
shown; agreement is asked to 1e-6.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import skyknot as sk
from skyknot import missions

FREE_END = {25: 114.223280, 50: 114.708332, 100: 115.179019, 200: 115.194267, 400: 115.210674}


def solved(name: str, segments: int = 100) -> sk.Solution:
    mission = missions.load(name)
    settings = mission.settings() | {"solver": "ipopt", "accuracy": None}
    settings["transcription"] = settings["transcription"] | {"segments": segments}
    return sk.solve(mission.problem, **settings)


@pytest.mark.parametrize("segments", FREE_END)
def test_the_report_transfer_has_the_reference_objective(segments: int) -> None:
    solution = solved("report_transfer", segments)
    assert solution.success, solution.message
    assert solution.objective == pytest.approx(FREE_END[segments], rel=1e-6)


def test_the_constrained_transfer_has_the_reference_objective() -> None:
    solution = solved("report_transfer_constrained")
    assert solution.success, solution.message
    assert solution.objective == pytest.approx(158.146203, rel=1e-6)


def test_the_minimum_time_transfer_takes_the_reference_time() -> None:
    solution = solved("minimum_time")
    assert solution.success, solution.message
    assert solution.objective == pytest.approx(3.64292383, rel=1e-6)
    assert solution.trajectory.duration == pytest.approx(solution.objective, rel=1e-12)


def test_the_guess_of_the_report_transfer_is_a_straight_line_at_hover() -> None:
    mission = missions.load("report_transfer")
    assert mission.guess is not None
    share = mission.guess.times / 10.0
    np.testing.assert_allclose(
        mission.guess.states[:, :3], share[:, None] * [8.0, 6.0, -5.0], atol=1e-12
    )
    np.testing.assert_allclose(mission.guess.states[:, 8], share * np.pi / 2, atol=1e-12)
    np.testing.assert_allclose(mission.guess.controls, np.tile([1.2 * 9.81, 0, 0, 0], (81, 1)))


def test_the_bow_of_the_constrained_transfer_goes_right_of_the_line() -> None:
    guess = missions.load("report_transfer_constrained").guess
    assert guess is not None
    line = guess.times[:, None] / 10.0 * [8.0, 6.0]
    bow = 1.2 * np.sin(np.pi * guess.times / 10.0)[:, None] * [-0.6, 0.8]
    np.testing.assert_allclose(guess.states[:, :2], line + bow, atol=1e-12)


def test_a_mission_is_frozen() -> None:
    mission = missions.load("minimum_time")
    with pytest.raises(dataclasses.FrozenInstanceError, match="cannot assign to field"):
        mission.name = "another"  # type: ignore[misc]
