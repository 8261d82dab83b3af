"""Figures "clearance" and "limits": every path constraint over time, in the open-loop flight."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.report import style
from skyknot.report.base import Kind
from skyknot.report.panels import FLOWN_WORDS, grid_of_panels, single
from skyknot.report.reading import Line, Reading

Array = NDArray[np.float64]

DASHED = ("-", (0, (5, 2)), (0, (1, 1.2)))
"""Line styles, one for every turn through the colours."""

NEAR = 1.0
"""Clearance, m, below which the axis is linear; above, it is logarithmic."""

LONG = 15
"""Letters beyond which the name of an axis takes two lines."""

TOUCHING = 1e-2
"""Clearance, m, within which a constraint counts as active."""


def constraint_lines(reading: Reading) -> list[tuple[Line, bool]]:
    """Return every path constraint over time, and whether it is a shape in space."""
    problem, nodes = reading.problem, reading.trajectory
    if problem is None or not problem.path:
        return []
    evaluate = _function(reading)
    planned = evaluate(reading.states, reading.controls, reading.times)
    at_nodes = evaluate(nodes.states, nodes.controls, nodes.times)
    flown = evaluate(reading.flown, reading.controls, reading.times)
    found = []
    for i, entry in enumerate(problem.path):
        low = -np.inf if entry.lower is None else float(entry.lower)
        high = np.inf if entry.upper is None else float(entry.upper)
        line = Line(
            entry.name, entry.unit, reading.times, planned[:, i], nodes.times, at_nodes[:, i],
            low, high, flown[:, i],
        )  # fmt: skip
        found.append((line, entry.shape is not None))
    return found


def clearances(reading: Reading) -> list[Line]:
    """Return the clearance to every obstacle and wall, m: how far each is from being touched."""
    return [
        replace(
            line,
            values=_room(line.values, line),
            node_values=_room(line.node_values, line),
            flown=_room(flown_of(line), line),
        )
        for line, shaped in constraint_lines(reading)
        if shaped
    ]


def flown_of(line: Line) -> Array:
    """Return (M,) the values in the open-loop flight; the plan's where nothing is flown."""
    return line.values if line.flown is None else line.flown


def draw_clearance(figure: Any, reading: Reading) -> str:
    """Draw the clearance to every obstacle and wall."""
    axes = figure.subplots()
    lines = clearances(reading)
    for i, line in enumerate(lines):
        look = {"color": style.SERIES[i % 6], "linestyle": DASHED[i // 6 % 3]}
        axes.plot(line.times, flown_of(line), linewidth=4.5, alpha=0.3, color=look["color"])
        axes.plot(line.times, line.values, label=line.label, **look)
        for a, b in _active(line):
            axes.axvspan(a, b, color=style.LIMIT, alpha=0.10, linewidth=0)
    axes.set_yscale("symlog", linthresh=NEAR, linscale=0.8)
    lowest = min(float(np.nanmin(flown_of(line))) for line in lines)
    axes.set_ylim(bottom=min(-0.15, 1.3 * lowest))
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}".replace("-", "−"))
    axes.axhspan(axes.get_ylim()[0], 0, color=style.LIMIT, alpha=0.12, linewidth=0)
    axes.axhline(0, color=style.LIMIT, linewidth=0.9)
    axes.set_ylabel("clearance [m]")
    axes.set_xlabel("time [s]")
    figure.legend(loc="outside upper left", ncols=4)
    line = min(lines, key=lambda entry: float(np.nanmin(flown_of(entry))))
    when = line.times[int(np.nanargmin(flown_of(line)))]
    return (
        "Room left to every obstacle and wall, beyond the distance that is to be kept, as the"
        f" constraints measure it: never more than the true one. Least: {_metres(line)} to"
        f" '{line.label}' at {when:.3g} s. Shaded while one is touched; linear below 1 m,"
        f" logarithmic above. {FLOWN_WORDS}"
    )


def draw_limits(figure: Any, reading: Reading) -> str:
    """Draw every other constraint along the way, between its bounds."""
    lines = [line for line, shaped in constraint_lines(reading) if not shaped]
    for axes, line in zip(grid_of_panels(figure, len(lines)), lines, strict=True):
        single(axes, line)
        axes.set_title(line.label[:1].upper() + line.label[1:])
        between = "\n" if len(line.label) + len(line.unit) > LONG else " "
        axes.set_ylabel(f"{line.label}{between}[{line.unit or '-'}]")
    return (
        "Limits along the way that are not bodies in space; beyond them, and while one is active,"
        f" is shaded. {FLOWN_WORDS}"
    )


def _function(reading: Reading) -> Any:
    """Return (states, controls, times) → (M, ng) path constraints."""
    problem = reading.problem
    x, u, t = ca.SX.sym("x", problem.nx), ca.SX.sym("u", problem.nu), ca.SX.sym("t")
    values = problem.parameter_values() | reading.solution.record.parameters
    p = {name: values[name] for name in problem.parameters}
    count = len(problem.path)
    g = ca.Function("path", [x, u, t], [problem.constraints_of(x, u, p, t)[:count]])

    def evaluate(states: Array, controls: Array, times: Array) -> Array:
        result: Array = g.map(len(times))(states.T, controls.T, times[None]).full().T
        return result

    return evaluate


def _room(values: Array, line: Line) -> Array:
    return np.minimum(values - line.lower, line.upper - values)


def _active(line: Line) -> list[tuple[float, float]]:
    edges = np.diff(np.concatenate([[0], (line.values < TOUCHING).astype(int), [0]]))
    starts, ends = np.flatnonzero(edges > 0), np.flatnonzero(edges < 0) - 1
    return [
        (float(line.times[a]), float(line.times[b]))
        for a, b in zip(starts, ends, strict=True)
        if b > a
    ]


def _metres(line: Line) -> str:
    least = float(np.nanmin(flown_of(line)))
    text = f"{100 * least:.2g} cm" if abs(least) < 1 else f"{least:.3g} m"
    return text.replace("-", "−")


CLEARANCE_FIGURE = Kind(
    "clearance",
    "Clearance",
    (5.2, 4.2),
    lambda reading: reading.flies and any(g.shape is not None for g in reading.problem.path),
    draw_clearance,
)
LIMITS_FIGURE = Kind(
    "limits",
    "Limits along the way",
    (5.2, 3.3),
    lambda reading: (
        reading.problem is not None and any(g.shape is None for g in reading.problem.path)
    ),
    draw_limits,
)
