"""A solution as figures read it: dense in time, by name, in units people expect.

Legend: M dense times, N segments, nx states, nu controls.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.report.reflight import refly
from skyknot.solution import Solution
from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]

DENSE = 1600
"""Times at which a trajectory is read for drawing, about."""

SYMBOLS = {
    "phi": "roll φ",
    "theta": "pitch θ",
    "psi": "yaw ψ",
    "x": "north x",
    "y": "east y",
    "z": "altitude −z",
    "vx": "north vx",
    "vy": "east vy",
    "vz": "climb −vz",
    "T": "thrust T",
    "tau_x": "roll torque τx",
    "tau_y": "pitch torque τy",
    "tau_z": "yaw torque τz",
    "p": "roll rate p",
    "q": "pitch rate q",
    "r": "yaw rate r",
}
"""What people call the states and controls of a craft; downward quantities are drawn upward."""

UPWARD = ("z", "vz")
ANGULAR = {"rad": "deg", "rad/s": "deg/s"}


@dataclass(frozen=True)
class Line:
    """One quantity over time, ready to draw.

    Attributes
    ----------
    label, unit : name and unit for axes and legends; a label ends with its symbol
    times, values : (M,) dense
    node_times, node_values : (N+1,) at the nodes
    lower, upper : bounds in the same unit, ±inf where free
    flown : (M,) the same in the open-loop flight, NaN once lost; None where nothing is flown
    """

    label: str
    unit: str
    times: Array
    values: Array
    node_times: Array
    node_values: Array
    lower: float
    upper: float
    flown: Array | None = None

    @property
    def symbol(self) -> str:
        """The last word of the label: "τx" of "roll torque τx"."""
        return self.label.rpartition(" ")[2]

    @property
    def words(self) -> str:
        """The label without its symbol; empty when it is one word."""
        return self.label.rpartition(" ")[0]


class Reading:
    """A solution with everything a figure asks for.

    Parameters
    ----------
    solution : solved or not; from ``solve`` or read from a file
    guess : where the search started, for comparison; a straight line when None
    """

    def __init__(self, solution: Solution, guess: Trajectory | None = None) -> None:
        self.solution, self.trajectory, self.guess = solution, solution.trajectory, guess
        self.problem: Any = solution.problem
        self.vehicle: Any = getattr(solution.problem, "vehicle", None)
        self.state_names = self._names("state")
        self.control_names = self._names("control")

    @cached_property
    def times(self) -> Array:
        """(M,) dense times, s: every segment from its start to just before its end."""
        nodes = self.trajectory.times
        share = np.linspace(0.0, 1.0 - 1e-9, max(4, DENSE // (len(nodes) - 1)))
        inside = nodes[:-1, None] + np.diff(nodes)[:, None] * share
        return np.append(inside.ravel(), nodes[-1])

    @cached_property
    def states(self) -> Array:
        """(M, nx) states at the dense times, by the trajectory's own interpolant."""
        return self.trajectory.state(self.times)

    @cached_property
    def controls(self) -> Array:
        """(M, nu) controls at the dense times."""
        return self.trajectory.control(self.times)

    @cached_property
    def flown(self) -> Array | None:
        """(M, nx) states of the controls flown open loop, NaN once lost; None without equations."""
        if self.problem is None:
            return None
        return refly(self.problem, self.solution.record.parameters, self.trajectory, self.times)

    def has(self, *names: str) -> bool:
        """Whether all these states exist."""
        return set(names) <= set(self.state_names)

    def columns(self, values: Array, *names: str) -> Array:
        """Return (…, len(names)) columns of states by name."""
        return values[..., [self.state_names.index(name) for name in names]]

    @property
    def flies(self) -> bool:
        """Whether states x, y, z are the position of a vehicle, NED."""
        return self.vehicle is not None and self.has("x", "y", "z")

    def state_line(self, name: str) -> Line:
        """Return a state over time; of a vehicle, upward and in degrees."""
        i = self.state_names.index(name)
        factor, unit, label = self.presented(name)
        low, high = self._bounds("state", i)
        line = self._line(label, unit, factor, self.states, self.trajectory.states, i, low, high)
        flown = None if self.flown is None else factor * self.flown[:, i]
        return replace(line, flown=flown)

    def control_line(self, name: str) -> Line:
        """Return a control over time."""
        i = self.control_names.index(name)
        low, high = self._bounds("control", i)
        label = SYMBOLS.get(name, name) if self.flies else name
        unit = self._unit("control", i)
        nodes = self.trajectory.controls
        return self._line(label, unit, 1.0, self.controls, nodes, i, low, high)

    def rotor_lines(self) -> list[Line]:
        """Return the thrust of every rotor, with its limits; empty where there are no rotors."""
        if not self.has_rotors:
            return []
        vehicle, nodes = self.vehicle, self.trajectory.controls
        wrench = self.control_names[0] == "T"
        dense = np.asarray(vehicle.rotor_thrusts(self.controls)) if wrench else self.controls
        at_nodes = np.asarray(vehicle.rotor_thrusts(nodes)) if wrench else nodes
        low, high = vehicle.thrust_min, vehicle.thrust_max
        return [
            self._line(f"rotor {i + 1}", "N", 1.0, dense, at_nodes, i, low, high)
            for i in range(dense.shape[1])
        ]

    @property
    def has_rotors(self) -> bool:
        """Whether the controls are a wrench, or thrusts, of a vehicle with rotors."""
        if self.vehicle is None:
            return False
        thrusts = tuple(f"f{i + 1}" for i in range(self.vehicle.allocation.rotor_count))
        return self.control_names in (("T", "tau_x", "tau_y", "tau_z"), thrusts)

    @property
    def target(self) -> Array | None:
        """(nx,) state aimed at, NaN where free; None when nothing is known."""
        if self.problem is None:
            return None
        if self.problem.target is not None:
            return np.asarray(self.problem.target, dtype=float)
        low, high = self.problem.final_lower, self.problem.final_upper
        fixed = np.where(low == high, low, np.nan)
        return None if np.all(np.isnan(fixed)) else fixed

    def presented(self, name: str) -> tuple[float, str, str]:
        """Return factor, unit and label with which a state is drawn."""
        unit = self._unit("state", self.state_names.index(name))
        if not self.flies:
            return 1.0, unit, name
        factor = -1.0 if name in UPWARD else 1.0
        if unit in ANGULAR:
            factor, unit = factor * 180 / np.pi, ANGULAR[unit]
        return factor, unit, SYMBOLS.get(name, name)

    def _line(
        self,
        label: str,
        unit: str,
        factor: float,
        dense: Array,
        nodes: Array,
        column: int,
        lower: float,
        upper: float,
    ) -> Line:
        ends = sorted((factor * lower, factor * upper))
        return Line(
            label,
            unit,
            self.times,
            factor * dense[:, column],
            self.trajectory.times,
            factor * nodes[:, column],
            ends[0],
            ends[1],
        )

    def _names(self, kind: str) -> tuple[str, ...]:
        stored: tuple[str, ...] = getattr(self.trajectory, f"{kind}_names")
        count = getattr(self.trajectory, f"{kind}s").shape[1]
        if stored:
            return stored
        if self.problem is not None:
            return tuple(getattr(self.problem, f"{kind}_names"))
        return tuple(f"{kind} {i + 1}" for i in range(count))

    def _unit(self, kind: str, i: int) -> str:
        units = getattr(self.solution.record, f"{kind}_units")
        return units[i] if i < len(units) else ""

    def _bounds(self, kind: str, i: int) -> tuple[float, float]:
        if self.problem is None:
            return -np.inf, np.inf
        low, high = getattr(self.problem, f"{kind}_lower"), getattr(self.problem, f"{kind}_upper")
        return float(low[i]), float(high[i])
