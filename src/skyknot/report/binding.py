"""What binds: limits that the answer touches, and what one unit more of each would save.

Legend: J objective, N segments with s state points and m control values each; μ, ζ multipliers
of constraints and bounds, positive at an upper and negative at a lower one (``skyknot.witness``).

Moving an upper bound b changes the optimum by dJ/db = −Σ μ⁺ over all points where it is asked for,
moving a lower one by dJ/db = +Σ μ⁻ (the envelope theorem: D. G. Luenberger and Y. Ye, Linear and
Nonlinear Programming, 4th ed., section 11.7). More room never costs anything, so all is told as a
saving.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.solution import Solution

Array = NDArray[np.float64]

STEP = 5e-3
"""Share of a bound by which it is moved for a trial; small, for a price holds at first order."""

STEP_FROM_ZERO = 0.05
"""The same for a bound of zero (a clearance), in its unit; at most STEP of the values' range."""

WORTH_TELLING = 1e-5
"""Least saving of a trial step, as a share of the objective."""

TOUCHED = 1e-3
"""Share of the hardest pressure on a limit below which it does not count as touched."""

MOST = 6
"""Limits told, dearest first."""


@dataclass(frozen=True)
class Confirmation:
    """The mission solved again with a limit moved.

    Attributes
    ----------
    saving : by which the objective fell
    shorter : by which the flight became shorter, s
    status : how the solve ended
    success : whether it met its tolerances
    """

    saving: float
    shorter: float
    status: str
    success: bool


@dataclass(frozen=True)
class Binding:
    """A limit that binds.

    Attributes
    ----------
    kind : "state", "control", "constraint" or "horizon"
    names : of the states, controls or constraint; several where rotors share one limit
    upper : whether it is an upper bound
    bound, unit : where it lies
    price : saving of the objective for one unit more room, at first order, ≥ 0
    step : by which a trial moves the bound, > 0, in its unit
    active : share of the horizon during which the limit is touched
    moment : when it presses most, s; None for a limit on the flight time
    """

    kind: str
    names: tuple[str, ...]
    upper: bool
    bound: float
    unit: str
    price: float
    step: float
    active: float
    moment: float | None

    @property
    def expected(self) -> float:
        """Saving of a trial step, at first order."""
        return self.price * self.step

    @property
    def moved(self) -> float:
        """Where a trial puts the bound."""
        return self.bound + self.step if self.upper else self.bound - self.step


def bindings_of(solution: Solution) -> list[Binding]:
    """Return the limits that bind, dearest first; empty without problem or multipliers."""
    if solution.problem is None or solution.witness is None or not solution.success:
        return []
    found = [*_states(solution), *_controls(solution), *_constraints(solution), *_horizon(solution)]
    least = WORTH_TELLING * max(abs(solution.objective), 1e-9)
    worth = [binding for binding in found if binding.expected > least]
    return sorted(worth, key=lambda binding: -binding.expected)[:MOST]


def _states(solution: Solution) -> Iterator[Binding]:
    problem, witness = solution.problem, _witness(solution)
    assert problem is not None  # bindings_of asks first
    multipliers = witness.state_bounds.copy()
    # What is fixed at an end is asked for there, and not by the bounds on the way.
    multipliers[0, 0, np.isfinite(problem.initial_lower) | np.isfinite(problem.initial_upper)] = 0
    multipliers[-1, -1, np.isfinite(problem.final_lower) | np.isfinite(problem.final_upper)] = 0
    for i, state in enumerate(problem.states):
        bounds = problem.state_lower[i], problem.state_upper[i]
        values = solution.states[:, i]
        pressure = Pressure(multipliers[..., i], solution.times, values)
        yield from _both("state", (state.name,), state.unit, bounds, pressure)


def _controls(solution: Solution) -> Iterator[Binding]:
    problem, witness = solution.problem, _witness(solution)
    assert problem is not None  # bindings_of asks first
    for group in _alike(problem):
        i = group[0]
        names = tuple(problem.controls[k].name for k in group)
        bounds = problem.control_lower[i], problem.control_upper[i]
        values, unit = solution.controls[:, group], problem.controls[i].unit
        pressure = Pressure(witness.control_bounds[..., group], solution.times, values)
        yield from _both("control", names, unit, bounds, pressure)


def _alike(problem: Any) -> list[list[int]]:
    """Return the controls one by one, but rotors that share their limits together."""
    names = [control.name for control in problem.controls]
    rotors = all(re.fullmatch(r"f\d+", name) for name in names)
    same = len(set(problem.control_lower)) == len(set(problem.control_upper)) == 1
    return [list(range(len(names)))] if rotors and same else [[i] for i in range(len(names))]


def _constraints(solution: Solution) -> Iterator[Binding]:
    problem, witness = solution.problem, _witness(solution)
    assert problem is not None  # bindings_of asks first
    for i, entry in enumerate(problem.constraints):
        bounds = tuple(
            fallback if bound is None else float(bound)
            for bound, fallback in ((entry.lower, -np.inf), (entry.upper, np.inf))
        )
        pressure = Pressure(witness.path[..., i], solution.times)
        yield from _both("constraint", (entry.name,), entry.unit, bounds, pressure)


def _horizon(solution: Solution) -> Iterator[Binding]:
    problem, witness = solution.problem, _witness(solution)
    assert problem is not None  # bindings_of asks first
    if problem.free_horizon:
        horizon: Any = problem.horizon
        upper = np.inf if horizon.upper is None else float(horizon.upper)
        bounds = (float(horizon.lower), upper)
        pressure = Pressure(witness.global_bounds[:1])
        yield from _both("horizon", ("flight time",), "s", bounds, pressure)


@dataclass(frozen=True)
class Pressure:
    """Multipliers of one quantity's bounds, (N, …); times (N+1,) and values of it, where known."""

    multipliers: Array
    times: Array | None = None
    values: Array | None = None

    def on(self, upper: bool) -> Array:
        """Return (N,) how hard one bound is pressed in every segment, ≥ 0."""
        pushed = np.maximum(self.multipliers if upper else -self.multipliers, 0.0)
        result: Array = pushed.reshape(len(pushed), -1).sum(axis=1)
        return result


def _both(
    kind: str, names: tuple[str, ...], unit: str, bounds: tuple[Any, ...], pressure: Pressure
) -> Iterator[Binding]:
    """Return the lower and the upper bound of one quantity, where finite, apart and pressed."""
    if bounds[0] == bounds[1]:
        return
    reach = np.inf if pressure.values is None else float(np.ptp(pressure.values))
    for upper, bound in ((False, float(bounds[0])), (True, float(bounds[1]))):
        pushed = pressure.on(upper)
        price = float(np.sum(pushed))
        if not np.isfinite(bound) or price <= 0:
            continue
        step = STEP * abs(bound) if bound else min(STEP_FROM_ZERO, max(STEP * reach, 1e-9))
        active, moment = 1.0, None
        if pressure.times is not None:
            touched = pushed > TOUCHED * np.max(pushed)
            lengths = np.diff(pressure.times)
            active = float(np.sum(lengths[touched]) / np.sum(lengths))
            moment = float(pressure.times[int(np.argmax(pushed))])
        yield Binding(kind, names, upper, bound, unit, price, step, active, moment)


def _witness(solution: Solution) -> Any:
    return solution.witness
