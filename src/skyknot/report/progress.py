"""Figure "history": how the optimiser got there."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullFormatter

from skyknot.report import style
from skyknot.report.base import Kind
from skyknot.report.reading import Reading
from skyknot.solution import HISTORY

SMALLEST = 1e-16
"""Zero on a logarithmic axis."""


def draw_history(figure: Any, reading: Reading) -> str:
    """Draw infeasibilities (logarithmic) and objective over the iterations."""
    history = reading.solution.history
    count = {name: history[:, i] for i, name in enumerate(HISTORY)}
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    upper.set_yscale("log")
    upper.yaxis.set_major_formatter(FuncFormatter(power_of_ten))
    for name, label, color in (
        ("primal_infeasibility", "constraints (primal)", style.BLUE),
        ("dual_infeasibility", "optimality (dual)", style.VERMILLION),
    ):
        values = np.maximum(count[name], SMALLEST)
        upper.plot(count["iteration"], values, "o-", color=color, markersize=3, label=label)
    tolerance = reading.solution.record.tolerance
    upper.axhline(tolerance, color=style.MUTED, linewidth=0.9, linestyle=(0, (5, 3)))
    upper.text(
        0.01, tolerance, "tolerance", transform=upper.get_yaxis_transform(),
        ha="left", va="bottom", color=style.MUTED, fontsize=8,
    )  # fmt: skip
    upper.yaxis.set_minor_formatter(NullFormatter())
    upper.set_ylabel("infeasibility")
    upper.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=2)
    lower.plot(count["iteration"], count["objective"], "o-", color=style.GREEN, markersize=3)
    lower.set_ylabel("objective")
    lower.set_xlabel("iteration")
    lower.xaxis.set_major_locator(MaxNLocator(integer=True))
    return (
        "Violation of the constraints and of the optimality conditions at every iteration of the"
        f" solver '{reading.solution.record.solver}', and the objective."
    )


def power_of_ten(value: float, _position: int = 0) -> str:
    """Return 10ⁿ in plain characters, which any typeface can set."""
    digits = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return f"10{str(round(np.log10(value))).translate(digits)}"


HISTORY_FIGURE = Kind(
    "history",
    "Optimisation history",
    (5.2, 4.0),
    lambda reading: len(reading.solution.history) > 0,
    draw_history,
)
