"""Figure "costates": the Hamiltonian, and what a change of each state would cost.

Legend: H = ℓ + pᵀf at the nodes; p costates. "cost" is the unit of the objective.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.report import style
from skyknot.report.base import Kind
from skyknot.report.panels import ROW_HEIGHT
from skyknot.report.reading import Reading

Array = NDArray[np.float64]

TOGETHER = 3
"""States in one panel: positions, velocities, angles, rates of a craft."""

MOST_PANELS = 5


def hamiltonian(reading: Reading) -> Array:
    """Return (N+1,) H at the nodes, cost per second."""
    problem, trajectory = reading.problem, reading.trajectory
    x, u, t = ca.SX.sym("x", problem.nx), ca.SX.sym("u", problem.nu), ca.SX.sym("t")
    costate = ca.SX.sym("costate", problem.nx)
    values = problem.parameter_values() | reading.solution.record.parameters
    p = {name: values[name] for name in problem.parameters}
    rates, running = problem.rates_of(x, u, p, t), problem.running_cost_of(x, u, p, t)
    H = ca.Function("H", [x, u, costate, t], [running + ca.dot(costate, rates)])
    inputs = (trajectory.states.T, trajectory.controls.T, reading.solution.costates.T)
    result: Array = H.map(len(trajectory.times))(*inputs, trajectory.times[None]).full().ravel()
    return result


def draw_costates(figure: Any, reading: Reading) -> str:
    """Draw the Hamiltonian and the costates."""
    names = reading.state_names
    groups = [names[i : i + TOGETHER] for i in range(0, len(names), TOGETHER)][: MOST_PANELS - 1]
    rows = len(groups) + 1
    if hasattr(figure, "set_figheight"):
        figure.set_figheight(ROW_HEIGHT * rows + 0.3)
    panels = figure.subplots(rows, 1, sharex=True).ravel()
    times, values = reading.trajectory.times, hamiltonian(reading)
    panels[0].plot(times, values, "o-", color=style.INK, markersize=1.6, linewidth=1.2)
    size = max(float(np.ptp(values)), 0.02 * _running_size(reading))
    middle = 0.5 * float(values.min() + values.max())
    panels[0].set_ylim(middle - 0.8 * size, middle + 0.8 * size)
    panels[0].set_ylabel("H [cost/s]")
    for axes, group in zip(panels[1:], groups, strict=True):
        units = list(dict.fromkeys(_per(reading, name) for name in group))
        for name, color in zip(group, style.SERIES, strict=False):
            column = reading.solution.costates[:, names.index(name)]
            axes.plot(times, column, "-", color=color, label=name, linewidth=1.4)
        axes.set_ylabel(f"costate [{', '.join(units)}]")
        axes.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=3, borderaxespad=0.0)
    panels[-1].set_xlabel("time [s]")
    return _caption(reading, values)


def _caption(reading: Reading, values: Array) -> str:
    expected = ""
    if reading.problem.points:
        expected = " It jumps at waypoints, whose moments are shares of the duration."
    elif reading.problem.free_horizon:
        expected = " With a free duration and no cost at the end it is zero."
    return (
        "Hamiltonian at the nodes: constant between waypoints at an optimum of equations that do"
        f" not name the time, here within {np.ptp(values):.2g} in all.{expected} Costates by the"
        " transformed adjoint, in the states' own frame (z down): what one unit more of a state"
        " would add to the cost."
    )


def _running_size(reading: Reading) -> float:
    """Return the mean size of the running cost, cost per second."""
    return max(abs(reading.solution.objective) / reading.trajectory.duration, 1e-9)


def _per(reading: Reading, name: str) -> str:
    units = reading.solution.record.state_units
    i = reading.state_names.index(name)
    unit = units[i] if i < len(units) else ""
    return f"cost/({unit})" if "/" in unit else f"cost/{unit}" if unit else "cost"


COSTATES_FIGURE = Kind(
    "costates",
    "Hamiltonian and costates",
    (5.2, 6.0),
    lambda reading: reading.problem is not None,
    draw_costates,
)
