"""Convex bodies made of flat faces, from the shapes of a problem's path constraints.

Legend: faces are polygons (k, 3), east, north, up, m; n outward normal, c offset, inside n·P ≤ c.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.report.camera import Camera, east_north_up

Array = NDArray[np.float64]

ROUND = 40
"""Faces around a cylinder."""


@dataclass(frozen=True)
class Solid:
    """A convex body.

    Attributes
    ----------
    name : of the constraint
    faces : polygons (k, 3)
    keep_in : True for a room to stay in, drawn as glass; False for an obstacle
    """

    name: str
    faces: tuple[Array, ...]
    keep_in: bool = False

    @cached_property
    def vertices(self) -> Array:
        """(V, 3) corners of all faces."""
        return np.concatenate(self.faces)

    @cached_property
    def planes(self) -> tuple[Array, Array]:
        """(F, 3) unit outward normals n and (F,) offsets c."""
        middle = self.vertices.mean(axis=0)
        normals = np.array([_normal(face) for face in self.faces])
        centers = np.array([face.mean(axis=0) for face in self.faces])
        inward = np.einsum("fi,fi->f", normals, centers - middle) < 0
        normals[inward] *= -1
        return normals, np.einsum("fi,fi->f", normals, centers)

    def facing(self, camera: Camera) -> list[tuple[Array, Array]]:
        """Return (face, normal) of the faces turned to the viewer; they never overlap on paper."""
        normals, _ = self.planes
        seen = normals @ camera.ray > 1e-9
        return [(face, n) for face, n, s in zip(self.faces, normals, seen, strict=True) if s]

    def hides(self, P: Array, ray: Array) -> NDArray[np.bool_]:
        """Return (M,) whether the way from each point (M, 3) to the viewer meets the body."""
        n, c = self.planes
        slope = n @ ray
        room = c - P @ n.T
        with np.errstate(divide="ignore", invalid="ignore"):
            t = room / slope
        leave = np.min(np.where(slope > 1e-12, t, np.inf), axis=1)
        enter = np.max(np.where(slope < -1e-12, t, -np.inf), axis=1)
        beside = np.any((np.abs(slope) <= 1e-12) & (room < 0), axis=1)
        result: NDArray[np.bool_] = (leave > np.maximum(enter, 1e-9)) & ~beside
        return result


def solids_of(name: str, shape: Any, floor: float, top: float) -> list[Solid]:
    """Return the solids of one shape; empty for kinds without a body (planes, bands).

    Parameters
    ----------
    name : of the constraint
    shape : kind and sizes, NED, m, as airspace constraints carry it
    floor, top : heights between which bodies of unlimited height are drawn, m
    """
    sizes = shape.sizes
    if shape.kind == "box":
        return [Solid(name, _box(sizes["center"], sizes["size"], sizes.get("yaw", 0.0)))]
    if shape.kind == "cylinder":
        x, y = sizes["center"]
        ends = np.array([[y, x, floor], [y, x, top]])
        return [Solid(name, prism(ends, sizes["radius"]))]
    if shape.kind in ("sphere", "ellipsoid"):
        axes = sizes.get("semi_axes", (sizes.get("radius"),) * 3)
        return [Solid(name, _ball(sizes["center"], axes))]
    legs = _legs(sizes) if shape.kind in ("corridor", "tube") else []
    return [Solid(name, prism(leg, sizes["radius"]), keep_in=True) for leg in legs]


def prism(ends: Array, radius: float, sides: int = ROUND) -> tuple[Array, ...]:
    """Return the faces of a round column between two points (2, 3)."""
    axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = np.cross(axis, helper)
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    turn = np.linspace(0, 2 * np.pi, sides, endpoint=False)[:, None]
    rim = radius * (np.cos(turn) * first + np.sin(turn) * second)
    low, high = ends[0] + rim, ends[1] + rim
    walls = [
        np.array([low[i], low[(i + 1) % sides], high[(i + 1) % sides], high[i]])
        for i in range(sides)
    ]
    return (*walls, low, high)


def _box(center: Any, size: Any, yaw: float) -> tuple[Array, ...]:
    half = 0.5 * np.asarray(size, dtype=float)
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    cosine, sine = np.cos(yaw), np.sin(yaw)
    R = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    corners = east_north_up(np.asarray(center) + (signs * half) @ R.T)
    rings = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    return tuple(corners[list(ring)] for ring in rings)


def _ball(center: Any, semi_axes: Any) -> tuple[Array, ...]:
    polar = np.linspace(0, np.pi, 15)[:, None]
    around = np.linspace(0, 2 * np.pi, 29)[None, :]
    unit = np.stack(
        [
            np.sin(polar) * np.cos(around),
            np.sin(polar) * np.sin(around),
            np.cos(polar) + 0 * around,
        ],
        axis=-1,
    )
    grid = east_north_up(np.asarray(center) + unit * np.asarray(semi_axes, dtype=float))
    return tuple(
        np.array([grid[i, j], grid[i, j + 1], grid[i + 1, j + 1], grid[i + 1, j]])
        for i in range(grid.shape[0] - 1)
        for j in range(grid.shape[1] - 1)
    )


def _legs(sizes: dict[str, Any]) -> list[Array]:
    points = sizes["points"] if "points" in sizes else (sizes["start"], sizes["end"])
    line = east_north_up(np.array(points, dtype=float))
    return [line[i : i + 2] for i in range(len(line) - 1) if np.any(line[i] != line[i + 1])]


def _normal(face: Array) -> Array:
    """Return the unit normal by Newell's sum, which does not mind repeated corners."""
    following = np.roll(face, -1, axis=0)
    normal = np.sum(np.cross(face, following), axis=0)
    result: Array = normal / np.linalg.norm(normal)
    return result
