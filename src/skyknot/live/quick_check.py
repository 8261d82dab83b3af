"""The part of the certificate that is quick enough for every re-plan.

The checks are the certificate's own; only the equations are compiled once, with the parameters as
inputs, instead of once for each answer. Flight, costates and optimality are left to the full one.
"""

from __future__ import annotations

import copy
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.problem.problem import Problem, symbols
from skyknot.trajectory import Trajectory
from skyknot.verification import Certificate, Limits, ends, motion, room
from skyknot.verification.equations import Equations
from skyknot.verification.evidence import Evidence, Samples

Array = NDArray[np.float64]

QUICK = (
    ends.horizon,
    ends.ends,
    ends.points,
    room.state_bounds,
    room.control_bounds,
    room.path,
    motion.defects,
    motion.interpolant,
    room.states_between,
    room.controls_between,
    room.path_between,
)
"""Ends, bounds, path constraints and equations at the nodes; bounds and path between them."""

NOTE = "Checked quickly: the flight, the costates and optimality were not looked at."


class SharedEquations(Equations):
    """Equations compiled once for all values of the parameters."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem, {})
        p, x, u = symbols(tuple(problem.parameters)), ca.SX.sym("x", problem.nx), None
        u, t = ca.SX.sym("u", problem.nu), ca.SX.sym("t")
        values = ca.vertcat(*p.values())
        rates = ca.densify(problem.rates_of(x, u, p, t))
        every = ca.densify(ca.SX(problem.constraints_of(x, u, p, t)))
        along = len(problem.path)
        inputs = [x, u, t, values]
        self._rates = ca.Function("rates", inputs, [ca.cse(rates)])
        self._path = ca.Function("path", inputs, [ca.cse(every[:along])])
        self._points = ca.Function("points", inputs, [ca.cse(every[along:])])
        self._mapped: dict[tuple[str, int], Any] = {}
        self._values = np.array(list(problem.parameter_values().values()), dtype=float)

    def of(self, problem: Problem) -> SharedEquations:
        """Return the equations of a problem that differs in numbers only."""
        other = copy.copy(self)
        values = problem.parameter_values()
        other.problem = problem
        other.parameters = type(self.parameters)({k: ca.SX(v) for k, v in values.items()})
        other._values = np.array(list(values.values()), dtype=float)
        return other

    def _at(self, function: Any, X: Array, U: Array, t: Array) -> Array:  # type: ignore[override]
        key = function.name(), len(t)
        if key not in self._mapped:  # the parameters are the same at all points
            self._mapped[key] = function.map(function.name(), "serial", len(t), [3], [])
        result = self._mapped[key](X.T, U.T, t[None, :], self._values)
        return np.asarray(result.full(), dtype=float).T


class QuickEvidence(Evidence):
    """Evidence without the equations between the nodes, which no quick check looks at."""

    @cached_property
    def samples(self) -> Samples:
        """The trajectory between its nodes; its rates there are left out, as NaN."""
        tau = (np.arange(self.density) + 0.5) / self.density
        times = (self.times[:-1, None] + self.lengths[:, None] * tau).ravel()
        X, U = self.trajectory.state(times), self.trajectory.control(times)
        path, left_out = self.equations.path(X, U, times), np.full_like(X, np.nan)
        return Samples(times, X, U, state_rates=left_out, rates=left_out, path=path)


class QuickCheck:
    """Judges plans of one mission, whatever its numbers."""

    def __init__(self, problem: Problem) -> None:
        self._equations = SharedEquations(problem)

    def equations(self, problem: Problem) -> SharedEquations:
        """Return the compiled equations at a problem's numbers."""
        return self._equations.of(problem)

    def __call__(self, problem: Problem, trajectory: Trajectory, limits: Limits) -> Certificate:
        """Return the quick part of the certificate of a trajectory."""
        evidence = QuickEvidence(problem, trajectory, {}, equations=self.equations(problem))
        found = [check(evidence, limits) for check in QUICK]
        checks = {check.name: check for check in found if check is not None}
        return Certificate(problem.name, checks, (NOTE,))
