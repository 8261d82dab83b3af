"""Seeded random missions: any vehicle, obstacles in the way, limits, objective and horizon.

A mission is drawn as the text of a mission file, so that a seed can be written down, read and
solved at the command line. A draw that the mission's own checks refuse (a start inside a building,
say) is drawn again from the same stream.

Legend: rng random stream, d distance from start to goal [m], T time a moderate flight needs [s].
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.missions import Mission, parse, vehicles
from skyknot.models.vehicle import Vehicle

Array = NDArray[np.float64]
Table = dict[str, Any]

REACH = {
    "crazyflie": (1.0, 6.0),
    "hummingbird": (3.0, 40.0),
    "f450": (3.0, 60.0),
    "report": (3.0, 20.0),
    "rpg_racing": (4.0, 60.0),
    "nasa_six_passenger": (80.0, 1500.0),
}
"""Shortest and longest flight drawn for each vehicle, m."""

ATTEMPTS = 200
"""Draws before a seed is given up; refusals are one in three."""


def random_mission(seed: int) -> Mission:
    """Return the mission of a seed; the same one on every machine.

    Raises
    ------
    RuntimeError
        When no draw of the seed is a mission.
    """
    rng = np.random.default_rng(seed)
    for _ in range(ATTEMPTS):
        try:
            return parse(mission_text(rng), f"random_{seed}", f"seed {seed}")
        except UserError:
            continue
    raise RuntimeError(f"seed {seed}: no draw is a mission")


def mission_text(rng: np.random.Generator) -> str:
    """Return the text of a mission file drawn from ``rng``; it may contradict itself."""
    vehicle = vehicles.load(str(rng.choice(sorted(REACH))))
    model = str(rng.choice(["wrench", "rotors", "translational-yaw"], p=[0.65, 0.2, 0.15]))
    d = math.exp(rng.uniform(*np.log(REACH[vehicle.name])))
    start, goal = _ends(rng, d)
    T = _moderate_time(rng, vehicle, d)
    free = bool(rng.random() < 0.5)
    file: Table = {
        "title": f"{vehicle.name}, {d:.3g} m, {model}",
        "vehicle": vehicle.name,
        "model": model,
        "start": start,
        "goal": goal,
        "horizon": _horizon(rng, T, free=free),
        "objective": _objective(rng, vehicle, model, d, T, free=free),
        "limits": _limits(rng, vehicle, model, d / T),
        "airspace": _airspace(rng, start, goal, d),
        "waypoints": _waypoints(rng, start, goal, d),
        "scheme": _scheme(rng),
    }
    if file["objective"]["kind"] == "tracking" and rng.random() < 0.3:
        goal["reach"] = "cost"
    return "\n".join(f"{key} = {_toml(value)}" for key, value in file.items()) + "\n"


def _toml(value: Any) -> str:
    """Return plain data as inline TOML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_toml(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_toml(entry) for entry in value) + "]"
    if isinstance(value, float):
        return repr(float(f"{value:.6g}"))
    return json.dumps(value)


def _ends(rng: np.random.Generator, d: float) -> tuple[Table, Table]:
    angle, rise = rng.uniform(0, 2 * math.pi), rng.uniform(-0.4, 0.4) * d
    along = math.sqrt(d**2 - rise**2)
    height = max(0.0, -rise) + rng.uniform(0.1, 0.6) * d
    start: Table = {"position": [0.0, 0.0, -height], "yaw": float(rng.uniform(-3, 3))}
    goal: Table = {
        "position": [along * math.cos(angle), along * math.sin(angle), -height - rise],
        "yaw": float(rng.uniform(-3, 3)),
        "reach": str(rng.choice(["exact", "position"], p=[0.75, 0.25])),
    }
    if rng.random() < 0.15:
        start["velocity"] = [float(v) for v in rng.uniform(-0.3, 0.3, 3) * math.sqrt(d)]
    return start, goal


