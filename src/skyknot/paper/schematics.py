"""Figures 2 and 3 of the source report: what a collocation interval is, and its Algorithm 1."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.patches import FancyBboxPatch

from skyknot.paper.base import Finding
from skyknot.paper.transfers import SEGMENTS, report_flight
from skyknot.report import style

SHOWN = 3
"""Segments drawn in figure 2."""

STEPS = (
    ("1, 2", "guess z₀, step α, most iterations; i ← 0"),
    ("4", "gradient ∇J(z)"),
    ("5", "z ← z − α ∇J(z)"),
    ("6", "u ← min(max(u, u_min), u_max)"),
    ("7", "defects c(z), equation (11)"),
    ("3, 8", "‖c‖ < tolerance, or i = most?"),
    ("13", "return z"),
)
"""Lines and boxes of Algorithm 1 in order."""

CENTRE, WIDE, HIGH = 0.42, 0.56, 0.095
"""Place and size of the boxes, in shares of the figure."""


def draw_intervals(figure: Any, _findings: dict[str, Finding]) -> str:
    """Draw the first segments of a state of the solved transfer: nodes, midpoints, interpolant."""
    solution = report_flight(SEGMENTS)
    i = 6
    times, middle = solution.times[: SHOWN + 1], solution.midpoint_states[:SHOWN, i]
    dense = np.linspace(times[0], times[-1], 400)
    axes = figure.subplots()
    axes.plot(dense, solution.state(dense)[:, i], color=style.BLUE, label="interpolant")
    axes.plot(times, solution.states[: SHOWN + 1, i], "o", color=style.INK, label="nodes t_k")
    centres = 0.5 * (times[1:] + times[:-1])
    axes.plot(centres, middle, "D", color=style.VERMILLION, label="midpoints t_c")
    for t in times:
        axes.axvline(t, color=style.FAINT, linewidth=0.8)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("roll angle φ [rad]")
    axes.legend()
    return (
        f"The first {SHOWN} segments of the solved transfer, N = {SEGMENTS}: the defect (11) ties"
        " each node to the next, the Hermite row (12) places the midpoint."
    )


def draw_flow(figure: Any, _findings: dict[str, Finding]) -> str:
    """Draw Algorithm 1 as printed."""
    axes = figure.subplots()
    axes.set_axis_off()
    axes.set_xlim(0, 1)
    axes.set_ylim(0, 1)
    heights = np.linspace(0.94, 0.06, len(STEPS))
    for (line, words), height in zip(STEPS, heights, strict=True):
        box = FancyBboxPatch(
            (CENTRE - WIDE / 2, height - HIGH / 2), WIDE, HIGH, facecolor=style.GROUND,
            edgecolor=style.MUTED, boxstyle="round,pad=0,rounding_size=0.02",
        )  # fmt: skip
        axes.add_patch(box)
        axes.text(CENTRE, height, words, ha="center", va="center")
        axes.text(CENTRE - WIDE / 2 - 0.02, height, line, ha="right", va="center",
                  color=style.MUTED)  # fmt: skip
    for above, below in pairwise(heights):
        _arrow(axes, (CENTRE, above - HIGH / 2), (CENTRE, below + HIGH / 2))
    edge, away = CENTRE + WIDE / 2, CENTRE + WIDE / 2 + 0.09
    test, first = heights[-2], heights[1]
    axes.plot([edge, away, away], [test, test, first], color=style.MUTED, linewidth=1.0)
    _arrow(axes, (away, first), (edge, first))
    axes.text(away + 0.015, 0.5 * (test + first), "no:\ni ← i + 1", va="center",
              color=style.MUTED)  # fmt: skip
    axes.text(CENTRE + 0.015, 0.5 * (heights[-1] + test), "yes", va="center", color=style.MUTED)
    return (
        "Algorithm 1 as printed, its line numbers at the left. The step descends J without the"
        " defects; only the stopping test looks at them."
    )


def _arrow(axes: Any, start: tuple[float, float], end: tuple[float, float]) -> None:
    style_of_arrow = {"arrowstyle": "-|>", "color": style.MUTED, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=style_of_arrow)
