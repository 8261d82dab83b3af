"""A problem as direct multiple shooting with RK4, in the shape that Fatrop reads stage by stage.

Legend: N segments of length h = T/N, x_k state at node k (the free duration T is one more state
that does not change), u_k control held in segment k.

    minimise    Σ h ℓ(x_k, u_k) + M(x_N)        (the plain sum; the integral has no use in timing)
    subject to  x_{k+1} − RK4(x_k, u_k) = 0,  path constraints and bounds at the nodes

Constraints come node by node, the gap first: L. Vanroye, A. Sathya, J. De Schutter and W. Decré,
"FATROP: A fast constrained optimal control problem solver", IROS 2023.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.problem.constraints import PathConstraint, PointConstraint
from skyknot.problem.problem import Parameters, Problem, call
from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ShootingProgram:
    """``{x, f, g}`` with bounds, start, and which constraints are equalities."""

    graph: dict[str, ca.MX]
    start: Array
    lower: Array
    upper: Array
    g_lower: Array
    g_upper: Array

    @property
    def equality(self) -> list[bool]:
        """One mark for each constraint."""
        return [bool(same) for same in self.g_lower == self.g_upper]


@dataclass
class _Rows:
    """Constraint expressions and their bounds, in order."""

    expressions: list[ca.MX] = field(default_factory=list)
    lower: list[Array] = field(default_factory=list)
    upper: list[Array] = field(default_factory=list)

    def add(self, expression: ca.MX, lower: Array, upper: Array) -> None:
        """Append a matrix of rows by nodes, with bounds of one node."""
        self.expressions.append(ca.vec(expression))
        self.lower.append(np.tile(lower, expression.shape[1]))
        self.upper.append(np.tile(upper, expression.shape[1]))


def shooting_program(problem: Problem, N: int, guess: Trajectory) -> ShootingProgram:
    """Return the shooting program of N segments started from ``guess``.

    Raises
    ------
    UserError
        When the problem has rate bounds or free parameters, which this form cannot say.
    """
    _check(problem)
    nx, nu, free = problem.nx, problem.nu, int(problem.free_horizon)
    size = nx + free + nu
    W = ca.MX.sym("w", N * size + nx + free)
    stages = ca.reshape(W[: N * size], size, N)
    X, U, last = stages[: nx + free, :], stages[nx + free :, :], W[N * size :]
    tau = np.arange(N)[None, :] / N
    stage, path, end = _functions(problem, N)
    reached, cost = stage.map(N)(X, U, tau)
    rows = _constraints(problem, (X, U, last), reached, path, tau)
    lower, upper = _bounds(problem, N)
    return ShootingProgram(
        graph={"x": W, "f": ca.sum2(cost) + end(last), "g": ca.vertcat(*rows.expressions)},
        start=np.clip(_start(problem, N, guess), lower, upper),
        lower=lower,
        upper=upper,
        g_lower=np.concatenate(rows.lower),
        g_upper=np.concatenate(rows.upper),
    )


def _check(problem: Problem) -> None:
    rates = np.isfinite(problem.rate_lower) | np.isfinite(problem.rate_upper)
    if np.any(rates) or problem.free_parameters:
        raise UserError(
            "The shooting form has no rate bounds and no free parameters.",
            where=problem.name,
            found="rate bounds" if np.any(rates) else "free parameters",
            expected="a problem without them",
            do="Compare with the other solvers only.",
        )


def _functions(problem: Problem, N: int) -> tuple[ca.Function, ca.Function, ca.Function]:
    """Return (x, u, τ) → (next x, h ℓ), (x, u, τ) → path, and x_N → M."""
    nx, free = problem.nx, problem.free_horizon
    x, u, tau = ca.SX.sym("x", nx + int(free)), ca.SX.sym("u", problem.nu), ca.SX.sym("tau")
    T = x[nx] if free else ca.SX(problem.duration_guess)
    h, p = T / N, Parameters(problem.parameter_values())

    def rates(state: ca.SX, share: float) -> ca.SX:
        return ca.SX(problem.rates_of(state, u, p, T * (tau + share / N)))

    start = x[:nx]
    k1 = rates(start, 0.0)
    k2 = rates(start + h / 2 * k1, 0.5)
    k3 = rates(start + h / 2 * k2, 0.5)
    k4 = rates(start + h * k3, 1.0)
    after = start + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    reached = ca.vertcat(after, T) if free else after
    cost = h * problem.running_cost_of(start, u, p, T * tau)
    g = [_value(entry, start, u, p, T * tau) for entry in problem.path]
    M = ca.SX(problem.terminal_cost_of(start, p, T))
    return (
        ca.Function("stage", [x, u, tau], [reached, cost]),
        ca.Function("path", [x, u, tau], [ca.vertcat(*g) if g else ca.SX(0, 1)]),
        ca.Function("end", [x], [M]),
    )


def _value(entry: PathConstraint | PointConstraint, x: Any, u: Any, p: Any, t: Any) -> Any:
    return call(entry.function, x, u, p=p, t=t)


def _constraints(
    problem: Problem,
    places: tuple[ca.MX, ca.MX, ca.MX],
    reached: ca.MX,
    path: ca.Function,
    tau: Array,
) -> _Rows:
    X, U, last = places
    N, nx, rows = X.shape[1], problem.nx, _Rows()
    gap = ca.horzcat(X[:, 1:], last) - reached
    low = np.array([-np.inf if e.lower is None else e.lower for e in problem.path])
    high = np.array([np.inf if e.upper is None else e.upper for e in problem.path])
    block = ca.vertcat(gap, path.map(N)(X, U, tau))
    bounds = np.append(np.zeros(gap.shape[0]), low), np.append(np.zeros(gap.shape[0]), high)
    extras = _points(problem, X, U, last)
    first = problem.initial_lower == problem.initial_upper
    extras.setdefault(0, _Rows()).add(
        X[[int(i) for i in np.flatnonzero(first)], 0],
        problem.initial_lower[first],
        problem.initial_upper[first],
    )
    done = 0
    for k in sorted(key for key in extras if key < N):
        rows.add(block[:, done : k + 1], *bounds)
        _append(rows, extras[k])
        done = k + 1
    if done < N:
        rows.add(block[:, done:], *bounds)
    fixed = problem.final_lower == problem.final_upper
    ends = last[[int(i) for i in np.flatnonzero(fixed)]]
    rows.add(ends, problem.final_lower[fixed], problem.final_upper[fixed])
    settled = _of_states_alone(path, nx + int(problem.free_horizon))
    if settled:
        rows.add(path(last, U[:, -1], 1.0)[settled], low[settled], high[settled])
    if N in extras:
        _append(rows, extras[N])
    return rows


def _points(problem: Problem, X: ca.MX, U: ca.MX, last: ca.MX) -> dict[int, _Rows]:
    """Return point constraints by the nearest node."""
    N, found = X.shape[1], dict[int, _Rows]()
    p = Parameters(problem.parameter_values())
    for entry in problem.points:
        k = round(entry.at * N)
        x, u = (last, U[:, -1]) if k == N else (X[:, k], U[:, k])
        T = x[problem.nx] if problem.free_horizon else problem.duration_guess
        value = ca.MX(_value(entry, x, u, p, T * entry.at))
        low = -np.inf if entry.lower is None else entry.lower
        high = np.inf if entry.upper is None else entry.upper
        found.setdefault(k, _Rows()).add(value, np.array([low]), np.array([high]))
    return found


def _append(rows: _Rows, others: _Rows) -> None:
    rows.expressions += others.expressions
    rows.lower += others.lower
    rows.upper += others.upper


def _of_states_alone(path: ca.Function, size: int) -> list[int]:
    """Return the rows of the path constraints that no control enters."""
    x, u = ca.SX.sym("x", size), ca.SX.sym("u", path.size1_in(1))
    with_control = set(ca.jacobian(path(x, u, 0.5), u).sparsity().row())
    return [i for i in range(path.size1_out(0)) if i not in with_control]


def _bounds(problem: Problem, N: int) -> tuple[Array, Array]:
    free = [problem.horizon] if problem.free_horizon else []
    sides = []
    for sign, side in ((-1, "lower"), (1, "upper")):
        states, controls = getattr(problem, f"state_{side}"), getattr(problem, f"control_{side}")
        durations = [getattr(entry, side) for entry in free]
        stage = np.concatenate([states, np.full(len(free), sign * np.inf), controls])
        values = np.append(np.tile(stage, N), stage[: problem.nx + len(free)])
        pick = np.minimum if side == "upper" else np.maximum
        for place, asked in ((0, "initial"), (N * len(stage), "final")):
            here = slice(place, place + problem.nx)
            values[here] = pick(values[here], getattr(problem, f"{asked}_{side}"))
            # what is fixed stands among the constraints
            fixed = getattr(problem, f"{asked}_lower") == getattr(problem, f"{asked}_upper")
            values[here][fixed] = sign * np.inf
        values[problem.nx : problem.nx + len(free)] = durations
        sides.append(values)
    return sides[0], sides[1]


def _start(problem: Problem, N: int, guess: Trajectory) -> Array:
    times = guess.times[0] + guess.duration * np.arange(N + 1) / N
    states, controls = guess.state(times), guess.control(times[:-1])
    if problem.free_horizon:
        states = np.column_stack([states, np.full(N + 1, guess.duration)])
    start: Array = np.append(np.hstack([states[:-1], controls]).ravel(), states[-1])
    return start