def _moderate_time(rng: np.random.Generator, vehicle: Vehicle, d: float) -> float:
    """Return a time [s] that a flight at 15 to 25 degrees of tilt could need."""
    a = vehicle.gravity * math.tan(math.radians(rng.uniform(15, 25)))
    fastest = vehicle.limits.speed or math.inf
    peak = min(math.sqrt(a * d), 0.7 * fastest)
    return d / peak + peak / a + 0.3


def _horizon(rng: np.random.Generator, T: float, *, free: bool) -> Table:
    if not free:
        return {"duration": float(T * rng.uniform(1.0, 3.0))}
    bounds: Table = {"lower": float(0.1 * T), "upper": float(T * rng.uniform(4.0, 12.0))}
    if rng.random() < 0.5:
        bounds["guess"] = float(T * rng.uniform(0.7, 2.5))
    return {"free": bounds}


def _objective(
    rng: np.random.Generator, vehicle: Vehicle, model: str, d: float, T: float, *, free: bool
) -> Table:
    kinds = ["tracking", "effort", "energy"] + (["minimum-time", "minimum-time"] if free else [])
    kind = str(rng.choice(kinds))
    if kind == "energy" and vehicle.power is None and vehicle.rotor_radius is None:
        kind = "effort"
    objective: Table = {"kind": kind}
    if free and kind != "minimum-time":
        objective["time"] = float(10 ** rng.uniform(-1, 1))
    if kind == "minimum-time" and rng.random() < 0.6:
        return objective  # bang-bang: nothing smooths the controls
    lower, upper = _control_room(vehicle, model)
    weight = 10 ** rng.uniform(-1.5, 1.5)
    if kind in ("tracking", "effort", "energy", "minimum-time"):
        spread = 10 ** rng.uniform(-1, 1, len(lower))
        objective["R"] = [float(w) for w in weight * spread / (0.5 * (upper - lower)) ** 2]
    if kind == "tracking":
        sizes = [d] * 3 + [d / T] * 3 + ([0.5] * 2 if model != "translational-yaw" else []) + [1.0]
        sizes += [2.0] * 3 if model != "translational-yaw" else []
        Q = 10 ** rng.uniform(-1, 1, len(sizes)) / np.square(sizes)
        objective["Q"] = [float(q) for q in Q]
        if rng.random() < 0.5:
            objective["Q_final"] = [float(q) for q in 10 * T * Q]
    return objective


def _control_room(vehicle: Vehicle, model: str) -> tuple[Array, Array]:
    if model == "wrench":
        return vehicle.control_bounds
    if model == "rotors":
        return vehicle.rotor_model().control_bounds
    return vehicle.translational_yaw_model().control_bounds


def _limits(rng: np.random.Generator, vehicle: Vehicle, model: str, speed: float) -> Table:
    limits: Table = {}
    if rng.random() < 0.4:
        limits["speed"] = float(speed * rng.uniform(1.1, 3.0))
    if rng.random() < 0.2:
        limits["climb"] = float(speed * rng.uniform(0.4, 1.0))
        limits["descent"] = float(speed * rng.uniform(0.4, 1.0))
    if rng.random() < 0.15:
        limits["acceleration_g"] = float(rng.uniform(0.2, 0.8))
    if rng.random() < 0.2:
        lower, upper = _control_room(vehicle, model)
        limits["control_rates"] = [float(r) for r in rng.uniform(1, 10) * (upper - lower)]
    if model != "translational-yaw":
        if rng.random() < 0.35:
            limits["tilt_degrees"] = float(rng.uniform(20, 60))
        if rng.random() < 0.15:
            limits["body_rates"] = [float(r) for r in rng.uniform(0.5, 4.0, 3)]
        if rng.random() < 0.1:
            limits["felt_acceleration_g"] = float(rng.uniform(0.15, 0.5))
    return limits


