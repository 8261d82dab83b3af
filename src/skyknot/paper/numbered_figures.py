"""The figures of the source report by its numbers, drawn from our own runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from skyknot.paper.base import Finding, Scale
from skyknot.paper.schematics import draw_flow, draw_intervals
from skyknot.paper.transfers import SEGMENTS, report_flight
from skyknot.report import style
from skyknot.report.figures import Illustration, illustrate
from skyknot.report.progress import power_of_ten

SIZE = (5.9, 4.3)
"""Width and height, inches."""

Draw = Callable[[Any, dict[str, Finding]], str]


def numbered_figures(findings: dict[str, Finding], scale: Scale) -> list[Illustration]:
    """Return figures 2 to 11 and the stability region, with captions.

    Parameters
    ----------
    findings : by the name of their experiment
    scale : of the run; the flight drawn has that size
    """
    flight = report_flight(scale.pick(50, SEGMENTS))
    shown = {4: "position", 5: "rotors", 6: "path", 7: "history", 8: "before_after"}
    pictures = {
        number: replace(illustrate(flight, kind), kind=f"figure-{number:02d}")
        for number, kind in shown.items()
    }
    pictures[9] = replace(illustrate(flight, "velocity"), kind="figure-09")
    for number, (_, draw) in DRAWN.items():
        pictures[number] = _drawn(number, draw, findings)
    return [
        replace(pictures[number], title=f"Figure {number}. {TITLES[number]}")
        for number in sorted(pictures)
    ]


def draw_order(figure: Any, findings: dict[str, Finding]) -> str:
    """Draw figure 10: errors over the length of a segment, with the slopes said and measured."""
    axes = _logarithmic(figure, "length h of a segment [s]", "largest error of a state [SI]")
    lines = (("global_order", "global", style.BLUE), ("local_order", "one segment", style.GREEN))
    for (name, label, color), order in zip(lines, (3, 4), strict=True):
        data = findings[name].data
        h, errors = np.array(data["h"]), np.array(data["errors"])
        axes.plot(h, errors, "o-", color=color, label=f"{label}, measured")
        said = errors[0] * (h / h[0]) ** order
        axes.plot(h, said, linestyle=(0, (4, 2)), color=color, label=f"slope {order}, as said")
    axes.legend(loc="lower right")
    return (
        "Error of the 12-state craft at the nodes of a smooth transfer, and of one segment, against"
        " the slopes that the source report names. Both fall one order faster."
    )


def draw_convergence(figure: Any, findings: dict[str, Finding]) -> str:
    """Draw figure 11: both errors over the iterations."""
    data = findings["linear_then_superlinear"].data
    axes = figure.subplots()
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(power_of_ten)
    axes.plot(data["iteration"], data["defect"], "o-", color=style.BLUE, label="defect (19)")
    axes.plot(
        data["iteration"], data["optimality"], "s-", color=style.VERMILLION, label="optimality (20)"
    )
    axes.set_xlabel("iteration")
    axes.set_ylabel("error")
    axes.legend()
    return (
        "Largest defect and optimality error of the report's transfer at every iteration of the"
        " interior point, to a tolerance of 1e-10."
    )


def draw_stability(figure: Any, findings: dict[str, Finding]) -> str:
    """Draw |R(z)| over the complex plane."""
    data = findings["stability_region"].data
    axes = figure.subplots()
    size = np.minimum(np.array(data["size"]), 4.0)
    axes.contourf(
        data["real"], data["imaginary"], size, levels=[0.0, 1.0], colors=[style.SKY], alpha=0.45
    )
    lines = axes.contour(
        data["real"], data["imaginary"], size, levels=[0.25, 0.5, 1.0, 2.0], colors=[style.BLUE]
    )
    axes.clabel(lines, fontsize=8)
    axes.set_aspect("equal")
    axes.set_xlabel("Re λh [-]")
    axes.set_ylabel("Im λh [-]")
    return (
        "|R(z)| of the scheme, from the rows of its own table; shaded where at most 1. The region"
        " is the left half plane, the imaginary axis its edge."
    )


def _drawn(number: int, draw: Draw, findings: dict[str, Finding]) -> Illustration:
    with style.styled():
        figure = Figure(figsize=SIZE, layout="constrained")
        caption = draw(figure, findings)
    return Illustration(f"figure-{number:02d}", TITLES[number], caption, figure)


def _logarithmic(figure: Any, across: str, up: str) -> Any:
    axes = figure.subplots()
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(power_of_ten)
        axis.set_minor_formatter(lambda _value, _position: "")
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    return axes


TITLES = {
    2: "Hermite–Simpson collocation intervals",
    3: "Flow of Algorithm 1",
    4: "Trajectory after optimised control",
    5: "Rotor inputs over time",
    6: "The craft in space at time stamps",
    7: "Optimisation history",
    8: "Simulation before, trajectory after",
    9: "Velocity of the optimised trajectory",
    10: "Order of accuracy",
    11: "Convergence of both errors",
    12: "Stability region (not in the report)",
}
"""Titles by the numbers of the source report."""

DRAWN: dict[int, tuple[str, Draw]] = {
    2: (TITLES[2], draw_intervals),
    3: (TITLES[3], draw_flow),
    10: (TITLES[10], draw_order),
    11: (TITLES[11], draw_convergence),
    12: (TITLES[12], draw_stability),
}
"""Figures that no kind of the report room draws."""
