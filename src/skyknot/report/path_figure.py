"""Figure "path": the way through space, with obstacles, ground, and the craft at time stamps."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from skyknot.report import style
from skyknot.report.base import Kind
from skyknot.report.craft import CraftShape, attitude, craft_shape, span
from skyknot.report.obstacles import draw_shadows, draw_sheets, draw_solid, runs
from skyknot.report.reading import Reading
from skyknot.report.scene import Scene
from skyknot.report.stage import TICK_ROOM, Stage, draw_ground

Array = NDArray[np.float64]

STAMPS, FEW_STAMPS = 7, 5
"""Moments at which the craft is drawn, at most; in a small picture."""

CRAFT_SHARE = 0.095
"""Span of the drawn craft as a share of the picture's width."""

STILL = 1e-3
"""Speed, m/s, below which nothing moves and colours would show noise."""

COLOUR_BAR = 0.5
"""Height left for the colour bar, inches."""

STAMP: dict[str, Any] = {
    "fontsize": 9,
    "ha": "center",
    "va": "center",
    "color": style.INK,
    "bbox": {"boxstyle": "round,pad=0.18", "facecolor": style.PAPER, "alpha": 0.72, "linewidth": 0},
}


def draw_path(figure: Any, reading: Reading, few: bool = False) -> str:
    """Draw ground, shadows, obstacles, path and craft."""
    scene = Scene(reading, few)
    axes = figure.subplots()
    axes.set_axis_off()
    axes.set_aspect("equal")
    draw_ground(axes, scene.stage)
    draw_shadows(axes, scene)
    for solid in scene.bodies:
        draw_solid(axes, scene, solid)
    bands = draw_sheets(axes, scene)
    colored = _draw_line(figure, axes, scene)
    factor = _draw_stamps(axes, scene)
    _frame(figure, axes, scene.stage)
    return _caption(scene, factor, colored, bands)


def _frame(figure: Any, axes: Any, stage: Stage) -> None:
    """Stack everything in the order drawn, cut the view to it, and the figure to the view."""
    for order, artist in enumerate([*axes.get_children()]):
        artist.set_zorder(order)
    tick = TICK_ROOM * stage.width
    box = axes.dataLim.get_points()
    places = [text.get_position() for text in axes.texts] or [(0.0, 0.0)]
    low = np.minimum(box[0], np.min(places, axis=0) - 0.7 * tick) - 0.3 * tick
    high = np.maximum(box[1], np.max(places, axis=0) + 0.7 * tick) + 0.3 * tick
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    if isinstance(figure, Figure):
        width = figure.get_figwidth()
        figure.set_figheight(width * (high[1] - low[1]) / (high[0] - low[0]) + COLOUR_BAR)


def _draw_line(figure: Any, axes: Any, scene: Scene) -> bool:
    """Draw the path; coloured by speed where the model has velocities."""
    drawn = scene.stage.camera.project(scene.path)
    pieces = np.stack([drawn[:-1], drawn[1:]], axis=1)
    hidden = scene.hidden(scene.path)[:-1]
    for run in runs(~hidden):
        axes.plot(*drawn[run.start : run.stop + 1].T, color=style.PAPER, linewidth=4.4)
    flown = scene.stage.camera.project(scene.flown)
    for run in runs(~scene.hidden(scene.flown)):
        axes.plot(*flown[run].T, color=style.BLUE, linewidth=7.5, alpha=0.25)
    speed = scene.speed[:-1]
    colored = float(speed.max()) > STILL
    look: dict[str, Any] = {"colors": style.BLUE}
    if colored:
        look = {"cmap": style.SPEED, "norm": Normalize(0, float(speed.max()))}
    for where, width, alpha in ((hidden, 1.6, 0.45), (~hidden, 2.8, 1.0)):
        choice: dict[str, Any] = {"array": speed[where]} if colored else {}
        line = LineCollection(
            list(pieces[where]), linewidths=width, alpha=alpha, capstyle="round", **look, **choice
        )
        axes.add_collection(line)
    if colored:
        bar = figure.colorbar(
            line, ax=axes, location="bottom", shrink=0.36, aspect=34, pad=0.0, anchor=(0.94, 1.0)
        )
        bar.set_label("speed [m/s]", labelpad=3)
        bar.outline.set_visible(False)
        bar.locator = MaxNLocator(5)
    return colored


