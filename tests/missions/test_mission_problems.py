"""A mission file means what it says: each field has the effect its description promises."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from broken_missions import SOUND

import skyknot as sk
from skyknot import missions
from skyknot.missions import vehicles

HUMMINGBIRD = vehicles.load("hummingbird")


def with_line(after: str, line: str) -> missions.Mission:
    assert SOUND.count(after) == 1
    return missions.parse(SOUND.replace(after, f"{after}\n{line}"))


def constraint(mission: missions.Mission, name: str) -> Any:
    return next(e for e in (*mission.problem.path, *mission.problem.points) if e.name == name)


def value(mission: missions.Mission, name: str, x: Any, u: Any = (0, 0, 0, 0)) -> float:
    return float(constraint(mission, name).function(list(map(float, x)), list(map(float, u))))


def running_cost(mission: missions.Mission, x: Any, u: Any) -> float:
    problem = mission.problem
    return float(ca.DM(problem.running_cost_of(ca.DM(list(x)), ca.DM(list(u)), {}, 0.0)))


def at(*position: float) -> np.ndarray:
    return np.array([*position, *[0.0] * 9])


def test_altitude_is_minus_down() -> None:
    by_altitude = missions.parse(SOUND)
    by_down = missions.parse(
        SOUND.replace("position = [30.0, 0.0]\naltitude = 5.0", "position = [30.0, 0.0, -5.0]")
    )
    np.testing.assert_array_equal(by_altitude.problem.target, by_down.problem.target)


def test_degrees_and_radians_agree() -> None:
    degrees = with_line("altitude = 5.0", "yaw_degrees = 90.0").problem.target
    assert degrees is not None
    assert degrees[8] == math.pi / 2
    radians = with_line("altitude = 5.0", f"yaw = {math.pi / 2!r}").problem.target
    np.testing.assert_array_equal(degrees, radians)


@pytest.mark.parametrize(("reach", "fixed"), [("exact", 12), ("position", 3)])
def test_reach_fixes_as_many_states_as_it_says(reach: str, fixed: int) -> None:
    problem = with_line("altitude = 5.0", f'reach = "{reach}"').problem
    assert np.count_nonzero(problem.final_lower == problem.final_upper) == fixed


def test_a_waypoint_is_due_when_its_share_of_the_straight_path_is_flown() -> None:
    gate = constraint(missions.parse(SOUND), "gate")
    assert gate.at == pytest.approx(0.5)
    early = constraint(with_line("tolerance = 1.0", "at = 0.25"), "gate")
    assert early.at == 0.25


def test_a_waypoint_measures_the_distance_from_it() -> None:
    mission = missions.parse(SOUND)
    gate = constraint(mission, "gate")
    assert gate.upper == 1.0
    assert value(mission, "gate", at(15.0, 6.0, -10.0)) == pytest.approx(2.0, rel=1e-6)


def test_a_solved_mission_flies_by_its_waypoint() -> None:
    mission = missions.parse(SOUND)
    solution = sk.solve(mission.problem, **mission.settings())
    assert solution.success, solution.message
    halfway = solution.state(0.5 * solution.trajectory.duration)
    assert np.linalg.norm(halfway[:3] - [15.0, 6.0, -8.0]) < 1.0 + 1e-5


def test_limits_only_ever_tighten() -> None:
    problem = with_line(
        "speed = 6.0", "speed_per_axis = [9.0, 2.0, 9.0]\nclimb = 1.0\ndescent = 0.5"
    ).problem
    np.testing.assert_array_equal(problem.state_lower[3:6], [-6.0, -2.0, -1.0])
    np.testing.assert_array_equal(problem.state_upper[3:6], [6.0, 2.0, 0.5])


def test_the_vehicles_own_limits_hold_without_being_named() -> None:
    mission = missions.load("vertiport_hop")
    rates = mission.vehicle.limits.body_rates
    assert rates is not None
    np.testing.assert_allclose(mission.problem.state_upper[9:], rates)


def test_body_rates_and_control_rates_bound_what_they_name() -> None:
    problem = with_line(
        "speed = 6.0", "body_rates = [1.0, 2.0, 3.0]\ncontrol_rates = [5.0, 0.1, 0.2, 0.3]"
    ).problem
    np.testing.assert_array_equal(problem.state_upper[9:], [1.0, 2.0, 3.0])
    np.testing.assert_array_equal(problem.rate_upper, [5.0, 0.1, 0.2, 0.3])


@pytest.mark.parametrize("name", ["acceleration", "felt acceleration"])
def test_accelerations_are_zero_in_hover_and_one_g_in_free_fall(name: str) -> None:
    mission = with_line("speed = 6.0", f"{name.replace(' ', '_')}_g = 0.3")
    assert value(mission, name, at(0, 0, 0), HUMMINGBIRD.hover) < 1e-3
    assert value(mission, name, at(0, 0, 0)) == pytest.approx(1.0, rel=1e-6)
    assert constraint(mission, name).upper == 0.3


def test_level_acceleration_is_not_felt_sideways_in_a_multirotor() -> None:
    mission = with_line("speed = 6.0", "acceleration_g = 0.9\nfelt_acceleration_g = 0.9")
    state = at(0, 0, 0)
    state[7] = math.radians(30.0)
    level = [HUMMINGBIRD.weight / math.cos(state[7]), 0, 0, 0]
    world = value(mission, "acceleration", state, level)
    felt = value(mission, "felt acceleration", state, level)
    assert world == pytest.approx(math.tan(state[7]), rel=1e-5)
    assert felt == pytest.approx(1 / math.cos(state[7]) - 1, rel=1e-4)


def test_wind_acts_through_drag() -> None:
    windy = missions.parse(SOUND.replace('"hummingbird"', '"hummingbird"\nwind = [3.0, 0.0, 0.0]'))
    calm = missions.parse(SOUND)
    x, u = ca.DM(at(0, 0, 0)), ca.DM(HUMMINGBIRD.hover)
    pushed = ca.DM(windy.problem.rates_of(x, u, {}, 0.0)).full().ravel()
    still = ca.DM(calm.problem.rates_of(x, u, {}, 0.0)).full().ravel()
    assert pushed[3] - still[3] == pytest.approx(3.0 * HUMMINGBIRD.drag[0] / HUMMINGBIRD.mass)


@pytest.mark.parametrize("model", ["wrench", "rotors"])
def test_energy_of_hovering_is_hover_power_times_time(model: str) -> None:
    text = SOUND.replace('kind = "effort"', 'kind = "energy"').replace("time = 1.0", "time = 0.0")
    mission = missions.parse(
        text.replace(
            'vehicle = "hummingbird"', f'vehicle = "nasa_six_passenger"\nmodel = "{model}"'
        )
    )
    hover = HOVER_OF[model](mission.vehicle)
    assert mission.vehicle.power is not None
    assert running_cost(mission, at(0, 0, 0), hover) == pytest.approx(
        mission.vehicle.power.hover / 1e3, rel=1e-5
    )
    assert running_cost(mission, at(0, 0, 0), 1.2 * hover) == pytest.approx(
        mission.vehicle.power.hover / 1e3 * 1.2**1.5 + effort(mission, 0.2 * hover),
        rel=1e-5,
    )


HOVER_OF = {
    "wrench": lambda vehicle: vehicle.hover,
    "rotors": lambda vehicle: np.asarray(vehicle.rotor_thrusts(vehicle.hover)),
}


def effort(mission: missions.Mission, deviation: np.ndarray) -> float:
    return float(np.asarray(mission.file.objective.R) @ deviation**2)


def test_effort_counts_the_distance_from_hover_and_the_price_of_time() -> None:
    mission = missions.parse(SOUND)
    assert running_cost(mission, at(0, 0, 0), HUMMINGBIRD.hover) == pytest.approx(1.0)
    pushed = np.add(HUMMINGBIRD.hover, [2.0, 0.1, 0.0, 0.0])
    assert running_cost(mission, at(0, 0, 0), pushed) == pytest.approx(1.0 + 0.4 + 1.0)


def test_settings_carry_what_the_mission_chooses_and_nothing_else() -> None:
    mission = missions.parse(SOUND)
    assert mission.settings() == {
        "transcription": {"scheme": "hermite-simpson", "segments": 40},
        "tolerance": 1e-6,
        "guess": None,
        "accuracy": 1e-4,
    }
    chosen = missions.parse(
        SOUND.replace(
            "segments = 40",
            'segments = 12\ncontrols = "linear"\nenforce = "nodes"\naccuracy = "off"',
        )
        + '[solver]\nname = "ipopt"\ntolerance = 1e-4\n[guess]\nkind = "flat"\n'
    ).settings()
    assert chosen["solver"] == "ipopt"
    assert chosen["tolerance"] == 1e-4
    assert chosen["accuracy"] is None
    assert chosen["transcription"] == {
        "scheme": "hermite-simpson",
        "segments": 12,
        "controls": "linear",
        "enforce": "nodes",
    }
    assert isinstance(chosen["guess"], sk.Trajectory)


def test_a_guess_via_points_passes_them_from_rest_to_rest() -> None:
    mission = missions.parse(
        SOUND + '[guess]\nkind = "via"\npoints = [[10.0, 10.0, -9.0], [20.0, 10.0, -9.0]]\n'
    )
    guess = mission.guess
    assert guess is not None
    for corner in ([0, 0, -5], [10, 10, -9], [20, 10, -9], [30, 0, -5]):
        assert np.min(np.linalg.norm(guess.states[:, :3] - corner, axis=1)) < 0.5
    assert np.linalg.norm(guess.states[[0, -1], 3:6], axis=1).max() < 0.2


def test_every_kind_of_obstacle_keeps_out_by_its_true_size() -> None:
    obstacles = """
