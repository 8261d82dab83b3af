"""The stage of a 3-D picture: its extent, ground, altitude axis and camera.

Legend: E, N, U east, north, up, m; k vertical stretch.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from skyknot.report import style
from skyknot.report.camera import Camera
from skyknot.report.solids import Solid

Array = NDArray[np.float64]

ELEVATION = np.deg2rad(25.0)
"""Viewer's height above the horizon."""

AZIMUTHS = np.deg2rad([-60, -45, -75, -30, -105, -120, -135, -150])
"""Places of the viewer, all to the south so that north is away; the first is preferred."""

FLATTEST = 0.3
"""Least height of the stage, as a share of its width; flatter scenes are stretched."""

SLIMMEST = 0.7
"""Least width of the stage, as a share of its height."""


TICK_ROOM = 0.041
"""Room for a number beside an axis, as a share of the stage's width on paper."""


@dataclass(frozen=True)
class Stage:
    """Extent and camera.

    Attributes
    ----------
    low, high : (3,) ends of the stage, east, north, up, m; low[2] is the ground
    ticks : round values inside, along each axis
    camera : the viewer
    """

    low: Array
    high: Array
    ticks: tuple[Array, Array, Array]
    camera: Camera

    @property
    def floor(self) -> float:
        """Height of the ground, m."""
        return float(self.low[2])

    @property
    def top(self) -> float:
        """Height of the stage, m."""
        return float(self.high[2])

    @property
    def width(self) -> float:
        """Width of the ground on paper, m."""
        return float(np.ptp(self.camera.project(self.ground)[:, 0]))

    @property
    def ground(self) -> Array:
        """(4, 3) corners of the ground."""
        (e, n, floor), (f, o, _) = self.low, self.high
        return np.array([[e, n, floor], [f, n, floor], [f, o, floor], [e, o, floor]])

    @property
    def height_corner(self) -> Array:
        """(3,) corner of the ground where the altitude axis stands: the one farthest left."""
        result: Array = self.ground[int(np.argmin(self.camera.project(self.ground)[:, 0]))]
        return result


def stage_for(
    path: Array, others: Array, floor: float, smallest: float, solids_at: Any, few: bool
) -> Stage:
    """Return the stage that shows the path (M, 3) and other points (K, 3) from its best side.

    Parameters
    ----------
    floor : height of the ground, m
    smallest : least width of the stage, m
    solids_at : function of (floor, top) → list of Solid
    few : whether to use few ticks, for a small picture
    """
    seen = np.concatenate([path, others])
    low, high = seen.min(axis=0), seen.max(axis=0)
    height = 1.08 * max(float(high[2]) - floor, FLATTEST * smallest)
    width = max(float(np.max((high - low)[:2])), SLIMMEST * height, smallest)
    least = width if height > width else 0.4 * width
    ends = [_widened(low[i], high[i], max(least, high[i] - low[i] + 0.16 * width)) for i in (0, 1)]
    ends.append((floor, floor + height))
    bottom, top = np.array(ends).T
    stretch = max(1.0, FLATTEST * float(np.max((top - bottom)[:2])) / height)
    cameras = [Camera(azimuth, ELEVATION, stretch) for azimuth in AZIMUTHS]
    solids = [solid for solid in solids_at(floor, top[2]) if not solid.keep_in]
    best = max(cameras, key=lambda camera: _merit(camera, path, solids))
    inside = [_ticks(*pair, few) for pair in ends]
    return Stage(bottom, top, (inside[0], inside[1], inside[2]), best)


def draw_ground(axes: Any, stage: Stage) -> None:
    """Draw the ground with its grid, and the three axes with name, unit and ticks."""
    project = stage.camera.project
    axes.add_patch(
        Polygon(project(stage.ground), facecolor=style.GROUND, edgecolor=style.FAINT, linewidth=0.8)
    )
    (e, n, floor), (f, o, _) = stage.low, stage.high
    lines = [np.array([[v, n, floor], [v, o, floor]]) for v in stage.ticks[0]]
    lines += [np.array([[e, v, floor], [f, v, floor]]) for v in stage.ticks[1]]
    axes.add_collection(
        LineCollection([project(line) for line in lines], colors=style.GRID, linewidths=1.0)
    )
    south, west = stage.camera.towards[1] < 0, stage.camera.towards[0] < 0
    _edge(axes, stage, 0, n if south else o, "east y [m]", -1.0 if south else 1.0)
    _edge(axes, stage, 1, e if west else f, "north x [m]", -1.0 if west else 1.0)
    _height_axis(axes, stage)


