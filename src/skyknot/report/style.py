"""The one style of all figures: Okabe–Ito colours, quiet axes, no global state.

Reference: M. Okabe and K. Ito, Color Universal Design, 2008: eight colours told apart by people
with any of the common colour-vision deficiencies.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
from matplotlib.colors import LinearSegmentedColormap

BLUE, VERMILLION, GREEN = "#0072b2", "#d55e00", "#009e73"
ORANGE, SKY, PURPLE = "#e69f00", "#56b4e9", "#cc79a7"

SERIES = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY)
"""Colours of lines in one panel, in order."""

LIMIT = VERMILLION
"""What must not be crossed."""

INK, MUTED, FAINT = "#1c2733", "#5b6b7a", "#b4bfc9"
GRID, GROUND, PAPER = "#e3e8ed", "#f3f5f7", "#ffffff"
"""Neutral colours."""

THEMED = {
    "ink": INK,
    "muted": MUTED,
    "faint": FAINT,
    "grid": GRID,
    "ground": GROUND,
    "paper": PAPER,
    "blue": BLUE,
    "vermillion": VERMILLION,
    "green": GREEN,
}
"""Colours that the page sets anew for its dark theme, by the name of their CSS variable."""

SPEED = LinearSegmentedColormap.from_list(
    "speed", ["#3b4cc0", "#2f86c1", "#2aa39a", "#7dbb4a", "#e6a51c"]
)
"""Slow to fast: lightness rises throughout, readable on white and on black."""

RULES: Any = {
    "figure.facecolor": PAPER,
    "figure.dpi": 110,
    "savefig.dpi": 200,
    "axes.facecolor": "none",
    "axes.edgecolor": FAINT,
    "axes.labelcolor": MUTED,
    "axes.titlecolor": INK,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9.5,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.unicode_minus": True,
    "axes.xmargin": 0.01,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": MUTED,
    "ytick.labelcolor": MUTED,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "text.color": INK,
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "lines.linewidth": 1.7,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "legend.fontsize": 9,
    "legend.labelcolor": INK,
    "legend.borderaxespad": 0.2,
    "legend.handlelength": 1.4,
    "legend.columnspacing": 1.4,
    "svg.fonttype": "none",
    "svg.hashsalt": "skyknot",
    "pdf.fonttype": 42,
    "text.usetex": False,
    "text.parse_math": False,  # a name may hold a dollar sign
    "path.simplify": True,
}


@contextmanager
def styled() -> Iterator[None]:
    """Draw, or save, under the rules above; what was set before is restored."""
    with mpl.rc_context(RULES):
        yield
