"""Claim: cold starts on random missions end well, and where Ipopt's do, at the same optimum.

Twenty seeds of the robustness study (``skyknot bench --robustness`` runs three hundred), chosen
from those that both solvers solve in a second or so and all builds of the kernel end alike
(elsewhere rounding may pick one of two neighbouring optima): all vehicles, models and objectives,
fixed and free horizons, none to six obstacles, waypoints, corridors, limits.
"""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot.bench.random_missions import OBSTACLES, random_mission
from skyknot.bench.robustness import (
    WRONG,
    Attempt,
    Case,
    attempt,
    iteration_log,
    judged,
    study,
    summary,
)
from skyknot.solvers.interior_point import InteriorPoint
from skyknot.solvers.ipopt import Ipopt

SEEDS = (0, 3, 13, 23, 26, 29, 32, 34, 38, 44, 51, 53, 57, 63, 83, 86, 94, 127, 160, 170)
IMPOSSIBLE = 55  # both call it locally infeasible: a turn of 1.5 rad at 0.3 rad/s in 3.6 s


@pytest.mark.parametrize("seed", SEEDS)
def test_both_solvers_end_at_the_same_optimum(seed):
    own, _ = attempt(seed, InteriorPoint())
    ipopt, _ = attempt(seed, Ipopt())
    assert own.success, own.detail
    assert ipopt.success, ipopt.detail
    assert own.objective == pytest.approx(ipopt.objective, rel=1e-4)
    assert own.load <= WRONG, own.worst_check


def test_an_impossible_mission_is_called_infeasible_by_both():
    own, _ = attempt(IMPOSSIBLE, InteriorPoint())
    ipopt, _ = attempt(IMPOSSIBLE, Ipopt())
    assert own.status == ipopt.status == sk.Status.INFEASIBLE
    assert own.detail.startswith("The largest violation is")


def test_a_seed_is_one_mission():
    assert random_mission(7).text == random_mission(7).text
    assert random_mission(7).text != random_mission(8).text


def test_the_seeds_of_this_file_are_a_mixed_lot():
    files = [random_mission(seed).file for seed in SEEDS]
    assert len({file.vehicle for file in files}) == 6
    assert len({file.model for file in files}) == 3
    assert {file.objective.kind for file in files} >= {"tracking", "effort", "minimum-time"}
    assert {file.horizon.free is None for file in files} == {True, False}
    kinds = {obstacle.kind for file in files for obstacle in file.airspace.obstacles}
    assert kinds == set(OBSTACLES)
    counts = {len(file.airspace.obstacles) for file in files}
    assert {0, 6} <= counts


def test_a_success_that_breaks_a_limit_is_judged_wrong():
    """A solution of another mission does not pass for one of this."""
    mission = random_mission(13)
    _, solution = attempt(13, InteriorPoint())
    _, load = judged(mission.problem, solution)
    assert load <= 1.0
    shifted = sk.Trajectory(
        solution.times, solution.states + np.eye(len(solution.states[0]))[0], solution.controls
    )
    worst, load = judged(mission.problem, shifted)
    assert load > WRONG
    assert worst


def case(seed, own, peer):
    attempts = {
        name: Attempt(name, "", success, 10, 0.1, objective, 0.0, "", "", load)
        for name, (success, objective, load) in {"interior-point": own, "ipopt": peer}.items()
    }
    return Case(seed, "", attempts)


def test_the_summary_sorts_the_cases():
    nan = float("nan")
    found = summary(
        [
            case(1, (True, 1.0, 0.1), (True, 1.0, 0.1)),
            case(2, (True, 1.1, 0.1), (True, 1.0, 0.1)),
            case(3, (True, 0.9, 99.0), (True, 1.0, 0.1)),
            case(4, (False, nan, nan), (True, 1.0, 0.1)),
            case(5, (True, 1.0, nan), (False, nan, nan)),
            case(6, (False, nan, nan), (False, nan, nan)),
        ]
    )
    assert found["solved"] == {"interior-point": 4, "ipopt": 4}
    assert (found["only_peer_solves"], found["only_we_solve"]) == ([4], [5])
    assert found["neither_solves"] == [6]
    assert found["wrong"] == {"interior-point": [3, 5], "ipopt": []}
    assert (found["same_optimum"], found["ours_worse"], found["ours_better"]) == (1, [2], [3])


def test_a_study_is_taken_up_where_it_stopped(tmp_path):
    solvers = (InteriorPoint(), InteriorPoint(name="ipopt"))
    first = study([13], solvers, tmp_path)
    told = []
    again = study([13, 34], solvers, tmp_path, told.append)
    assert again[0] == first[0]
    assert [each.seed for each in told] == [13, 34]
    assert len((tmp_path / "cases.jsonl").read_text(encoding="utf-8").splitlines()) == 2


def test_a_failure_leaves_its_mission_and_its_log(tmp_path):
    study([IMPOSSIBLE], (InteriorPoint(),), tmp_path)
    assert sk.missions.load(tmp_path / f"seed_{IMPOSSIBLE}.toml").problem.nx == 7
    log = (tmp_path / f"seed_{IMPOSSIBLE}_interior-point.txt").read_text(encoding="utf-8")
    assert log.splitlines()[0].split()[0] == "iteration"
    assert "Locally infeasible" in log
    _, solution = attempt(IMPOSSIBLE, InteriorPoint())
    assert len(iteration_log(solution).splitlines()) == len(solution.history) + 2
