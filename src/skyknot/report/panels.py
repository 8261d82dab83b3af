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
    axes.set_ylabel(f"{title} [{lines[0].unit or '-'}]")
    axes.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=len(lines), borderaxespad=0.1)


def single(axes: Any, line: Line, color: str = style.BLUE) -> None:
    """Draw one line into its panel, what lies beyond its bounds shaded."""
    trace(axes, line, color)
    shade(axes, line.lower, line.upper, _near(line.lower, line), _near(line.upper, line))
    axes.set_title(line.words.capitalize())
    axes.set_ylabel(f"{line.symbol} [{line.unit or '-'}]")


def trace(axes: Any, line: Line, color: str) -> None:
    """Draw the nodes as dots and the interpolant as a line."""
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
