"""What the replay shows, as plain data: craft in motion among what stands around them.

Positions turn from north, east, down into east, north, up here and nowhere else. A turn is a
quaternion (w, x, y, z) from a body's own axes, forward, right, down, to east, north, up.

Legend: F frames, n rotors; q_M the turn from north, east, down to east, north, up: half a
revolution about the horizontal axis (1, 1, 0)/√2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import to_hex
from numpy.typing import NDArray

from skyknot.report import style
from skyknot.report.camera import east_north_up
from skyknot.report.craft import attitude, rotor_radius, span
from skyknot.report.obstacles import plane_cuts
from skyknot.report.reading import Reading
from skyknot.report.scene import Scene

Array = NDArray[np.float64]

FRAMES = 600
"""Moments sent to the page; between them it interpolates."""

AXES_TURN = np.array([0.0, np.sqrt(0.5), np.sqrt(0.5), 0.0])
"""q_M."""

Data = dict[str, Any]


def replay_data(readings: Sequence[Reading], wind: Sequence[float] | None = None) -> Data:
    """Return what the replay of one or several flights shows.

    Parameters
    ----------
    readings : flights, at least one; the surroundings are those of all of them, each named once
    wind : north, east, down, m/s
    """
    scenes = [Scene(reading) for reading in readings]
    low = np.min([scene.stage.low for scene in scenes], axis=0)
    high = np.max([scene.stage.high for scene in scenes], axis=0)
    shapes = {name: shape for scene in scenes for name, shape in scene.shapes}
    bodies = [
        body for name, shape in shapes.items() for body in _bodies(name, shape, low[2], high[2])
    ]
    sheets = [cut for shape in shapes.values() for cut in plane_cuts(low, high, shape)]
    air = None if wind is None or not np.any(wind) else east_north_up(np.asarray(wind))
    return {
        "stage": {"low": _rounded(low), "high": _rounded(high)},
        "vehicles": [_vehicle(scene, style.SERIES[i % 6]) for i, scene in enumerate(scenes)],
        "bodies": bodies,
        "sheets": [_rounded(_around(sheet)) for sheet in sheets],
        "wind": None if air is None else _rounded(air),
        "azimuth": float(scenes[0].stage.camera.azimuth),
        "colors": [to_hex(style.SPEED(share)) for share in np.linspace(0, 1, 9)],
    }


def _vehicle(scene: Scene, color: str) -> Data:
    """Return one craft, its frames, its plan and its goal."""
    reading = scene.reading
    times, states, source = _flight(reading)
    places = scene.place(states)
    vehicle = reading.vehicle
    hubs = np.asarray(vehicle.rotor_positions, dtype=float)
    return {
        "name": reading.solution.record.problem,
        "color": color,
        "source": source,
        "times": _rounded(times - times[0]),
        "places": _rounded(places),
        "turns": _rounded(turns(attitude(reading, states)), 6),
        "speeds": _rounded(_speeds(reading, states)),
        "thrusts": _thrusts(reading, times),
        "thrustMax": float(vehicle.thrust_max),
        "hubs": _rounded(hubs, 6),
        "radius": rotor_radius(vehicle),
        "spins": [int(spin) for spin in vehicle.allocation.spins],
        "span": span(vehicle),
        "plan": _rounded(scene.path),
        "goal": None if scene.goal is None else _rounded(scene.goal),
    }


def _flight(reading: Reading) -> tuple[Array, Array, str]:
    """Return times (F,), states (F, nx) and what they are: the flight as far as it goes, or plan.

    A flight that was lost ends where it was lost.
    """
    nodes = reading.trajectory.times
    times = np.linspace(nodes[0], nodes[-1], FRAMES)
    if reading.flown is None:
        return times, reading.trajectory.state(times), "plan"
    known = np.all(np.isfinite(reading.flown), axis=1)
    seen, flown = reading.times[known], reading.flown[known]
    times = times[times <= seen[-1]]
    states = np.stack([np.interp(times, seen, column) for column in flown.T], axis=1)
    return times, states, "flown" if np.all(known) else "lost"


def _speeds(reading: Reading, states: Array) -> Array:
    if not reading.has("vx", "vy", "vz"):
        return np.zeros(len(states))
    velocity = reading.columns(states, "vx", "vy", "vz")
    result: Array = np.linalg.norm(velocity, axis=1)
    return result


def _thrusts(reading: Reading, times: Array) -> list[Any] | None:
    """Return (F, n) rotor thrusts, N, or None where the model knows no rotors."""
    if not reading.has_rotors:
        return None
    controls = reading.trajectory.control(times)
    wrench = reading.control_names[0] == "T"
    thrusts = reading.vehicle.rotor_thrusts(controls) if wrench else controls
    result: list[Any] = _rounded(np.asarray(thrusts))
    return result


def turns(angles: Array) -> Array:
    """Return (F, 4) turns of a craft at roll, pitch, yaw (F, 3), rad: q_M q_z q_y q_x."""
    cosine, sine = np.cos(0.5 * angles), np.sin(0.5 * angles)
    none = np.zeros(len(angles))
    roll = np.stack([cosine[:, 0], sine[:, 0], none, none], axis=1)
    pitch = np.stack([cosine[:, 1], none, sine[:, 1], none], axis=1)
    yaw = np.stack([cosine[:, 2], none, none, sine[:, 2]], axis=1)
    return _product(AXES_TURN[None], _product(yaw, _product(pitch, roll)))


def _product(a: Array, b: Array) -> Array:
    """Return the product (F, 4) of quaternions, Hamilton's convention."""
    aw, av, bw, bv = a[:, :1], a[:, 1:], b[:, :1], b[:, 1:]
    scalar = aw * bw - np.sum(av * bv, axis=1, keepdims=True)
    return np.concatenate([scalar, aw * bv + bw * av + np.cross(av, bv)], axis=1)


