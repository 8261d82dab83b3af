"""A QGroundControl plan: waypoints with a speed for every leg.

Source: docs.qgroundcontrol.com, developer guide, "Plan File Format" (plan version 1, mission
version 2); mavlink.io, common message set: MAV_CMD 16 NAV_WAYPOINT (hold, …, yaw, place),
22 NAV_TAKEOFF, 178 DO_CHANGE_SPEED; MAV_FRAME 2 MISSION, 3 GLOBAL_RELATIVE_ALT. Home is the origin
of the flight, altitudes are relative to it.

Legend
------
t_k, P_k : time (s) and place (NED, m) of waypoint k. Leg k goes from k to k + 1.
L = |P_{k+1} − P_k|, Δ = t_{k+1} − t_k : its length and duration. v = L/Δ : its speed, with a wait
    of Δ − L/v at P_k when v would be below SLOWEST.

A plan knows no times. Straight legs flown at constant speed are linear interpolation in time, so
waypoints are chosen as Ramer, Douglas and Peucker do, by the distance at the same time, until it is
below TOLERANCE; what remains is measured and told. A rate asked for puts a waypoint at every
sample.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.export.base import Encoded, Format, Request
from skyknot.export.samples import Flight, sample_times, sampled

Array = NDArray[np.float64]

TOLERANCE, TURN = 0.5, np.radians(10.0)
"""How far a plan may be from the flight at the same time, m; and its heading, rad."""

SLOWEST, SHORTEST = 0.1, 0.01
"""Speed, m/s, below which a craft waits instead; length, m, of a leg too short to time."""

NAV_WAYPOINT, NAV_TAKEOFF, DO_CHANGE_SPEED = 16, 22, 178
MISSION, RELATIVE_ALTITUDE = 2, 3
PX4, QUADROTOR, RELATIVE_MODE = 12, 2, 1
GROUND_SPEED, SAME_THROTTLE = 1, -1

DENSE = 100.0
"""Hz, at which the flight is compared with its plan."""


@dataclass(frozen=True)
class Legs:
    """Waypoints and how the legs between them are flown.

    Attributes
    ----------
    times, position, yaw : (K+1,) s, (K+1, 3) m NED and (K+1,) rad, of the waypoints
    speeds, waits : (K,) m/s along each leg, and s before it
    """

    times: Array
    position: Array
    yaw: Array
    speeds: Array
    waits: Array


def encode(request: Request) -> Encoded:
    """Return the plan, and how far it is from the flight when flown exactly as written."""
    flight = request.sampled
    legs = legs_of(flight, every=request.rate is not None)
    trajectory = request.solution.trajectory
    apart, late = errors(sampled(request.solution, sample_times(trajectory, DENSE)), legs)
    accuracy = (
        f"flown exactly as written, within {apart:.2g} m at the same time "
        f"and {late:.2g} s at the same place"
    )
    place = request.place
    content = {
        "fileType": "Plan",
        "version": 1,
        "groundStation": "skyknot",
        "skyknot": {
            "mission": request.title,
            "certificate": request.verdict,
            "accuracy": accuracy,
        },
        "mission": {
            "version": 2,
            "firmwareType": PX4,
            "vehicleType": QUADROTOR,
            "globalPlanAltitudeMode": RELATIVE_MODE,
            "cruiseSpeed": float(legs.speeds.max()),
            "hoverSpeed": float(legs.speeds.max()),
            "plannedHomePosition": [place.latitude, place.longitude, place.altitude],
            "items": _items(request, legs),
        },
        "geoFence": {"version": 2, "circles": [], "polygons": []},
        "rallyPoints": {"version": 2, "points": []},
    }
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    return Encoded(text.encode("utf-8"), accuracy, len(legs.times))


def legs_of(flight: Flight, every: bool) -> Legs:
    """Return waypoints at every sample, or as few as TOLERANCE and TURN allow, with their legs."""
    chosen = np.arange(len(flight.times)) if every else np.array(sorted(_chosen(flight)))
    times, position = flight.times[chosen], flight.position[chosen]
    duration = np.diff(times)
    length = np.linalg.norm(np.diff(position, axis=0), axis=1)
    speeds = np.round(np.maximum(length / duration, SLOWEST), 6)
    waits = np.round(np.maximum(duration - length / speeds, 0.0), 6)
    waits[length / duration >= SLOWEST] = 0.0
    return Legs(times, position, flight.yaw[chosen], speeds, waits)


def _chosen(flight: Flight) -> set[int]:
    """Return the samples between which straight legs are good enough."""
    scaled = np.column_stack([flight.position / TOLERANCE, flight.yaw / TURN])
    kept, open_spans = {0, len(scaled) - 1}, [(0, len(scaled) - 1)]
    while open_spans:
        first, last = open_spans.pop()
        t = flight.times[first : last + 1]
        share = ((t - t[0]) / (t[-1] - t[0]))[:, None]
        straight = (1 - share) * scaled[first] + share * scaled[last]
        miss = scaled[first : last + 1] - straight
        size = np.maximum(np.linalg.norm(miss[:, :3], axis=1), np.abs(miss[:, 3]))
        worst = first + int(np.argmax(size))
        if size.max() > 1.0 and first < worst < last:
            kept.add(worst)
            open_spans += [(first, worst), (worst, last)]
    return kept


def errors(dense: Flight, legs: Legs) -> tuple[float, float]:
    """Return the largest distance at the same time, m, and delay at the same place, s."""
    apart, late, clock = 0.0, 0.0, 0.0
    for k, (speed, wait) in enumerate(zip(legs.speeds, legs.waits, strict=True)):
        during = (dense.times >= legs.times[k]) & (dense.times <= legs.times[k + 1])
        t, P, start = dense.times[during], dense.position[during], legs.position[k]
        way = legs.position[k + 1] - start
        L = float(np.linalg.norm(way))
        unit = way / L if L > 0 else way
        moved = np.clip((t - clock - wait) * speed, 0.0, L)
        miss = np.linalg.norm(start + moved[:, None] * unit - P, axis=1)
        apart = max(apart, float(miss.max(initial=0.0)))
        if L > SHORTEST:
            along = np.clip((P - start) @ unit, 0.0, L)
            delay = np.abs(clock + wait + along / speed - t)
            late = max(late, float(delay.max(initial=0.0)))
        clock += wait + L / speed
    return apart, late


def _items(request: Request, legs: Legs) -> list[dict[str, Any]]:
    """Return take-off, then speed and waypoint of every leg, numbered from 1."""
    place = request.place
    places = place.geodetic(legs.position)
    places[:, 2] -= place.altitude
    yaw = np.degrees(legs.yaw) % 360
    items = [_nav(NAV_TAKEOFF, 0.0, yaw[0], places[0])]
    for k, (here, heading) in enumerate(zip(places, yaw, strict=True)):
        if k > 0:
            params = [GROUND_SPEED, float(legs.speeds[k - 1]), SAME_THROTTLE, 0, 0, 0, 0]
            items.append({"command": DO_CHANGE_SPEED, "frame": MISSION, "params": params})
        wait = float(legs.waits[k]) if k < len(legs.waits) else 0.0
        items.append(_nav(NAV_WAYPOINT, wait, heading, here))
    return [
        {"type": "SimpleItem", "autoContinue": True, "doJumpId": number, **item}
        for number, item in enumerate(items, start=1)
    ]


def _nav(command: int, wait: float, yaw: float, place: Array) -> dict[str, Any]:
    latitude, longitude, height = (
        round(float(v), n) for v, n in zip(place, (10, 10, 4), strict=True)
    )
    return {
        "command": command,
        "frame": RELATIVE_ALTITUDE,
        "params": [wait, 0, 0, round(float(yaw), 6), latitude, longitude, height],
        "Altitude": height,
        "AltitudeMode": RELATIVE_MODE,
        "AMSLAltAboveTerrain": None,
    }


PLAN = Format(
    name="plan",
    title="QGroundControl plan",
    file_name="flight.plan",
    encode=encode,
    rate=20.0,
    needs=("origin",),
)
