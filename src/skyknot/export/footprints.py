"""What stands on the ground below an airspace: outlines of obstacles, centre lines of corridors.

Legend: points are NED, m; rings run from north over east, clockwise seen from above, not closed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUND = 48
"""Corners of a circle; they lie on it, so the outline is inside by at most 0.22 % of the radius."""


@dataclass(frozen=True)
class Footprint:
    """One obstacle or corridor on the map.

    Attributes
    ----------
    name, kind : of the constraint and its shape
    points : (K, 3) corners of an outline, or points of a centre line
    outline : whether the points enclose an area
    sizes : lengths worth telling, m, by name
    keep_in : whether the flight stays inside
    """

    name: str
    kind: str
    points: Array
    outline: bool
    sizes: dict[str, float]
    keep_in: bool


def footprints(problem: Any) -> list[Footprint]:
    """Return the footprints of a problem's path constraints; none for planes and bands."""
    found = []
    for constraint in getattr(problem, "path", ()):
        shape = constraint.shape
        drawn = None if shape is None else _DRAWN.get(shape.kind)
        if drawn is not None:
            points, outline, sizes = drawn(shape.sizes)
            sizes |= {"clearance": float(shape.sizes.get("clearance", 0.0))}
            found.append(
                Footprint(constraint.name, shape.kind, points, outline, sizes, shape.keep_in)
            )
    return found


def _cylinder(sizes: dict[str, Any]) -> tuple[Array, bool, dict[str, float]]:
    radius = float(sizes["radius"])
    return _ellipse(sizes["center"], (radius, radius)), True, {"radius": radius}


def _ball(sizes: dict[str, Any]) -> tuple[Array, bool, dict[str, float]]:
    axes = [float(a) for a in sizes.get("semi_axes", (sizes.get("radius"),) * 3)]
    height = -float(sizes["center"][2])
    heights = {"lowest": height - axes[2], "highest": height + axes[2]}
    return _ellipse(sizes["center"], (axes[0], axes[1])), True, heights


def _box(sizes: dict[str, Any]) -> tuple[Array, bool, dict[str, float]]:
    half, yaw = 0.5 * np.asarray(sizes["size"], dtype=float), float(sizes.get("yaw", 0.0))
    center = np.asarray(sizes["center"], dtype=float)
    corners = np.array([[1, -1], [1, 1], [-1, 1], [-1, -1]]) * half[:2]
    R = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    heights = {"lowest": -center[2] - half[2], "highest": -center[2] + half[2]}
    return _level(center[:2] + corners @ R.T), True, heights


def _line(sizes: dict[str, Any]) -> tuple[Array, bool, dict[str, float]]:
    points = sizes["points"] if "points" in sizes else (sizes["start"], sizes["end"])
    return np.asarray(points, dtype=float), False, {"radius": float(sizes["radius"])}


def _ellipse(center: Any, axes: tuple[float, float]) -> Array:
    turn = np.linspace(0, 2 * np.pi, ROUND, endpoint=False)
    rim = np.column_stack([axes[0] * np.cos(turn), axes[1] * np.sin(turn)])
    return _level(np.asarray(center, dtype=float)[:2] + rim)


def _level(points: Array) -> Array:
    return np.column_stack([points, np.zeros(len(points))])


_DRAWN = {
    "cylinder": _cylinder,
    "sphere": _ball,
    "ellipsoid": _ball,
    "box": _box,
    "corridor": _line,
    "tube": _line,
}
