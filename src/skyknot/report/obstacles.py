"""Obstacles, rooms to stay in, and shadows, drawn onto a stage."""

from __future__ import annotations

from itertools import combinations, product
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from skyknot.report import style
from skyknot.report.camera import east_north_up
from skyknot.report.scene import Scene
from skyknot.report.solids import Solid

Array = NDArray[np.float64]

BUILDING, ROOF = np.array(to_rgb("#bac5cf")), np.array(to_rgb("#dfe6ec"))
EDGE = "#71808e"

LIGHT = np.array([-0.38, -0.22, 0.9])
"""Direction to the light, a unit vector: west-south-west and high."""

STOREY = 3.0
"""Height of a storey, m: lines on buildings give the eye a scale."""


def draw_shadows(axes: Any, scene: Scene) -> None:
    """Draw the shadows of the obstacles and the track of the path on the ground."""
    project, floor = scene.stage.camera.project, scene.stage.floor
    for solid in scene.bodies:
        if solid.keep_in:
            continue
        ground = solid.vertices - np.outer((solid.vertices[:, 2] - floor) / LIGHT[2], LIGHT)
        shadow = Polygon(_hull(project(ground)), facecolor=style.INK, alpha=0.10, linewidth=0)
        axes.add_patch(shadow)
        shadow.set_clip_path(Polygon(project(scene.stage.ground), transform=axes.transData))
    track = scene.path.copy()
    track[:, 2] = floor
    free = ~scene.hidden(track)
    for run in runs(free):
        axes.plot(*project(track[run]).T, color=style.MUTED, linewidth=1.6, alpha=0.35)


def draw_solid(axes: Any, scene: Scene, solid: Solid) -> None:
    """Draw one body: an obstacle as stone, a room to stay in as glass."""
    camera = scene.stage.camera
    facing = solid.facing(camera)
    polygons = [camera.project(face) for face, _ in facing]
    if solid.keep_in:
        glass = PolyCollection(polygons, facecolors=style.SKY, edgecolors="none", alpha=0.13)
        axes.add_collection(glass)
        outline = _hull(np.concatenate(polygons))
        axes.add_patch(Polygon(outline, fill=False, edgecolor=style.SKY, linewidth=1.0, alpha=0.7))
        return
    shades = []
    for _, normal in facing:
        base, lit = (ROOF, 0.8) if normal[2] > 0.999 else (BUILDING, 0.84)
        shades.append(np.clip(base * (lit + 0.22 * float(normal @ LIGHT)), 0, 1))
    # Edges in the face's own colour close the hairlines between neighbours.
    edges = EDGE if len(solid.faces) == 6 else shades
    axes.add_collection(
        PolyCollection(polygons, facecolors=shades, edgecolors=edges, linewidths=0.6)
    )
    _draw_storeys(axes, scene, solid)
    outline = _hull(np.concatenate(polygons))
    axes.add_patch(Polygon(outline, fill=False, edgecolor=EDGE, linewidth=0.9, joinstyle="round"))


def _draw_storeys(axes: Any, scene: Scene, solid: Solid) -> None:
    """Draw a line at every storey of a box that stands on the ground."""
    height = np.ptp(solid.vertices[:, 2])
    standing = abs(solid.vertices[:, 2].min() - scene.stage.floor) < 0.1 * height
    if len(solid.faces) != 6 or not standing or not STOREY < height < 80 * STOREY:
        return
    lines = []
    for face, normal in solid.facing(scene.stage.camera):
        if abs(normal[2]) > 0.1:
            continue
        low = face[np.argsort(face[:, 2])][:2]
        for level in np.arange(STOREY, height, STOREY):
            lines.append(scene.stage.camera.project(low + np.array([0.0, 0.0, level])))
    axes.add_collection(LineCollection(lines, colors=EDGE, linewidths=0.5, alpha=0.55))


def draw_sheets(axes: Any, scene: Scene) -> bool:
    """Draw altitude bands and half-spaces as sheets; return whether any lies on the stage."""
    low, high = scene.stage.low, scene.stage.high
    sheets = [sheet for _, shape in scene.shapes for sheet in plane_cuts(low, high, shape)]
    for sheet in sheets:
        outline = _hull(scene.stage.camera.project(sheet))
        axes.add_patch(Polygon(outline, facecolor=style.SKY, alpha=0.07, linewidth=0))
        dashed = Polygon(
            outline, fill=False, edgecolor=style.SKY, linewidth=0.9, linestyle=(0, (4, 3))
        )
        axes.add_patch(dashed)
    return bool(sheets)


def plane_cuts(low: Array, high: Array, shape: Any) -> list[Array]:
    """Return corners (k, 3) of the planes of a band or half-space, cut to the stage low … high."""
    sizes = shape.sizes
    planes: list[tuple[Array, float]] = []
    if shape.kind == "band":
        planes = [(np.array([0.0, 0.0, 1.0]), sizes[end]) for end in ("lowest", "highest")]
    elif shape.kind == "half-space":
        planes = [(east_north_up(np.array(sizes["normal"])), sizes["offset"])]
    cuts = [_cut(low, high, normal, offset) for normal, offset in planes]
    return [cut for cut in cuts if len(cut) > 2 and np.max(cut[:, 2]) > low[2]]


def _cut(low: Array, high: Array, normal: Array, offset: float) -> Array:
    """Return (k, 3) where the plane n·P = offset crosses the edges of the stage."""
    corners = np.array([[e, n, u] for e, n, u in product(*np.stack([low, high], axis=1))])
    found = []
    for a, b in combinations(corners, 2):
        if np.count_nonzero(a != b) != 1:
            continue
        before, after = a @ normal - offset, b @ normal - offset
        if before * after <= 0 and before != after:
            found.append(a + before / (before - after) * (b - a))
    return np.array(found).reshape(-1, 3)


def runs(mask: NDArray[np.bool_]) -> list[slice]:
    """Return the stretches where ``mask`` holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return [slice(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _hull(points: Array) -> Array:
    """Return the outline of points on paper (Andrew's monotone chain)."""
    ordered = sorted({(round(float(x), 9), round(float(y), 9)) for x, y in points})

    def half(sequence: list[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for x, y in sequence:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], (x, y)) <= 0:
                chain.pop()
            chain.append((x, y))
        return chain[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