def _airspace(rng: np.random.Generator, start: Table, goal: Table, d: float) -> Table:
    airspace: Table = {}
    first, last = np.array(start["position"]), np.array(goal["position"])
    obstacles: list[Table] = []
    for i in range(int(rng.integers(0, 7))):
        share = rng.uniform(0.15, 0.85)
        place = first + share * (last - first) + rng.normal(0, 0.12 * d, 3)
        size = d * rng.uniform(0.04, 0.15)
        kind = str(rng.choice(sorted(OBSTACLES)))
        obstacles.append({"name": f"obstacle {i + 1}"} | OBSTACLES[kind](rng, place, size))
        if rng.random() < 0.3:
            obstacles[-1]["clearance"] = 0.01 * d
    if obstacles:
        airspace["obstacles"] = obstacles
    if rng.random() < 0.4:
        heights = -np.array([first[2], last[2]])
        margin = d * rng.uniform(0.02, 0.3, 2)
        lowest = max(0.0, float(heights.min() - margin[0]))
        airspace["altitude"] = {"lowest": lowest, "highest": float(heights.max() + margin[1])}
    if rng.random() < 0.1:
        corner = 0.5 * (first + last) + rng.normal(0, 0.1 * d, 3)
        points = [[float(v) for v in p] for p in (first, corner, last)]
        radius = float(d * rng.uniform(0.08, 0.25))
        airspace["corridors"] = [{"name": "corridor", "points": points, "radius": radius}]
    return airspace


def _numbers(values: Any) -> list[float]:
    return [float(value) for value in values]


def _cylinder(_rng: np.random.Generator, place: Array, size: float) -> Table:
    return {"kind": "cylinder", "center": _numbers(place[:2]), "radius": float(size)}


def _sphere(_rng: np.random.Generator, place: Array, size: float) -> Table:
    return {"kind": "sphere", "center": _numbers(place), "radius": float(1.3 * size)}


def _ellipsoid(rng: np.random.Generator, place: Array, size: float) -> Table:
    axes = _numbers(size * rng.uniform(0.5, 2.0, 3))
    return {"kind": "ellipsoid", "center": _numbers(place), "semi_axes": axes}


def _building(rng: np.random.Generator, place: Array, size: float) -> Table:
    return {
        "kind": "building",
        "center": _numbers(place[:2]),
        "size": _numbers(size * rng.uniform(1.0, 2.5, 2)),
        "height": float(max(0.2 * size, -place[2] * rng.uniform(0.5, 2.0))),
        "yaw_degrees": float(rng.uniform(0, 90)),
    }


def _box(rng: np.random.Generator, place: Array, size: float) -> Table:
    return {
        "kind": "box",
        "center": _numbers(place),
        "size": _numbers(size * rng.uniform(1.0, 2.5, 3)),
        "yaw_degrees": float(rng.uniform(0, 90)),
    }


OBSTACLES: dict[str, Callable[[np.random.Generator, Array, float], Table]] = {
    "cylinder": _cylinder,
    "sphere": _sphere,
    "ellipsoid": _ellipsoid,
    "building": _building,
    "box": _box,
}
"""How each kind is drawn around a place [m] at a size [m]."""


def _waypoints(rng: np.random.Generator, start: Table, goal: Table, d: float) -> list[Table]:
    if rng.random() > 0.2:
        return []
    first, last = np.array(start["position"]), np.array(goal["position"])
    shares = np.sort(rng.uniform(0.2, 0.8, int(rng.integers(1, 3))))
    places = [first + share * (last - first) + rng.normal(0, 0.08 * d, 3) for share in shares]
    return [{"position": _numbers(p), "tolerance": float(0.03 * d)} for p in places]


def _scheme(rng: np.random.Generator) -> Table:
    name = str(rng.choice(["hermite-simpson", "trapezoid", "euler"], p=[0.8, 0.15, 0.05]))
    scheme: Table = {"name": name, "segments": int(rng.integers(40, 61))}
    if rng.random() < 0.3:
        scheme["enforce"] = "nodes"
    if name == "hermite-simpson" and rng.random() < 0.25:
        scheme["controls"] = str(rng.choice(["linear", "hold"]))
    return scheme
