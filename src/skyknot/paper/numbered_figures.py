"""The figures of the source report by its numbers, drawn from our own runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from skyknot.paper.base import Finding, Scale
from skyknot.paper.craft_drawing import draw_vehicle
from skyknot.paper.flown_figures import draw_flown, draw_start
from skyknot.paper.performance_figures import (
    draw_convergence,
    draw_growth,
    draw_order,
    draw_spread,
)
from skyknot.paper.schematics import draw_flow, draw_intervals
from skyknot.paper.transfers import SEGMENTS, descent_flight
from skyknot.report import style
from skyknot.report.figures import Illustration, illustrate

SIZE = (5.2, 4.0)
"""Width and height, inches."""

Draw = Callable[[Any, dict[str, Finding]], str]

SHOWN = {
    4: ("position", "Trajectory after optimised control"),
    5: ("rotors", "Rotor inputs over time"),
    6: ("path", "The craft in space at time stamps"),
    7: ("history", "Optimisation history"),
    8: ("before_after", "Position and orientation, simulated before and after"),
}
"""Figures that kinds of the report room draw, of the projected gradient's flight."""


def numbered_figures(findings: dict[str, Finding], scale: Scale) -> list[Illustration]:
    """Return figures 1 to 11, and those that the report lacks, with captions.

    Parameters
    ----------
    findings : by the name of their experiment
    scale : of the run; the flight drawn has that size
    """
    flight = descent_flight(scale.pick(50, SEGMENTS))
    pictures = {
        number: replace(illustrate(flight, kind), title=title)
        for number, (kind, title) in SHOWN.items()
    }
    for number, (title, size, draw) in DRAWN.items():
        pictures[number] = _drawn(title, size, draw, findings)
    return [
        replace(picture, kind=f"figure-{number:02d}", title=f"Figure {number}. {picture.title}")
        for number, picture in sorted(pictures.items())
    ]


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


def _drawn(
    title: str, size: tuple[float, float], draw: Draw, findings: dict[str, Finding]
) -> Illustration:
    with style.styled():
        figure = Figure(figsize=size, layout="constrained")
        caption = draw(figure, findings)
    return Illustration("", title, caption, figure)


DRAWN: dict[int, tuple[str, tuple[float, float], Draw]] = {
    1: ("Optimal control of the craft", (5.2, 3.0), draw_vehicle),
    2: ("Hermite–Simpson collocation intervals", SIZE, draw_intervals),
    3: ("Flow of Algorithm 1", SIZE, draw_flow),
    9: ("Position trajectory, optimised and flown", (5.2, 4.8), draw_flown),
    10: ("Order of accuracy", SIZE, draw_order),
    11: ("Convergence of both errors", SIZE, draw_convergence),
    12: ("Stability region", SIZE, draw_stability),
    13: ("What equal segments cannot see", (5.2, 5.0), draw_start),
    14: ("Time per iteration over N (cited in the report)", SIZE, draw_growth),
    15: ("Spread over seeded transfers", SIZE, draw_spread),
}
"""Figures of this room: title, size in inches, and what draws them."""
