"""Claim: plans are what QGroundControl documents, and say how far they are from the flight."""

from __future__ import annotations

import json
import re

import jsonschema
import numpy as np
import pytest

from export.flights import CERTIFIED, DURATION, flown
from export.readers import HOME, read_plan
from report.gallery import flight
from skyknot.export import write_export

NUMBER, WHOLE = {"type": "number"}, {"type": "integer", "minimum": 0}
PLACE = {"type": "array", "items": NUMBER, "minItems": 3, "maxItems": 3}
EMPTY = {"type": "array", "maxItems": 0}
ITEM = {
    "properties": {
        "type": {"const": "SimpleItem"},
        "AMSLAltAboveTerrain": {"type": ["number", "null"]},
        "Altitude": NUMBER,
        "AltitudeMode": WHOLE,
        "autoContinue": {"type": "boolean"},
        "command": {"enum": [16, 22, 178]},
        "doJumpId": WHOLE,
        "frame": {"enum": [2, 3]},
        "params": {"type": "array", "minItems": 7, "maxItems": 7},
    },
    "required": ["type", "autoContinue", "command", "doJumpId", "frame", "params"],
    "additionalProperties": False,
}
MISSION = {
    "version": {"const": 2},
    "firmwareType": {"const": 12},
    "globalPlanAltitudeMode": WHOLE,
    "vehicleType": {"const": 2},
    "cruiseSpeed": NUMBER,
    "hoverSpeed": NUMBER,
    "items": {"type": "array", "items": ITEM, "minItems": 1},
    "plannedHomePosition": PLACE,
}
SCHEMA = {
    "properties": {
        "version": {"const": 1},
        "fileType": {"const": "Plan"},
        "groundStation": {"type": "string"},
        "mission": {"properties": MISSION, "required": list(MISSION)},
        "geoFence": {
            "properties": {"circles": EMPTY, "polygons": EMPTY, "version": {"const": 2}},
            "required": ["circles", "polygons", "version"],
        },
        "rallyPoints": {
            "properties": {"points": EMPTY, "version": {"const": 2}},
            "required": ["points", "version"],
        },
    },
    "required": ["version", "fileType", "groundStation", "mission", "geoFence", "rallyPoints"],
}
"""The tables of docs.qgroundcontrol.com, developer guide, "Plan File Format", as a schema."""

FLIGHTS = {
    "asymmetric path": lambda: flown("asymmetric path"),
    "pure yaw": lambda: flown("pure yaw"),
    "transfer": lambda: flight("yaw"),
    "rigid transfer": lambda: flight("wrench"),
}


def planned(folder, solution, rate=None):
    path, origin = folder / "f.plan", ",".join(map(str, HOME))
    written = write_export(solution, path, rate=rate, origin=origin, certificate=CERTIFIED)
    return written, json.loads(path.read_text(encoding="utf-8")), read_plan(path)


@pytest.mark.parametrize("name", FLIGHTS)
def test_the_plan_fits_the_documented_form(name, tmp_path):
    _, plan, _ = planned(tmp_path, FLIGHTS[name]())
    jsonschema.Draft202012Validator(SCHEMA).validate(plan)
    items = plan["mission"]["items"]
    assert [item["doJumpId"] for item in items] == list(range(1, len(items) + 1))
    assert [item["command"] for item in items[:2]] == [22, 16]
    assert [item["command"] for item in items[2:]] == [178, 16] * ((len(items) - 2) // 2)


def test_the_schema_catches_what_is_missing(tmp_path):
    _, plan, _ = planned(tmp_path, flown("pure yaw"))
    del plan["mission"]["hoverSpeed"]
    with pytest.raises(jsonschema.ValidationError, match="hoverSpeed"):
        jsonschema.Draft202012Validator(SCHEMA).validate(plan)


@pytest.mark.parametrize("rate", [None, 3.0])
@pytest.mark.parametrize("name", FLIGHTS)
def test_the_plan_says_how_far_it_is_from_the_flight(name, rate, tmp_path):
    """The reader flies the plan and compares, at other times than the writer did."""
    solution = FLIGHTS[name]()
    written, _, read = planned(tmp_path, solution, rate)
    apart, late = map(float, re.findall(r"([\d.e+-]+) (?:m|s) at the same", written.accuracy))
    t = np.linspace(0, read.times[-1], 1777)
    path = solution.trajectory.state(t)[:, :3]
    found = np.stack([np.interp(t, read.times, read.position[:, i]) for i in range(3)], axis=1)
    measured = np.linalg.norm(found - path, axis=1).max()
    assert measured <= 1.06 * apart + 1e-3  # two digits are told
    assert apart <= 1.06 * measured + 1e-3
    assert read.times[-1] == pytest.approx(solution.trajectory.duration, abs=1e-2)
    assert _delay(t, path, read) == pytest.approx(late, rel=0.1, abs=0.02)


def _delay(t, path, read):
    """Return the largest difference between when flight and plan pass the same place of a leg."""
    worst = 0.0
    for k in range(len(read.times) - 1):
        way = read.position[k + 1] - read.position[k]
        L, inside = np.linalg.norm(way), (t > read.times[k]) & (t < read.times[k + 1])
        if L < 0.02:
            continue
        share = np.clip((path[inside] - read.position[k]) @ way / L**2, 0, 1)
        passes = read.times[k] + share * (read.times[k + 1] - read.times[k])
        worst = max(worst, np.abs(passes - t[inside]).max(initial=0.0))
    return worst


@pytest.mark.parametrize("name", FLIGHTS)
def test_few_waypoints_are_chosen_and_stay_within_half_a_metre(name, tmp_path):
    written, _, read = planned(tmp_path, FLIGHTS[name]())
    assert written.samples == len(read.times) < 25
    assert float(re.search(r"within ([\d.]+) m", written.accuracy)[1]) <= 0.5


def test_a_craft_that_only_turns_waits_at_waypoints_with_its_heading(tmp_path):
    _, plan, read = planned(tmp_path, flown("pure yaw"), rate=2)
    waits = [i["params"][0] for i in plan["mission"]["items"] if i["command"] == 16]
    assert waits == pytest.approx([0.5] * 8 + [0.0])
    assert read.times[-1] == pytest.approx(DURATION)
    np.testing.assert_allclose(read.yaw, 0.4 * read.times, atol=1e-7)


def test_altitudes_are_relative_to_home(tmp_path):
    _, plan, _ = planned(tmp_path, flown("asymmetric path"))
    takeoff = plan["mission"]["items"][0]
    assert takeoff["Altitude"] == takeoff["params"][6] == 1.0  # the flight starts at z = −1
    assert plan["mission"]["plannedHomePosition"] == list(HOME)
