"""The picture of the growth: time over segments, both in logarithms, with fitted exponents."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from skyknot.bench.suite import Results

COLORS = ("#0b5fa5", "#c1502e", "#5a8f3c", "#7a5195", "#8a6d3b")


def write_growth_figure(results: Results, path: Path) -> None:
    """Write time of a solve, and of an iteration, over the number of segments."""
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    slopes = results.slopes()
    for (name, exponents), color in zip(slopes.items(), COLORS, strict=False):
        timings = [contest.timings[name] for contest in results.growth]
        N = np.array([contest.segments for contest in results.growth], dtype=float)
        for axes, values, what in (
            (left, [timing.median for timing in timings], "time"),
            (right, [timing.per_iteration for timing in timings], "time_per_iteration"),
        ):
            milliseconds = 1e3 * np.array(values)
            label = f"{name}: N^{exponents[what]:.2f}"
            axes.loglog(N, milliseconds, "o", color=color, label=label)
            _draw_fit(axes, N, milliseconds, color)
    for axes, title in ((left, "one solve"), (right, "one iteration")):
        axes.set_title(f"Time of {title}, warm", loc="left")
        axes.set_xlabel("segments N")
        axes.set_ylabel("ms")
        axes.grid(visible=True, which="both", alpha=0.25)
        axes.legend(frameon=False)
    figure.savefig(path, dpi=150)


def _draw_fit(axes: object, N: np.ndarray, values: np.ndarray, color: str) -> None:
    known = np.isfinite(values)
    if np.count_nonzero(known) < 3:
        return
    fit = np.polyfit(np.log(N[known]), np.log(values[known]), 1)
    axes.loglog(N, np.exp(np.polyval(fit, np.log(N))), color=color, linewidth=1)  # type: ignore[attr-defined]
