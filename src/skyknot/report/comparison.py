"""Figure "before_after": what the first guess would have flown, against the optimum."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from skyknot.report import style
from skyknot.report.base import Kind
from skyknot.report.panels import grid_of_panels
from skyknot.report.reading import Reading
from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]

ROWS = ("x", "phi", "y", "theta", "z", "psi")
MOST_PANELS = 8

BLOWN_UP = 1e6
"""A flight beyond this many of its units is over."""


def draw_comparison(figure: Any, reading: Reading) -> str:
    """Draw the guess, the guess flown, and the optimum."""
    guess = reading.guess or straight_guess(reading)
    flown_times, flown = fly_guess(reading, guess)
    names = [name for name in ROWS if reading.flies and reading.has(name)]
    names = names or list(reading.state_names[:MOST_PANELS])
    panels = grid_of_panels(figure, len(names))
    for axes, name in zip(panels, names, strict=True):
        line, i = reading.state_line(name), reading.state_names.index(name)
        factor = _factor(reading, name)
        drawn = factor * guess.state(line.node_times)[:, i]
        axes.plot(line.node_times, drawn, color=style.MUTED, linewidth=1.1, linestyle=(0, (1, 1.5)))
        axes.plot(flown_times, factor * flown[:, i], color=style.ORANGE, linestyle=(0, (5, 2)))
        axes.plot(line.times, line.values, color=style.BLUE)
        if reading.target is not None and np.isfinite(reading.target[i]):
            axes.plot(line.times[-1], factor * reading.target[i], "D", color=style.VERMILLION,
                      markersize=4.5, clip_on=False)  # fmt: skip
        axes.set_ylabel(f"{line.label} [{line.unit or '-'}]")
        _view(axes, line.values, drawn, factor * flown[:, i])
    _legend(figure, panels[0])
    return (
        "Before and after: the first guess as drawn (dotted), what its controls do when they are"
        " flown (dashed), and the optimum (solid). Diamonds mark the goal."
    )


def straight_guess(reading: Reading) -> Trajectory:
    """Return the straight line from the first state to the target, at hover or no control."""
    times = reading.trajectory.times[[0, -1]]
    first, last = reading.trajectory.states[[0, -1]]
    target = reading.target
    end = last if target is None else np.where(np.isnan(target), last, target)
    problem = reading.problem
    control = np.clip(0.0, problem.control_lower, problem.control_upper)
    if reading.has_rotors:
        wrench = reading.control_names[0] == "T"
        vehicle = reading.vehicle
        control = vehicle.hover if wrench else vehicle.rotor_thrusts(vehicle.hover)
    return Trajectory(times, np.stack([first, end]), np.stack([control, control]))


def fly_guess(reading: Reading, guess: Trajectory) -> tuple[Array, Array]:
    """Return times and states of the flight of the guess's controls, as far as it goes."""
    problem, T = reading.problem, reading.trajectory.times
    x, u, t = ca.SX.sym("x", problem.nx), ca.SX.sym("u", problem.nu), ca.SX.sym("t")
    values = problem.parameter_values() | reading.solution.record.parameters
    p = {name: values[name] for name in problem.parameters}
    rates = ca.Function("rates", [x, u, t], [problem.rates_of(x, u, p, t)])
    share = guess.duration / reading.trajectory.duration

    def right_side(time: float, state: Array) -> Array:
        control = guess.control(guess.times[0] + share * (time - T[0]))
        return np.asarray(rates(state, control, time).full(), dtype=float).ravel()

    def over(_time: float, state: Array) -> float:
        return float(BLOWN_UP - np.max(np.abs(state)))

    over.terminal = True  # type: ignore[attr-defined]
    with np.errstate(all="ignore"):  # a guess may tumble; the picture shows how far it went
        flight = solve_ivp(
            right_side, (T[0], T[-1]), guess.states[0], t_eval=np.linspace(T[0], T[-1], 300),
            events=over, rtol=1e-6, atol=1e-8,
        )  # fmt: skip
    return flight.t, flight.y.T


def _factor(reading: Reading, name: str) -> float:
    """Return what turns a stored value into the drawn one."""
    return reading.presented(name)[0]


def _view(axes: Any, *curves: Array) -> None:
    """Show the optimum and the guess whole, and as much of the flight as fits in thrice that."""
    known = np.concatenate(curves[:2])
    low, high = float(np.min(known)), float(np.max(known))
    room = max(high - low, 1e-3)
    flown = curves[2][np.isfinite(curves[2])]
    low = max(min([low, *flown]), low - room)
    high = min(max([high, *flown]), high + room)
    margin = max(0.06 * (high - low), 1e-3)
    axes.set_ylim(low - margin, high + margin)


def _legend(figure: Any, axes: Any) -> None:
    labels = ("guess as drawn", "guess flown", "optimum", "goal")
    figure.legend(axes.lines[:4], labels[: len(axes.lines)], loc="outside upper right", ncols=4)


COMPARISON_FIGURE = Kind(
    "before_after",
    "Before and after",
    (5.2, 4.8),
    lambda reading: reading.problem is not None,
    draw_comparison,
)