def _bodies(name: str, shape: Any, floor: float, top: float) -> list[Data]:
    """Return the bodies of one shape; none for planes and bands."""
    sizes = shape.sizes
    if shape.kind == "box":
        yaw = np.array([[0.0, 0.0, sizes.get("yaw", 0.0)]])
        return [
            {"kind": "box", "name": name, "size": _rounded(np.asarray(sizes["size"])),
             "center": _rounded(east_north_up(np.asarray(sizes["center"]))),
             "turn": _rounded(turns(yaw)[0], 6)}
        ]  # fmt: skip
    if shape.kind == "cylinder":
        x, y = sizes["center"]
        return [
            {"kind": "cylinder", "name": name, "radius": sizes["radius"],
             "center": [float(y), float(x), 0.5 * float(floor + top)],
             "height": float(top - floor)}
        ]  # fmt: skip
    if shape.kind in ("sphere", "ellipsoid"):
        north, east, down = sizes.get("semi_axes", (sizes.get("radius"),) * 3)
        center = _rounded(east_north_up(np.asarray(sizes["center"])))
        axes = [float(east), float(north), float(down)]
        return [{"kind": "ellipsoid", "name": name, "center": center, "axes": axes}]
    if shape.kind in ("corridor", "tube"):
        points = sizes["points"] if "points" in sizes else (sizes["start"], sizes["end"])
        line = _rounded(east_north_up(np.asarray(points, dtype=float)))
        return [{"kind": "tube", "name": name, "points": line, "radius": sizes["radius"]}]
    return []


def _around(corners: Array) -> Array:
    """Return the corners (k, 3) of a flat convex outline in order around their middle."""
    offsets = corners - corners.mean(axis=0)
    _, _, axes = np.linalg.svd(offsets)
    order = np.argsort(np.arctan2(offsets @ axes[1], offsets @ axes[0]))
    result: Array = corners[order]
    return result


def _rounded(values: Array, digits: int = 4) -> Any:
    """Return numbers as lists, to a tenth of a millimetre."""
    return np.round(np.asarray(values, dtype=float), digits).tolist()
