"""The arcs of an answer: where each control rests on a bound, and a phase for each.

A mesh can only come near a place where a control enters a singular arc: the switching function has
a double zero there. So the arcs that an answer shows are made phases, each of free length, with
the controls that rest on a bound put there; what is solved is smooth in every phase, and the
lengths are unknowns like others. Nothing about the arcs is told by hand. The idea of
E. R. Pager & A. V. Rao, arXiv 2104.12247, who find structure and switches in the same two steps.

Legend: t time, T duration, P number of phases; phase k is k < t ≤ k + 1 in its own clock.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from skyknot.bank.base import Array
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory

ON_A_BOUND = 0.02
"""Share of the room between its bounds within which a control lies on a bound."""

A_JUMP = 0.02
"""Share of the horizon within which a control goes from one bound to the other in a jump."""

INSIDE = np.array([1e-6, *np.linspace(0.1, 0.9, 9), 1 - 1e-6])
"""Where a control is looked at, as shares of a segment."""

LOWER, BETWEEN, UPPER = -1, 0, 1

AROUND = 1e-6
"""By how much a point may lie behind the end of its phase."""


@dataclass(frozen=True)
class Change:
    """A control that changes from one arc to the next.

    Attributes
    ----------
    time : s
    control : column of the control
    before, after : LOWER, BETWEEN or UPPER
    """

    time: float
    control: int
    before: int
    after: int


def changes(problem: Problem, trajectory: Trajectory) -> list[Change]:
    """Return where a control jumps between its bounds, or leaves or meets one, in order of time.

    Read off the controls alone. Values between the bounds for less than ``A_JUMP`` of the horizon
    belong to the jump around them, whose time is that of half the way; longer ones are an arc of
    their own. Controls without two finite bounds have none.
    """
    nodes = trajectory.times
    t = (nodes[:-1, None] + np.diff(nodes)[:, None] * INSIDE).ravel()
    U = trajectory.control(t)
    found: list[Change] = []
    for i in _bounded(problem):
        lower, upper = problem.control_lower[i], problem.control_upper[i]
        share = (U[:, i] - lower) / (upper - lower)
        found += _changes(i, t, share, A_JUMP * trajectory.duration)
    return sorted(found, key=lambda change: change.time)


def switching_times(problem: Problem, trajectory: Trajectory) -> Array:
    """Return the times of all changes, s."""
    return np.array([change.time for change in changes(problem, trajectory)])


def _bounded(problem: Problem) -> list[int]:
    bounded = np.isfinite(problem.control_lower) & np.isfinite(problem.control_upper)
    return [int(i) for i in np.flatnonzero(bounded)]


def _changes(control: int, t: Array, share: Array, shortest: float) -> list[Change]:
    """Return the changes of one control, given as shares of the room between its bounds."""
    arcs = _arcs(t, share, shortest)
    found = []
    for (kind, _, end), (next_kind, start, _) in pairwise(arcs):
        if kind == next_kind:
            continue
        time = 0.5 * (t[end] + t[start])
        if kind and next_kind:
            window = slice(end, start + 1)
            time = np.interp(0, kind * (0.5 - share[window]), t[window])
        found.append(Change(float(time), control, kind, next_kind))
    return found


def _arcs(t: Array, share: Array, shortest: float) -> list[tuple[int, int, int]]:
    """Return kind, first and last sample of every arc; short ones between the bounds left out."""
    kinds = np.where(share > 1 - ON_A_BOUND, UPPER, np.where(share < ON_A_BOUND, LOWER, BETWEEN))
    cuts = np.flatnonzero(np.diff(kinds)) + 1
    runs = [
        (int(kinds[first]), int(first), int(last) - 1)
        for first, last in pairwise([0, *cuts, len(t)])
    ]
    return [run for run in runs if run[0] != BETWEEN or t[run[2]] - t[run[1]] >= shortest]


@dataclass(frozen=True)
class Phased:
    """A problem with a phase for every arc.

    Attributes
    ----------
    problem : horizon P; parameters "length 0", …, s
    guess : the answer it came from, in the clock of the phases
    phases : P
    """

    problem: Problem
    guess: Trajectory
    phases: int


def phased(problem: Problem, answer: Trajectory) -> Phased:
    """Return the problem with a phase of free length for every arc that an answer shows.

    Parameters
    ----------
    problem : without parameters and without functions of time
    answer : states, controls and times of a solution
    """
    found = changes(problem, answer)
    ends = np.array([*(change.time for change in found), answer.times[-1]])
    lengths = np.diff([answer.times[0], *ends])
    kinds = _kinds(problem, found)
    P, names = len(ends), [f"length_{k}" for k in range(len(ends))]

    def length(p: Any, t: Any) -> Any:
        return _of_phase([p[name] for name in names], t)

    def held(u: Any, t: Any) -> list[Any]:
        values = [[_value(problem, i, kind[i], u[i]) for kind in kinds] for i in range(problem.nu)]
        return [_of_phase(each, t) for each in values]

    def dynamics(x: Any, u: Any, p: Any, t: Any) -> list[Any]:
        rates = ca.vertcat(*_listed(problem.dynamics(x, held(u, t))))
        return [length(p, t) * rates[i] for i in range(problem.nx)]

    stated = Problem(
        f"{problem.name}, in {P} phases",
        problem.states,
        problem.controls,
        dynamics,
        horizon=float(P),
        initial=_ends(problem.initial_lower, problem.initial_upper),
        final=_ends(problem.final_lower, problem.final_upper),
        running_cost=_running(problem, held, length),
        terminal_cost=_terminal(problem, names),
        state_bounds=_pairs(problem.state_lower, problem.state_upper),
        control_bounds=_pairs(problem.control_lower, problem.control_upper),
        path=problem.path,
        points=problem.points,
        parameters={
            name: Free(0.2 * each, 5 * each, each)
            for name, each in zip(names, lengths, strict=True)
        },
    )
    return Phased(stated, _in_its_clock(answer, ends), P)


def _kinds(problem: Problem, found: list[Change]) -> list[list[int]]:
    """Return what every control does in every phase."""
    now = [BETWEEN] * problem.nu
    for i in _bounded(problem):
        own = [change.before for change in found if change.control == i]
        now[i] = own[0] if own else BETWEEN
    kinds = [list(now)]
    for change in found:
        now[change.control] = change.after
        kinds.append(list(now))
    return kinds


def _value(problem: Problem, i: int, kind: int, free: Any) -> Any:
    if kind == BETWEEN:
        return free
    return float(problem.control_upper[i] if kind == UPPER else problem.control_lower[i])


def _of_phase(values: list[Any], t: Any) -> Any:
    """Return the value of the phase that a time lies in."""
    chosen = values[-1]
    for k in range(len(values) - 2, -1, -1):
        chosen = ca.if_else(t <= k + 1 + AROUND, values[k], chosen)
    return chosen


def _listed(values: Any) -> list[Any]:
    return list(values) if isinstance(values, list | tuple) else list(ca.vertsplit(values))


def _running(
    problem: Problem, held: Callable[[Any, Any], list[Any]], length: Callable[[Any, Any], Any]
) -> Callable[..., Any] | None:
    cost = problem.running_cost
    if cost is None:
        return None
    return lambda x, u, p, t: length(p, t) * cost(x, held(u, t))


def _terminal(problem: Problem, names: list[str]) -> Callable[..., Any] | None:
    cost = problem.terminal_cost
    if cost is None:
        return None
    return lambda x, tf, p: cost(x, sum(p[name] for name in names))


def _ends(lower: Array, upper: Array) -> list[tuple[float | None, float | None]]:
    return list(zip(_open(lower), _open(upper), strict=True))


def _pairs(lower: Array, upper: Array) -> tuple[list[float | None], list[float | None]]:
    return _open(lower), _open(upper)


def _open(values: Array) -> list[float | None]:
    """Return bounds with None where they are infinite."""
    return [float(value) if np.isfinite(value) else None for value in values]


def _in_its_clock(answer: Trajectory, ends: Array) -> Trajectory:
    """Return an answer with its arcs stretched to one unit each."""
    clock = np.linspace(0.0, len(ends), 20 * len(ends) + 1)
    t = np.interp(clock, np.arange(len(ends) + 1), [answer.times[0], *ends])
    return Trajectory(clock, answer.state(t), answer.control(t))
