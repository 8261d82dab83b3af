"""Figures "rotors", "controls" and "states": single quantities with their limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from skyknot.report import style
from skyknot.report.base import Kind
from skyknot.report.panels import (
    FLOWN_WORDS,
    grid_of_panels,
    shade,
    shade_arcs,
    single,
    trace,
)
from skyknot.report.reading import Line, Reading

MOST_PANELS = 16
"""Panels beyond which a figure is no longer read."""


def draw_rotors(figure: Any, reading: Reading) -> str:
    """Draw the thrust of each rotor between its limits."""
    lines = reading.rotor_lines()
    hover = reading.vehicle.weight / len(lines)
    panels = grid_of_panels(figure, len(lines), share_y=True)
    for axes, line in zip(panels, lines, strict=True):
        trace(axes, line, style.BLUE)
        axes.axhline(hover, color=style.MUTED, linewidth=0.9, linestyle=(0, (1, 2)))
        shade_arcs(axes, line)
    shade_all(panels, lines[0].lower, lines[0].upper)
    for i, (axes, line) in enumerate(zip(panels, lines, strict=True)):
        axes.set_title(_place(reading, i, line.label))
        axes.set_ylabel("thrust [N]" if i % 2 == 0 else "")
    return (
        f"Thrust of each rotor; its limits are {lines[0].lower:.4g} and {lines[0].upper:.4g} N"
        f" (shaded beyond, and while one is active), dotted is hover.{_overload(lines)}"
    )


def _overload(lines: list[Line]) -> str:
    """Return a sentence about the rotor that is asked for most beyond its limits."""
    excess = [
        max(float(line.values.max()) - line.upper, line.lower - float(line.values.min()))
        for line in lines
    ]
    i = int(np.argmax(excess))
    if excess[i] <= 1e-3 * (lines[i].upper - lines[i].lower):
        return ""
    return (
        f" {lines[i].label.capitalize()} is asked for {excess[i]:.2g} N beyond its limits: the"
        " bounds of the problem's controls allow more than the rotors can give."
    )


def shade_all(panels: list[Any], lower: float, upper: float) -> None:
    """Shade the same limits in panels that share their axis."""
    for axes in panels:
        shade(axes, lower, upper)


def draw_controls(figure: Any, reading: Reading) -> str:
    """Draw every control between its bounds."""
    names = reading.control_names[:MOST_PANELS]
    for axes, name in zip(grid_of_panels(figure, len(names)), names, strict=True):
        single(axes, reading.control_line(name))
    return (
        "Controls as the scheme parametrises them; dots are nodes. Shaded: beyond a bound that"
        " comes close, and times when one is active."
    )


def draw_states(figure: Any, reading: Reading) -> str:
    """Draw every state between its bounds."""
    names = reading.state_names[:MOST_PANELS]
    for axes, name in zip(grid_of_panels(figure, len(names)), names, strict=True):
        single(axes, reading.state_line(name), style.GREEN)
    return (
        "States over time by the scheme's own interpolant; dots are nodes. Shaded: beyond bounds,"
        f" and times when one is active. {FLOWN_WORDS}"
    )


def _place(reading: Reading, i: int, label: str) -> str:
    x, y = reading.vehicle.rotor_positions[i, :2]
    tiny = 1e-9
    along = "front" if x > tiny else "rear" if x < -tiny else ""
    across = "right" if y > tiny else "left" if y < -tiny else ""
    return f"{label}, {' '.join(word for word in (along, across) if word)}".rstrip(", ")


ROTORS_FIGURE = Kind(
    "rotors", "Rotor thrusts", (5.2, 4.0), lambda reading: reading.has_rotors, draw_rotors
)
CONTROLS_FIGURE = Kind("controls", "Controls", (5.2, 4.0), lambda _reading: True, draw_controls)
STATES_FIGURE = Kind("states", "States", (5.2, 4.0), lambda reading: not reading.flies, draw_states)
