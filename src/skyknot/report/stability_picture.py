"""The stability region of a scheme as a picture.

Legend: z = hλ, R(z) = x_{k+1}/x_k on ẋ = λx.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.report.figures import rendered, write_bytes
from skyknot.report.style import BLUE, INK, LIMIT, MUTED, styled

Array = NDArray[np.float64]

SUFFIXES = ("png", "pdf", "svg")


def stability_figure(title: str, real: Array, imaginary: Array, size: Array) -> Figure:
    """Return the region |R| ≤ 1, shaded, with lines of |R| on both sides of it.

    Parameters
    ----------
    title : name of the scheme
    real, imaginary : (n,), (m,) axes of z
    size : (m, n) values of |R|
    """
    with styled():
        figure = Figure(figsize=(4.6, 4.4), layout="constrained")
        axes = figure.add_subplot()
        known = np.minimum(np.nan_to_num(size, nan=np.inf, posinf=1e6), 1e6)
        axes.contourf(real, imaginary, known, levels=[0.0, 1.0], colors=[BLUE], alpha=0.22)
        axes.contour(real, imaginary, known, levels=[1.0], colors=[INK], linewidths=1.2)
        levels = [0.1, 0.3, 0.6, 1.5, 3.0, 10.0]
        lines = axes.contour(real, imaginary, known, levels=levels, colors=[MUTED], linewidths=0.6)
        axes.clabel(lines, fmt="%g", fontsize=7)
        axes.axvline(0.0, color=LIMIT, linewidth=0.8, linestyle=(0, (4, 3)))
        axes.set(
            title=f"{title}: |R(z)|, stable where shaded",
            xlabel="Re z = Re hλ [-]",
            ylabel="Im z = Im hλ [-]",
            aspect="equal",
        )
    return figure


def write_figure(figure: Figure, path: Path) -> Path:
    """Write a figure as PNG, PDF or SVG by the suffix of its path.

    Raises
    ------
    UserError
        When the suffix is another one, or the file cannot be written.
    """
    suffix = path.suffix.lstrip(".").lower()
    if suffix not in SUFFIXES:
        raise UserError(
            "Pictures cannot be written in this format.",
            where="plot",
            found=f"'{path.name}'",
            expected=" or ".join(f".{known}" for known in SUFFIXES),
            do="End the name of the file in one of these.",
        )
    write_bytes(path, rendered(figure, suffix))
    return path