def _draw_stamps(axes: Any, scene: Scene) -> float:
    """Draw craft at time stamps with drop lines; return how much larger than life."""
    vehicle, stage = scene.reading.vehicle, scene.stage
    own = span(vehicle)
    factor = _readable(max(1.0, CRAFT_SHARE * stage.width / own))
    project = stage.camera.project
    if scene.goal is not None and scene.misses_by > 0.5 * factor * own:
        axes.plot(*project(scene.goal), "D", color=style.VERMILLION, markersize=5)
        _drop(axes, stage, scene.goal)
    indices = _stamps(project(scene.path), 1.3 * factor * own, FEW_STAMPS if scene.few else STAMPS)
    angles = attitude(scene.reading, scene.states[indices])
    hidden = scene.hidden(scene.path[indices])
    order = np.argsort(stage.camera.depth(scene.path[indices]))
    for i in order:
        place = scene.path[indices[i]]
        _drop(axes, stage, place)
        shape = craft_shape(vehicle, angles[i], factor)
        _draw_craft(axes, scene, place, shape, 0.3 if hidden[i] else 1.0)
        at = project(place) + np.array([0.0, 0.62 * factor * own])
        axes.text(*at, _moment(scene.times[indices[i]]), **STAMP)
    return factor


def _draw_craft(axes: Any, scene: Scene, place: Array, shape: CraftShape, alpha: float) -> None:
    camera = scene.stage.camera

    def placed(offsets: Array) -> Array:
        return camera.project(place + camera.unstretched(offsets))

    for arm in shape.arms:
        axes.plot(*placed(arm).T, color=style.INK, linewidth=1.3, alpha=alpha)
    axes.add_patch(Polygon(placed(shape.hull), facecolor=style.INK, alpha=alpha, linewidth=0))
    far_first = np.argsort(camera.depth(shape.discs.mean(axis=1)))
    for i in far_first:
        color = style.ORANGE if shape.front[i] else style.BLUE
        disc = placed(shape.discs[i])
        axes.add_patch(Polygon(disc, facecolor=color, alpha=0.38 * alpha, linewidth=0))
        axes.add_patch(Polygon(disc, fill=False, edgecolor=color, alpha=alpha, linewidth=1.0))


def _drop(axes: Any, stage: Stage, place: Array) -> None:
    foot = np.array([*place[:2], stage.floor])
    line = stage.camera.project(np.stack([foot, place]))
    axes.plot(*line.T, color=style.MUTED, linewidth=0.7, alpha=0.55, linestyle=(0, (2, 2)))


def _stamps(drawn: Array, apart: float, most: int) -> list[int]:
    """Return indices equally far along the path on paper, first and last among them.

    None is drawn over another: where the path comes back to an earlier stamp, it is left out.
    """
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(drawn, axis=0), axis=1)))
    last = len(drawn) - 1
    if along[-1] < 0.5 * apart:
        return [0]
    wanted = np.linspace(0, along[-1], max(2, min(most, int(along[-1] / apart) + 1)))
    kept = [0, last]
    for i in np.searchsorted(along, wanted[1:-1]):
        if np.all(np.linalg.norm(drawn[kept] - drawn[i], axis=1) > 0.8 * apart):
            kept.append(int(i))
    return kept


def _moment(time: float) -> str:
    return f"{time:.0f} s" if time >= 10 else f"{time:.2g} s"


def _readable(factor: float) -> float:
    """Return the factor with one digit, or 1 when it is close to life."""
    if factor < 1.3:
        return 1.0
    size = 10.0 ** np.floor(np.log10(factor))
    return float(np.round(factor / size) * size)


def _caption(scene: Scene, factor: float, colored: bool, bands: bool) -> str:
    parts = ["Path" + (", coloured by speed" if colored else "") + ", with its track on the ground"]
    if len(scene.flown):
        parts.append("wide and pale: the controls flown again, open loop")
    larger = f" {factor:g} times its size" if factor > 1 else " to scale"
    parts.append(f"the craft at time stamps,{larger}, front rotors orange")
    if scene.misses_by > 0.5 * factor * span(scene.reading.vehicle):
        parts.append("diamond: the goal")
    if any(not solid.keep_in for solid in scene.bodies):
        parts.append("grey: obstacles, the path thin and pale where one hides it")
    if bands or any(solid.keep_in for solid in scene.bodies):
        parts.append("light blue: the room to stay in")
    if scene.stage.camera.stretch > 1:
        parts.append(f"heights are stretched {scene.stage.camera.stretch:.2g} times")
    return "; ".join(parts) + "."


PATH_FIGURE = Kind("path", "Path", (6.0, 5.2), lambda reading: reading.flies, draw_path)
