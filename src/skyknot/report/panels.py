"""Panels of quantities over time, as all time figures draw them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from skyknot.report import style
from skyknot.report.reading import Line

CROWDED = 160
"""Nodes beyond which dots would hide the line."""

FLOWN_WIDTH = 6.0
"""Width of the line of the open-loop flight, points: seen on both sides of the plan."""

ON_THE_BOUND = 1e-3
"""Share of the room between bounds within which a line lies on one of them."""

FLOWN_WORDS = "Wide and pale: the controls flown again, open loop."

TALL, ROW_HEIGHT = 3, 1.5
"""Rows beyond which a figure grows, to this many inches a row."""

REACH = 0.25
"""A bound farther outside the values than this share of their range is not shown."""


def overlay(axes: Any, lines: Sequence[Line], title: str) -> None:
    """Draw lines of one unit into one panel, bounds dashed in the line's colour."""
    for line, color in zip(lines, style.SERIES, strict=False):
        trace(axes, line, color)
        axes.lines[-1].set_label(line.label)
        for bound in (line.lower, line.upper):
            if _near(bound, line):
                axes.axhline(bound, color=color, linewidth=0.9, linestyle=(0, (5, 3)), alpha=0.8)
                for a, b in arcs_at(line, bound):
                    axes.plot([a, b], [bound, bound], color=style.LIMIT, linewidth=5, alpha=0.35,
                              solid_capstyle="butt", zorder=1)  # fmt: skip
    _view(axes, lines)
    axes.set_ylabel(f"{title} [{lines[0].unit or '-'}]")
    axes.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=len(lines), borderaxespad=0.1)


def single(axes: Any, line: Line, color: str = style.BLUE) -> None:
    """Draw one line into its panel, what lies beyond its bounds shaded."""
    trace(axes, line, color)
    _view(axes, [line])
    shade(axes, line.lower, line.upper, _near(line.lower, line), _near(line.upper, line))
    shade_arcs(axes, line)
    axes.set_title(line.words.capitalize())
    axes.set_ylabel(f"{line.symbol} [{line.unit or '-'}]")


def trace(axes: Any, line: Line, color: str) -> None:
    """Draw the flight wide and pale, over it the nodes as dots and the interpolant as a line."""
    if line.flown is not None:
        axes.plot(line.times, line.flown, color=color, linewidth=FLOWN_WIDTH, alpha=0.3)
    size = 2.6 if len(line.node_times) <= CROWDED else 1.2
    axes.plot(
        line.node_times,
        line.node_values,
        "o",
        color=color,
        markersize=size,
        markeredgewidth=0,
        alpha=0.75,
    )
    axes.plot(line.times, line.values, color=color)


def arcs_at(line: Line, bound: float) -> list[tuple[float, float]]:
    """Return when a line lies on a bound, as pairs of times, s."""
    if not np.isfinite(bound):
        return []
    both = line.upper - line.lower
    size = both if np.isfinite(both) and both > 0 else max(abs(bound), float(np.ptp(line.values)))
    on = np.abs(line.values - bound) <= ON_THE_BOUND * size
    edges = np.flatnonzero(np.diff(np.concatenate([[0], on.astype(int), [0]])))
    pairs = zip(edges[::2], edges[1::2] - 1, strict=True)
    return [(float(line.times[a]), float(line.times[b])) for a, b in pairs if b > a]


def shade_arcs(axes: Any, line: Line) -> None:
    """Shade the times when a line lies on one of its bounds."""
    for a, b in arcs_at(line, line.lower) + arcs_at(line, line.upper):
        axes.axvspan(a, b, color=style.LIMIT, alpha=0.10, linewidth=0)


def _view(axes: Any, lines: Sequence[Line]) -> None:
    """Show the plan whole, and as much of the flight as fits in twice that."""
    if not any(line.flown is not None for line in lines):
        return
    planned = np.concatenate([line.values for line in lines])
    low, high = float(np.min(planned)), float(np.max(planned))
    room = max(0.5 * (high - low), 1e-6)
    flown = np.concatenate([line.values if line.flown is None else line.flown for line in lines])
    flown = flown[np.isfinite(flown)]
    low, high = max(min([low, *flown]), low - room), min(max([high, *flown]), high + room)
    margin = 0.05 * max(high - low, 1e-9)
    axes.set_ylim(low - margin, high + margin)


def shade(axes: Any, lower: float, upper: float, low: bool = True, high: bool = True) -> None:
    """Shade what lies beyond the bounds; the view is widened to show a little of it."""
    bottom, top = axes.get_ylim()
    margin = 0.06 * ((upper if high else top) - (lower if low else bottom))
    if low:
        bottom = min(bottom, lower - margin)
        axes.axhspan(bottom - 10 * margin, lower, color=style.LIMIT, alpha=0.12, linewidth=0)
        axes.axhline(lower, color=style.LIMIT, linewidth=0.9)
    if high:
        top = max(top, upper + margin)
        axes.axhspan(upper, top + 10 * margin, color=style.LIMIT, alpha=0.12, linewidth=0)
        axes.axhline(upper, color=style.LIMIT, linewidth=0.9)
    axes.set_ylim(bottom, top)


def grid_of_panels(figure: Any, count: int, columns: int = 2, share_y: bool = False) -> list[Any]:
    """Return ``count`` panels over one time axis, row by row; the last row names the time."""
    columns = min(columns, count)
    rows = -(-count // columns)
    if rows > TALL and isinstance(figure, Figure):
        figure.set_figheight(ROW_HEIGHT * rows)
    grid = figure.subplots(rows, columns, sharex=True, sharey=share_y, squeeze=False)
    panels = list(grid.ravel())
    for panel in panels[count:]:
        panel.remove()
    for i, panel in enumerate(panels[:count]):
        if i + columns >= count:
            panel.tick_params(labelbottom=True)
            panel.set_xlabel("time [s]")
    return panels[:count]


def _near(bound: float, line: Line) -> bool:
    if not np.isfinite(bound):
        return False
    low, high = float(np.min(line.values)), float(np.max(line.values))
    reach = REACH * max(high - low, 1e-9)
    return low - reach <= bound <= high + reach
