"""The replay shows the flight that the equations give, turned once to east, north, up."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from gallery import SURROUNDINGS, flight, flown_along, rail, without_problem

from skyknot.report.camera import east_north_up
from skyknot.report.craft import rotation
from skyknot.report.reading import Reading
from skyknot.report.reflight import refly
from skyknot.report.replay import CAPTIONS, OWN, WEB, replay_element
from skyknot.report.replay_data import FRAMES, replay_data, turns
from skyknot.trajectory import SegmentData, Trajectory
from skyknot.verification.evidence import Evidence


@pytest.fixture(scope="module")
def data():
    return replay_data([Reading(flight())], wind=[3.0, -1.0, 0.5])


def turned(turn, vectors):
    """Rotate vectors (n, 3) by a unit quaternion (w, x, y, z)."""
    w, axis = turn[0], np.asarray(turn[1:])
    return vectors + 2 * np.cross(axis, np.cross(axis, vectors) + w * vectors)


def test_the_flight_drawn_is_the_one_the_certificate_flies():
    """Runge and Kutta in the report, Dormand and Prince in the verification: one flight."""
    solution = flight()
    reading = Reading(solution)
    verified = Evidence(solution.problem, solution.trajectory, {}).flown
    nodes = np.searchsorted(reading.times, solution.times)
    assert np.allclose(reading.flown[nodes], verified, atol=1e-5)


def test_a_flight_with_jumping_controls_is_flown_segment_by_segment():
    """x'' = a − 0.2 x', a = 1 and then −1: against the closed form on each half."""
    inside = SegmentData(
        rate_points=np.array([0.0]), rates=np.zeros((2, 1, 2)), control_points=np.array([0.0]),
        control_values=np.array([[[1.0]], [[-1.0]]]), interior_points=np.zeros(0),
        interior_states=np.zeros((2, 0, 2)),
    )  # fmt: skip
    plan = Trajectory([0, 1, 2], np.zeros((3, 2)), [[1], [-1], [-1]], inside)
    times = np.concatenate([np.linspace(0, 1 - 1e-9, 40), np.linspace(1, 2, 40)])
    v = refly(rail().problem, {}, plan, times)[:, 1]
    first = 5 * (1 - np.exp(-times / 5))
    second = -5 + (5 + 5 * (1 - np.exp(-0.2))) * np.exp(-(times - 1) / 5)
    assert np.allclose(v, np.where(times < 1, first, second), atol=1e-7)


def test_a_flight_that_tumbles_away_is_lost_from_there_on():
    solution = flown_along([(0, 0, -1), (60, 0, -1)])
    wild = np.tile([5.0, 1e3, 0.0, 0.0], (21, 1))
    tumbling = replace(solution, trajectory=replace(solution.trajectory, controls=wild))
    flown = Reading(tumbling).flown
    lost = np.any(np.isnan(flown), axis=1)
    assert lost[-1]
    assert not lost[0]
    assert np.array_equal(lost, np.sort(lost))
    vehicle = replay_data([Reading(tumbling)])["vehicles"][0]
    assert vehicle["source"] == "lost"
    assert vehicle["times"][-1] < 20
    assert CAPTIONS["lost"] in replay_element([Reading(tumbling)])


def test_positions_are_east_north_up(data):
    vehicle = data["vehicles"][0]
    assert vehicle["source"] == "flown"
    assert len(vehicle["places"]) == len(vehicle["times"]) == FRAMES
    assert vehicle["places"][0] == [0, 0, 0]
    north, east, down = Reading(flight()).flown[-1, :3]
    assert vehicle["places"][-1] == pytest.approx([east, north, -down], abs=1e-3)
    assert vehicle["goal"] == [6, 8, 5]
    assert data["wind"] == [-1, 3, -0.5]


def test_a_turn_takes_body_axes_to_east_north_up():
    angles = np.array([[0.3, -0.2, 2.0], [0.0, 0.0, 0.0], [-1.0, 0.7, -3.0]])
    for turn, angle in zip(turns(angles), angles, strict=True):
        assert np.linalg.norm(turn) == pytest.approx(1)
        expected = east_north_up(np.eye(3) @ rotation(*angle).T)
        assert np.allclose(turned(turn, np.eye(3)), expected, atol=1e-12)


def test_rotor_thrusts_come_with_every_frame(data):
    vehicle = data["vehicles"][0]
    thrusts = np.array(vehicle["thrusts"])
    assert thrusts.shape == (FRAMES, 4)
    assert np.allclose(thrusts[-1].sum(), flight().controls[-1, 0], atol=1e-3)
    assert replay_data([Reading(flight("yaw"))])["vehicles"][0]["thrusts"] is None


def test_every_shape_of_the_airspace_is_shown(data):
    names = {body["name"] for body in data["bodies"]}
    assert names == {c.name for c in SURROUNDINGS if c.shape.kind not in ("band", "half-space")}
    assert len(data["sheets"]) == 2  # the fence, the top of the band; its bottom is underground
    (hall,) = [body for body in data["bodies"] if body["name"] == "hall"]
    assert hall["center"] == [9, 4, 2]
    along = turned(np.array(hall["turn"]), np.array([[1.0, 0, 0]]))[0]
    assert along == pytest.approx([np.sin(0.3), np.cos(0.3), 0], abs=1e-5)


def test_several_craft_fly_in_one_replay():
    pair = [Reading(flight()), Reading(flown_along([(0, 0, -1), (30, -20, -9)]))]
    data = replay_data(pair)
    assert len(data["vehicles"]) == 2
    assert data["vehicles"][0]["color"] != data["vehicles"][1]["color"]
    for vehicle in data["vehicles"]:
        places = np.array(vehicle["plan"])
        assert np.all(places >= np.array(data["stage"]["low"]) - 1e-3)
        assert np.all(places <= np.array(data["stage"]["high"]) + 1e-3)
    assert len([body for body in data["bodies"] if body["name"] == "hall"]) == 1


def test_without_equations_the_plan_is_read():
    assert Reading(without_problem()).flown is None


def test_a_scale_of_thrust_stands_only_where_rotors_are_known():
    assert "rotor thrust 0" in replay_element([Reading(flight())])
    assert "rotor thrust 0" not in replay_element([Reading(flight("yaw"))])


def test_names_cannot_end_the_data():
    nasty = replace(flight().record, problem="</script><b>{data}")
    html = replay_element([Reading(replace(flight(), record=nasty))])
    (text,) = re.findall(r'<script type="application/json">(.*?)</script>', html, re.DOTALL)
    assert json.loads(text)["vehicles"][0]["name"] == "</script><b>{data}"
    assert "<b>" not in html
    assert "Replay of &lt;/script&gt;&lt;b&gt;{data} in" in html


def test_every_script_of_the_replay_is_shipped():
    own = {path.stem for path in WEB.glob("*.js")} - {"three.bundle", "three.entry"}
    assert own == set(OWN)


def test_all_that_the_scripts_use_of_three_js_is_in_the_bundle():
    """The entry names what the bundle exports; the bundle is built from it."""
    used = {
        name
        for script in OWN
        for name in re.findall(r"\bTHREE\.(\w+)", (WEB / f"{script}.js").read_text("utf-8"))
    }
    bundle = (WEB / "three.bundle.js").read_text("utf-8")
    exported = set(re.findall(r"(\w+):\(\)=>", bundle[: bundle.index("ShadowMaterial") + 10_000]))
    assert used
    assert used <= exported
