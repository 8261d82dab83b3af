"""Where controls meet, leave or change their bounds: the places a mesh should have nodes at.

A control rests on a bound while the slope of the Hamiltonian pushes it there: ∂H/∂u_i, taken with
u_i on that bound, is the switching function, and changes sign where the control lets go. States
and costates have no kink at such places, so the function is smooth where the control itself is not,
and its zero is found by interpolation between the nodes.

Legend: H = ℓ + pᵀf, N segments with m control values each, τ shares of the horizon.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.tape import Tape
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.transcription.pointwise import PointFunctions
from skyknot.transcription.segment_flight import Motion

Array = NDArray[np.float64]
Places = NDArray[np.intp]

HELD = 1e-3
"""Share of the room between the bounds within which a value lies on its bound."""

WINDOW = np.arange(-2, 4)
"""Nodes around a change where the switching function is looked at."""

QUICK = 3
"""Segments within which a change of bounds counts as a jump: as far as the mesh can tell."""

HALVINGS = 40


@dataclass(frozen=True)
class Switch:
    """A place where a control meets or leaves a bound.

    Attributes
    ----------
    control : column of the control
    place : share of the horizon
    bracket : shares of the horizon between which the controls alone place it; of a jump, from
        the last place on one bound to the first on the other
    jump : whether the control goes from one bound to the other at once, as far as one can see
    """

    control: int
    place: float
    bracket: tuple[float, float]
    jump: bool


@dataclass(frozen=True)
class _Change:
    """The control rests on ``bound`` at ``held`` and does not at ``free``, the next place."""

    control: int
    bound: float
    held: float
    free: float
    guess: float
    jump: bool
    bracket: tuple[float, float]


def switches(
    problem: Problem,
    trajectory: Trajectory,
    costates: Array,
    parameters: Mapping[str, float],
    functions: PointFunctions,
) -> list[Switch]:
    """Return the switches of all controls bounded on both sides, in the order of time.

    Parameters
    ----------
    costates : (N+1, nx) at the nodes
    parameters, functions : as for ``segment_error``
    """
    changes = _all_changes(problem, trajectory)
    if not changes:
        return []
    motion = Motion(problem, trajectory, parameters, functions)
    places = _zeros(motion, costates, functions, changes)
    found = [
        Switch(c.control, float(place), c.bracket, c.jump)
        for c, place in zip(changes, places, strict=True)
    ]
    return sorted(found, key=lambda switch: switch.place)


def smeared(problem: Problem, trajectory: Trajectory) -> Array:
    """Return (N,) over which share of the horizon a jump that meets a segment is spread.

    Controls that are polynomials need a segment, or more, to get from one bound to the other. The
    equations of motion do not mind, the objective does.
    """
    nodes = _shares(trajectory)
    result = np.zeros(len(nodes) - 1)
    for change in _all_changes(problem, trajectory):
        low, high = change.bracket
        if change.jump and high > low:
            meets = (nodes[:-1] < high - 1e-12) & (nodes[1:] > low + 1e-12)
            result[meets] = np.maximum(result[meets], high - low)
    return result


def _all_changes(problem: Problem, trajectory: Trajectory) -> list[_Change]:
    changes: list[_Change] = []
    for column in range(problem.nu):
        lower, upper = problem.control_lower[column], problem.control_upper[column]
        if np.isfinite(lower) and np.isfinite(upper) and upper > lower:
            changes += _changes(trajectory, column, float(lower), float(upper))
    return changes


def _changes(trajectory: Trajectory, column: int, lower: float, upper: float) -> list[_Change]:
    """Return what the values of one control tell: from which place to which it lets go."""
    tau, values = _in_time(trajectory, column)
    share = (values - lower) / (upper - lower)
    held = np.where(share < HELD, -1, np.where(share > 1 - HELD, 1, 0))
    places = np.flatnonzero(held != 0)
    nodes = _shares(trajectory)
    found = []

    def let_go(edge: int, step: int, end: int, jump: bool) -> None:
        bound = upper if held[edge] > 0 else lower
        guess = _impulse(tau, share, edge, end) if jump else 0.5 * (tau[edge] + tau[edge + step])
        here, there = float(tau[edge]), float(tau[edge + step])
        across = float(tau[end]) if jump else there
        bracket = min(here, across), max(here, across)
        found.append(_Change(column, bound, here, there, float(guess), jump, bracket))

    for a, b in pairwise(places):
        jump = bool(held[a] != held[b] and _crossed(nodes, tau[a], tau[b]) <= QUICK)
        if held[a] != held[b] or b > a + 1:
            let_go(int(a), 1, int(b), jump)
            let_go(int(b), -1, int(a), jump)
    if len(places) and places[0] > 0:
        let_go(int(places[0]), -1, 0, False)
    if len(places) and places[-1] < len(tau) - 1:
        let_go(int(places[-1]), 1, len(tau) - 1, False)
    return found


def _in_time(trajectory: Trajectory, column: int) -> tuple[Array, Array]:
    """Return places (M,) as shares of the horizon and the control's values there.

    A held control has its value at both ends of its segment; a node's value that both segments
    share counts once.
    """
    inside = trajectory.segments
    assert inside is not None
    nodes = _shares(trajectory)
    points, values = inside.control_points, inside.control_values[:, :, column]
    if len(points) == 1:
        points, values = np.array([0.0, 1.0]), np.repeat(values, 2, axis=1)
    tau = (nodes[:-1, None] + np.diff(nodes)[:, None] * points).ravel()
    values = values.ravel()
    apart = np.append(np.diff(tau) > 1e-12, True)
    equal = np.append(np.abs(np.diff(values)) <= 1e-9 * (1 + np.abs(values[1:])), False)
    keep = apart | ~equal
    return tau[keep], values[keep]


def _crossed(nodes: Array, a: float, b: float) -> int:
    """Return how many segments lie between two places, in part or whole."""
    first = np.searchsorted(nodes, a + 1e-12, side="right")
    return int(np.searchsorted(nodes, b - 1e-12, side="right") - first) + 1


def _impulse(tau: Array, share: Array, a: int, b: int) -> float:
    """Return where a jump from place a to place b gives what the control gives between them.

    From s_a to s_b at t: ∫ s = s_a (t − t_a) + s_b (t_b − t).
    """
    a, b = min(a, b), max(a, b)
    given = np.trapezoid(share[a : b + 1], tau[a : b + 1])
    place = (given + share[a] * tau[a] - share[b] * tau[b]) / (share[a] - share[b])
    return float(np.clip(place, tau[a], tau[b]))


def _zeros(
    motion: Motion, costates: Array, functions: PointFunctions, changes: list[_Change]
) -> Array:
    """Return the places of all changes: zeros of their switching functions, else their guesses."""
    nodes = _shares(motion.trajectory)
    last = len(nodes) - 1
    near = np.array([np.searchsorted(nodes, change.held, side="right") - 1 for change in changes])
    window = np.clip(near[:, None] + WINDOW, 0, last)
    values = _slopes(motion, costates, functions, changes, window)
    places = np.empty(len(changes))
    for row, change in enumerate(changes):
        columns = np.unique(window[row], return_index=True)[1]
        tau, pushed = nodes[window[row, columns]], values[row, columns]
        places[row] = _zero(tau, pushed, change)
    return places


def _slopes(
    motion: Motion,
    costates: Array,
    functions: PointFunctions,
    changes: list[_Change],
    window: Places,
) -> Array:
    """Return (C, M): ∂H/∂u_i of each change at its nodes, positive while it pushes outward."""
    trajectory, rows = motion.trajectory, window.ravel()
    controls = np.repeat([change.control for change in changes], window.shape[1])
    bounds = np.repeat([change.bound for change in changes], window.shape[1])
    U = trajectory.controls[rows].copy()
    each = np.arange(len(rows))
    U[each, controls] = bounds
    packed = motion.packed(trajectory.states[rows], U, trajectory.times[rows])
    tape = _switching(functions.point)
    slopes = motion.at(tape, np.hstack([packed, costates[rows]]))[each, controls]
    upper = bounds == motion.problem.control_upper[controls]
    outward: Array = np.where(upper, -slopes, slopes).reshape(window.shape)
    return outward


@lru_cache(maxsize=32)
def _switching(point: ca.Function) -> Tape:
    """Return (x, u, q, τ, p, costate) → ∂H/∂u, times the duration."""
    inputs = [ca.SX.sym(point.name_in(i), *point.size_in(i)) for i in range(5)]
    L, F, _ = point(*inputs)
    costate = ca.SX.sym("costate", *F.shape)
    slope = ca.densify(ca.gradient(L + ca.dot(costate, F), inputs[1]))
    return Tape(ca.Function("switching", [*inputs, costate], [ca.cse(slope)]))


def _zero(tau: Array, pushed: Array, change: _Change) -> float:
    """Return where the push outward ends, next to the change; its guess where it does not."""
    forward = change.free > change.held
    ends = pushed[:-1] > 0 if forward else pushed[1:] > 0
    begins = pushed[1:] <= 0 if forward else pushed[:-1] <= 0
    crossings = np.flatnonzero(ends & begins)
    if len(crossings) == 0:
        return change.guess
    middles = 0.5 * (tau[crossings] + tau[crossings + 1])
    k = int(crossings[np.argmin(np.abs(middles - change.guess))])
    near = slice(max(k - 1, 0), k + 3)
    low, high = tau[k], tau[k + 1]
    scaled = (tau[near] - low) / (high - low)
    C = np.linalg.solve(np.vander(scaled), pushed[near]).tolist()  # highest power first
    left, right, rising = 0.0, 1.0, bool(pushed[k + 1] > pushed[k])
    for _ in range(HALVINGS):
        middle, value = 0.5 * (left + right), 0.0
        for c in C:
            value = value * middle + c
        left, right = (left, middle) if (value > 0) == rising else (middle, right)
    return float(low + (high - low) * 0.5 * (left + right))


def _shares(trajectory: Trajectory) -> Array:
    shares: Array = (trajectory.times - trajectory.times[0]) / trajectory.duration
    return shares