def _edge(axes: Any, stage: Stage, axis: int, at: float, name: str, outward: float) -> None:
    """Label the near edge of the ground along ``axis``; ``outward`` is the sign of outside."""
    project = stage.camera.project
    out = np.zeros(3)
    out[1 - axis] = outward
    away = project(out) / np.linalg.norm(project(out))
    tick = TICK_ROOM * stage.width

    def place(value: float) -> Array:
        point = np.array([0.0, 0.0, stage.floor])
        point[axis], point[1 - axis] = value, at
        return project(point)

    corner = project(stage.height_corner)
    for value in stage.ticks[axis]:
        foot = place(value)
        if np.linalg.norm(foot + tick * away - corner) < 1.6 * tick:
            continue  # the numbers of the altitude stand there
        axes.plot(*np.stack([foot, foot + 0.35 * tick * away]).T, color=style.FAINT, linewidth=0.8)
        axes.text(*(foot + 1.15 * tick * away), _number(value), **TICK)
    first, last = place(stage.low[axis]), place(stage.high[axis])
    angle = np.rad2deg(np.arctan2(*(last - first)[::-1]))
    middle = 0.5 * (first + last) + 2.9 * tick * away
    upright = (angle + 90) % 180 - 90
    axes.text(*middle, name, rotation=upright, rotation_mode="anchor", **LABEL)


def _height_axis(axes: Any, stage: Stage) -> None:
    project, corner = stage.camera.project, stage.height_corner

    def place(height: float) -> Array:
        return project(np.array([*corner[:2], height]))

    foot, top = place(stage.floor), place(stage.top)
    axes.plot(*np.stack([foot, top]).T, color=style.FAINT, linewidth=0.8)
    tick = TICK_ROOM * stage.width
    for value in stage.ticks[2]:
        x, y = place(value)
        axes.plot([x - 0.35 * tick, x], [y, y], color=style.FAINT, linewidth=0.8)
        axes.text(x - 0.6 * tick, y, _number(value), **(TICK | {"ha": "right"}))
    middle = 0.5 * (foot + top) - np.array([2.7 * tick, 0.0])
    axes.text(*middle, "altitude −z [m]", rotation=90, **LABEL)


TICK: dict[str, Any] = {"color": style.MUTED, "fontsize": 9, "ha": "center", "va": "center"}
LABEL: dict[str, Any] = {"color": style.MUTED, "fontsize": 10, "ha": "center", "va": "center"}


def _number(value: float) -> str:
    return f"{value:g}".replace("-", "−")


def _merit(camera: Camera, path: Array, solids: list[Solid]) -> float:
    """Return how well the path is seen: its length on paper, less what is hidden."""
    hidden = np.zeros(len(path), dtype=bool)
    for solid in solids:
        hidden |= solid.hides(path, camera.ray)
    drawn = camera.project(path)
    length = float(np.sum(np.linalg.norm(np.diff(drawn, axis=0), axis=1)))
    preferred = 1e-3 * float(camera.azimuth == AZIMUTHS[0])
    return length * (1 - 1.5 * float(np.mean(hidden)) + preferred)


def _widened(low: float, high: float, width: float) -> tuple[float, float]:
    middle = 0.5 * (low + high)
    return middle - 0.5 * width, middle + 0.5 * width


def _ticks(low: float, high: float, few: bool) -> Array:
    locator = MaxNLocator(nbins=4 if few else 6, steps=[1, 2, 2.5, 5, 10])
    values = np.asarray(locator.tick_values(low, high), dtype=float)
    edge = 1e-9 * (high - low)
    result: Array = values[(values >= low - edge) & (values <= high + edge)]
    return result
