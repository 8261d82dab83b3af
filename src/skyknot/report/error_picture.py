"""Errors against the number of segments, one panel for each family of problems.

Legend: N segments.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from skyknot.report.style import MUTED, SERIES, styled

Curves = Mapping[str, tuple[Sequence[int], Sequence[float]]]

COLUMNS = 2
DASHES = ("-", "--", ":")
FLOOR = 1e-16
"""An error of zero is drawn here."""


def error_figure(families: Mapping[str, Curves]) -> Figure:
    """Return relative errors over N, both in logarithms, with slopes of order 2 and 4 to compare.

    Parameters
    ----------
    families : title of a panel → name of a problem → numbers of segments, errors (NaN: none)
    """
    rows = -(-len(families) // COLUMNS)
    with styled():
        figure = Figure(figsize=(9.6, 3.3 * rows), layout="constrained")
        panels = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
        for axes, (title, curves) in zip(panels, families.items(), strict=False):
            _draw(axes, curves)
            axes.set(title=title, xlabel="segments N [-]", ylabel="relative error [-]")
        for axes in panels[len(families) :]:
            axes.set_visible(False)
    return figure


def _draw(axes: Axes, curves: Curves) -> None:
    looks = cycle([(color, dash) for dash in DASHES for color in SERIES])
    for (name, (meshes, errors)), (color, dash) in zip(curves.items(), looks, strict=False):
        drawn = np.maximum(np.array(errors, dtype=float), FLOOR)
        axes.loglog(meshes, drawn, dash, color=color, marker="o", markersize=3, label=name)
    N = np.unique([count for meshes, _ in curves.values() for count in meshes]).astype(float)
    for order in (2, 4):
        axes.loglog(N, (N / N[0]) ** -order, color=MUTED, linewidth=0.8)
        axes.annotate(
            f"N^−{order}",
            (N[-1], (N[-1] / N[0]) ** -order),
            xytext=(-3, 3),
            textcoords="offset points",
            ha="right",
            color=MUTED,
            fontsize=7,
        )
    axes.set_xticks(N, [f"{count:g}" for count in N])
    axes.minorticks_off()
    # set as plain text: the style leaves mathematics in labels alone
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0e}"))
    axes.legend(fontsize=6, loc="center left", bbox_to_anchor=(1.0, 0.5))
