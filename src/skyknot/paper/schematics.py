"""Figures 2 and 3 of the source report: what a collocation interval is, and its Algorithm 1."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from skyknot.paper.base import Finding
from skyknot.paper.transfers import SEGMENTS, report_flight
from skyknot.report import style

SHOWN = 3
"""Segments drawn in figure 2."""

STEPS = (
    "start: z₀, α, most iterations",
    "gradient ∇J(z)",
    "z ← z − α ∇J(z)",
    "project: u ← min(max(u, u_min), u_max)",
    "defects c(z), equation (11)",
)
"""Boxes of Algorithm 1 in order."""

BOX: dict[str, Any] = {"boxstyle": "round,pad=0.5", "facecolor": style.GROUND}


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
    axes.set_ylabel("roll φ [rad]")
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
    axes.set_ylim(-0.1, 1.05)
    heights = np.linspace(0.97, 0.25, len(STEPS))
    for height, text in zip(heights, STEPS, strict=True):
        axes.text(0.4, height, text, ha="center", va="center", bbox=BOX)
    ends = {"arrowstyle": "->", "color": style.MUTED}
    for above, below in pairwise(heights):
        axes.annotate("", (0.4, below + 0.06), (0.4, above - 0.06), arrowprops=ends)
    axes.text(0.4, 0.0, "‖c‖ < tolerance: return z", ha="center", va="center", bbox=BOX)
    axes.annotate("", (0.4, 0.06), (0.4, heights[-1] - 0.06), arrowprops=ends)
    back = [heights[-1], heights[-1], heights[1]]
    axes.plot([0.62, 0.85, 0.85], back, color=style.MUTED, linewidth=1.0)
    axes.annotate("", (0.57, heights[1]), (0.85, heights[1]), arrowprops=ends)
    axes.text(0.88, 0.52, "not yet:\nnext i", ha="left", va="center", color=style.MUTED)
    return (
        "Algorithm 1 as printed. Its step descends J without the defects, and only its stopping"
        " test looks at them: it cannot be relied on to reach a flight."
    )