[[airspace.obstacles]]
kind = "sphere"
name = "balloon"
center = [15.0, 30.0, -20.0]
radius = 3.0
[[airspace.obstacles]]
kind = "ellipsoid"
name = "tree"
center = [15.0, 30.0, -5.0]
semi_axes = [2.0, 2.0, 5.0]
[[airspace.obstacles]]
kind = "building"
name = "house"
center = [15.0, -30.0]
size = [10.0, 6.0]
height = 8.0
yaw_degrees = 90.0
[[airspace.obstacles]]
kind = "box"
name = "crate"
center = [15.0, -60.0, -5.0]
size = [2.0, 2.0, 2.0]
[[airspace.obstacles]]
kind = "half-space"
name = "fence"
normal = [0.0, 1.0, 0.0]
offset = -80.0
"""
    mission = missions.parse(SOUND.replace("[scheme]", obstacles + "[scheme]"))
    inside = {
        "balloon": (15, 30, -20),
        "tree": (15, 30, -9),
        "house": (15, -34, -1),
        "crate": (15, -60, -5),
        "fence": (0, -81, 0),
    }
    outside = {
        "balloon": (15, 30, -24),
        "tree": (15, 33, -5),
        "house": (15, -36.5, -1),
        "crate": (15, -60, -7.5),
        "fence": (0, -79, 0),
    }
    assert all(value(mission, name, at(*place)) < 0 for name, place in inside.items())
    assert all(value(mission, name, at(*place)) > 0 for name, place in outside.items())


def test_a_building_stands_on_the_ground_up_to_its_height() -> None:
    house = '[[airspace.obstacles]]\nkind = "building"\nname = "house"\ncenter = [15.0, -30.0]\n'
    mission = missions.parse(
        SOUND.replace("[scheme]", house + "size = [10.0, 10.0]\nheight = 8.0\n[scheme]")
    )
    assert (
        value(mission, "house", at(15, -30, -7.9)) < 0 < value(mission, "house", at(15, -30, -9.0))
    )
    assert value(mission, "house", at(15, -30, -0.1)) < 0


def test_a_corridor_keeps_the_flight_inside() -> None:
    lane = '[[airspace.corridors]]\nname = "lane"\nradius = 12.0\n'
    mission = missions.parse(
        SOUND.replace("[scheme]", lane + "points = [[0, 0, -5], [30, 0, -5]]\n[scheme]")
    )
    assert value(mission, "lane", at(15, 5, -5)) > 0 > value(mission, "lane", at(15, 13, -5))


def test_a_vehicle_file_is_found_from_the_mission_file(tmp_path: Path) -> None:
    (tmp_path / "craft").mkdir()
    text = (vehicles.FOLDER / "hummingbird.toml").read_text(encoding="utf-8")
    (tmp_path / "craft" / "mine.toml").write_text(text, encoding="utf-8")
    path = tmp_path / "hop.toml"
    path.write_text(SOUND.replace('"hummingbird"', '"craft/mine.toml"'), encoding="utf-8")
    assert missions.load(path).vehicle == HUMMINGBIRD
