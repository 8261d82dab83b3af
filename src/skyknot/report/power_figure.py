"""Figure "power": what the rotors draw, and what that adds up to."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import cumulative_trapezoid

from skyknot.report import style
from skyknot.report.base import Kind
from skyknot.report.reading import Reading

KILO = 2e3
"""Watts above which kilowatts are drawn."""


def draw_power(figure: Any, reading: Reading) -> str:
    """Draw shaft power by momentum theory, and energy."""
    hover = reading.vehicle.hover_power
    lines = reading.rotor_lines()
    share = np.mean(
        [
            np.clip(len(lines) * line.values / reading.vehicle.weight, 0, None) ** 1.5
            for line in lines
        ],
        axis=0,
    )
    times = lines[0].times
    power = hover * share
    energy = cumulative_trapezoid(power, times, initial=0) / 3600
    factor, unit = (1e-3, "k") if np.max(power) > KILO else (1.0, "")
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(times, factor * power, color=style.BLUE, label="power")
    upper.axhline(factor * hover, color=style.MUTED, linewidth=0.9, linestyle=(0, (1, 2)))
    upper.set_ylabel(f"power [{unit}W]")
    lower.plot(times, factor * energy, color=style.GREEN)
    lower.fill_between(times, 0, factor * energy, color=style.GREEN, alpha=0.15, linewidth=0)
    lower.set_ylabel(f"energy [{unit}Wh]")
    lower.set_xlabel("time [s]")
    known = "as known" if reading.vehicle.power is not None else "ideal, by momentum theory"
    return (
        f"Shaft power, rotor by rotor thrust to the power 1.5 from the power of hovering ({known};"
        " dotted), and energy. What forward flight saves and climbing costs is left out."
        f" In all {factor * energy[-1]:.3g} {unit}Wh."
    )


POWER_FIGURE = Kind(
    "power",
    "Power and energy",
    (5.2, 4.0),
    lambda reading: reading.has_rotors and reading.vehicle.hover_power is not None,
    draw_power,
)
