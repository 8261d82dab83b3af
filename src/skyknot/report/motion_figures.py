"""Figures "position" and "velocity": where the craft is, how it is turned, how it moves."""

from __future__ import annotations

from typing import Any

from skyknot.report.base import Kind
from skyknot.report.panels import FLOWN_WORDS, overlay
from skyknot.report.reading import Reading

POSITION, ATTITUDE = ("x", "y", "z"), ("phi", "theta", "psi")
VELOCITY, BODY_RATES = ("vx", "vy", "vz"), ("p", "q", "r")

DASHES = f"dashed lines are bounds that come close, thick where they are active. {FLOWN_WORDS}"


def draw_position(figure: Any, reading: Reading) -> str:
    """Draw positions, and the angles that the model has, over time."""
    turned = [name for name in ATTITUDE if reading.has(name)]
    _two_panels(figure, reading, (POSITION, "position"), (turned, "orientation"))
    angles = "ZYX Euler angles" if len(turned) == 3 else "heading"
    below = f", and {angles}" if turned else ""
    return (
        f"Position in the NED frame with altitude drawn upward{below}. Dots are the nodes, lines"
        f" the scheme's own interpolant; {DASHES}"
    )


def draw_velocity(figure: Any, reading: Reading) -> str:
    """Draw velocities, and the body rates that the model has, over time."""
    turning = [name for name in BODY_RATES if reading.has(name)]
    _two_panels(figure, reading, (VELOCITY, "velocity"), (turning, "body rate"))
    below = ", and angular rates about the body axes" if turning else ""
    return f"Velocity over the ground, climb positive{below}; {DASHES}"


def _two_panels(figure: Any, reading: Reading, *panels: tuple[Any, str]) -> None:
    shown = [(names, title) for names, title in panels if names]
    grid = figure.subplots(len(shown), 1, sharex=True, squeeze=False).ravel()
    for axes, (names, title) in zip(grid, shown, strict=True):
        overlay(axes, [reading.state_line(name) for name in names], title)
    grid[-1].set_xlabel("time [s]")


POSITION_FIGURE = Kind(
    "position",
    "Position and orientation",
    (5.2, 4.2),
    lambda reading: reading.flies,
    draw_position,
)
VELOCITY_FIGURE = Kind(
    "velocity",
    "Velocity and body rates",
    (5.2, 4.2),
    lambda reading: reading.flies and reading.has(*VELOCITY),
    draw_velocity,
)
