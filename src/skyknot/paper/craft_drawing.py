"""Figure 1 of the source report: the craft, its rotors and axes, and what controls it.

Legend: body axes x forward, y right, z down; T thrust along −z of the body; τ torques; NED.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.patches import Circle, FancyArrowPatch

from skyknot.paper.base import Finding
from skyknot.paper.transfers import VEHICLE
from skyknot.report import style

BLADE = 0.42
"""Radius of a rotor drawn, as a share of the arm; the report gives none."""

TILT = 0.30
"""Pitch at which the side view is drawn, rad, nose down."""


def draw_vehicle(figure: Any, _findings: dict[str, Finding]) -> str:
    """Draw figure 1: the craft from above and from its right, to scale."""
    above, side = figure.subplots(1, 2)
    arm = float(np.linalg.norm(VEHICLE.rotor_positions[0]))
    for axes in (above, side):
        axes.set_aspect("equal")
        axes.grid(visible=False)
        reach = 1.75 * arm
        axes.set_xlim(-reach, reach)
        axes.set_ylim(-reach, reach)
        axes.set_axis_off()
    _draw_above(above, arm)
    _draw_side(side, arm)
    lower, upper = VEHICLE.control_bounds
    Ixx, Iyy, Izz = VEHICLE.inertia
    return (
        f"The craft to scale (rotor size assumed): m = {VEHICLE.mass:g} kg, I = diag({Ixx:g},"
        f" {Iyy:g}, {Izz:g}) kg m², arms of {arm:g} m. Controls (2): thrust {lower[0]:g} to"
        f" {upper[0]:g} N, |τx| ≤ {upper[1]:g}, |τy| ≤ {upper[2]:g}, |τz| ≤ {upper[3]:g} N m."
        " Rotors are numbered as in figure 5; arrows tell how they turn."
    )


def _draw_above(axes: Any, arm: float) -> None:
    axes.set_title("from above")
    spins = VEHICLE.allocation.spins
    for i, ((x, y), spin) in enumerate(zip(VEHICLE.rotor_positions[:, :2], spins, strict=True)):
        axes.plot([0, y], [0, x], color=style.INK, linewidth=3, zorder=1)
        axes.add_patch(
            Circle((y, x), BLADE * arm, facecolor=style.GROUND, edgecolor=style.MUTED, zorder=2)
        )
        _turn(axes, (y, x), 0.72 * BLADE * arm, clockwise=spin > 0)
        axes.text(y, x, f"{i + 1}", ha="center", va="center", fontweight="bold", fontsize=11)
    axes.plot(0, 0, "o", color=style.INK, markersize=11)
    _arrow(axes, (0, 0), (0, 1.45 * arm), style.BLUE, "x forward, τx", (0.08 * arm, 1.45 * arm))
    _arrow(axes, (0, 0), (1.45 * arm, 0), style.GREEN, "y right, τy", (1.02 * arm, -0.16 * arm))
    axes.text(0, -1.45 * arm, "z down, τz: into the page", ha="center", color=style.MUTED)


def _draw_side(axes: Any, arm: float) -> None:
    """Draw the craft pitched nose down, seen from its right: forward to the right."""
    axes.set_title("from its right, pitched by θ < 0")
    forward = np.array([np.cos(TILT), -np.sin(TILT)])
    up = np.array([np.sin(TILT), np.cos(TILT)])
    hub = abs(float(VEHICLE.rotor_positions[0, 0]))
    for sign in (1, -1):
        centre = sign * hub * forward + 0.08 * arm * up
        ends = np.array([centre - BLADE * arm * forward, centre + BLADE * arm * forward])
        axes.plot(*ends.T, color=style.MUTED, linewidth=3)
        axes.plot(*np.array([centre, sign * hub * forward]).T, color=style.INK, linewidth=2)
    axes.plot(*np.array([-hub * forward, hub * forward]).T, color=style.INK, linewidth=4)
    axes.plot(0, 0, "o", color=style.INK, markersize=11)
    axes.plot([-1.4 * arm, 1.4 * arm], [0, 0], color=style.FAINT, linestyle=(0, (2, 2)))
    _arrow(
        axes,
        (0, 0),
        1.35 * arm * up,
        style.VERMILLION,
        "thrust T",
        1.35 * arm * up + [0.06 * arm, 0],
    )
    _arrow(axes, (0, 0), (0, -1.1 * arm), style.INK, "weight m g", (0.08 * arm, -1.1 * arm))
    _arrow(
        axes,
        (0, 0),
        1.4 * arm * forward,
        style.BLUE,
        "x body",
        1.35 * arm * forward - [0, 0.22 * arm],
    )
    axes.text(1.05 * arm, -0.13 * arm, "θ", color=style.BLUE)
    _arrow(axes, (-1.45 * arm, 1.4 * arm), (-1.45 * arm, 0.9 * arm), style.MUTED, "z down (NED)",
           (-1.38 * arm, 1.1 * arm))  # fmt: skip


def _arrow(axes: Any, start: Any, end: Any, color: str, words: str, place: Any) -> None:
    axes.add_patch(
        FancyArrowPatch(tuple(start), tuple(end), arrowstyle="-|>", mutation_scale=13, color=color,
                        linewidth=1.6, shrinkA=0, shrinkB=0)
    )  # fmt: skip
    axes.text(*place, words, color=color, va="center")


def _turn(axes: Any, centre: tuple[float, float], radius: float, clockwise: bool) -> None:
    """Draw an arc with an arrow head: how a rotor turns, seen from above."""
    angles = np.deg2rad(np.linspace(150, 30, 30) if clockwise else np.linspace(30, 150, 30))
    x, y = centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles)
    axes.plot(x, y, color=style.MUTED, linewidth=1.2, zorder=3)
    axes.add_patch(
        FancyArrowPatch((x[-2], y[-2]), (x[-1], y[-1]), arrowstyle="-|>", mutation_scale=9,
                        color=style.MUTED, zorder=3)
    )  # fmt: skip
