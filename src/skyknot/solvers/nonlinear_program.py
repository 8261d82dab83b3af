"""A program as one CasADi expression graph, for general-purpose solvers.

Point functions are written once and mapped over the points, so the graph stays small. In the
compressed form interior states are expressions (their row solved for them) instead of unknowns.

Legend: as in kernel/program.py.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.kernel.evaluation import complete_fixed, evaluate, gradient
from skyknot.kernel.program import Multipliers, Program

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NonlinearProgram:
    """``{x, f, g}`` with bounds, and the way back to the program's multipliers."""

    program: Program
    graph: dict[str, ca.MX]
    kept: NDArray[np.intp]
    scale: Array
    lower: Array
    upper: Array
    g_lower: Array
    g_upper: Array
    path_rows: NDArray[np.intp]
    interior_bound_rows: NDArray[np.intp]
    rate_rows: tuple[NDArray[np.intp], NDArray[np.intp]]
    full_z: ca.Function

    def lifted(self, y: Array, lam_x: Array, lam_g: Array) -> tuple[Array, Multipliers]:
        """Return z and multipliers of the separated program."""
        program = self.program
        nx = program.layout.nx
        z = np.clip(np.asarray(self.full_z(y)).ravel(), program.lower, program.upper)
        m = program.empty_multipliers()
        rows = program.C.shape[0]
        kept_rows = [rows - 1] if program.compressed else list(range(rows))
        size = program.segments * len(kept_rows) * nx
        m.defects[:, kept_rows] = lam_g[:size].reshape(program.segments, len(kept_rows), nx)
        path = size + len(self.path_rows)
        m.path.ravel()[self.path_rows] = lam_g[size:path]
        inner = path + len(self.interior_bound_rows)
        m.bounds[self.kept] = lam_x / self.scale
        m.bounds[self.interior_bound_rows] = lam_g[path:inner]
        for part in self.rate_rows:
            m.rates[part] += lam_g[inner : inner + len(part)]
            inner += len(part)
        if program.compressed:
            _recover_interior_rows(program, m, z)
        complete_fixed(program, z, m)
        return z, m

    def lowered(self, m: Multipliers) -> Array:
        """Return the graph's constraint multipliers for those of the separated program."""
        rows = [-1] if self.program.compressed else slice(None)
        above, below = self.rate_rows
        rates = [m.rates[above]]
        if len(below):
            rates = [np.maximum(m.rates[above], 0), np.minimum(m.rates[below], 0)]
        parts = [m.defects[:, rows].ravel(), m.path.ravel()[self.path_rows]]
        return np.concatenate([*parts, m.bounds[self.interior_bound_rows], *rates])


def nonlinear_program(program: Program) -> NonlinearProgram:
    """Return the program as one CasADi graph."""
    layout = program.layout
    interior = layout.states_at(layout.state[:, 1:-1]).ravel()
    dropped = interior if program.compressed else np.empty(0, dtype=np.intp)
    kept = np.setdiff1d(np.arange(layout.size), dropped)
    scale = program.scales[kept]
    y = ca.MX.sym("z", len(kept))
    unscaled = ca.DM(scale) * y
    z = _compressed(program, unscaled, kept) if program.compressed else unscaled
    L, F, g = _mapped(program, z)
    X = [_columns(z, layout.states_at(layout.state[:, j])) for j in range(program.C.shape[1])]
    defects = _defect_rows(program, X, F)
    objective = L @ ca.DM(program.point_cost) + program.terminal(
        X[-1][:, -1], _entries(z, layout.global_positions)
    )
    bounded = np.isfinite(program.path_lower) | np.isfinite(program.path_upper)
    path_rows = np.flatnonzero(bounded.ravel())
    interior_rows = dropped[
        np.isfinite(program.lower[dropped]) | np.isfinite(program.upper[dropped])
    ]
    rates, rate_bounds, rate_rows = _rate_part(program, z)
    return NonlinearProgram(
        program=program,
        graph={
            "x": y,
            "f": objective,
            "g": ca.vertcat(
                ca.vec(defects), _entries(ca.vec(g), path_rows), _entries(z, interior_rows), rates
            ),
        },
        kept=kept,
        scale=scale,
        lower=program.lower[kept] / scale,
        upper=program.upper[kept] / scale,
        g_lower=np.concatenate(
            [
                np.zeros(defects.numel()),
                program.path_lower.ravel()[path_rows],
                program.lower[interior_rows],
                rate_bounds[0],
            ]
        ),
        g_upper=np.concatenate(
            [
                np.zeros(defects.numel()),
                program.path_upper.ravel()[path_rows],
                program.upper[interior_rows],
                rate_bounds[1],
            ]
        ),
        path_rows=path_rows,
        interior_bound_rows=interior_rows,
        rate_rows=rate_rows,
        full_z=ca.Function("full_z", [y], [z]),
    )


def _entries(vector: ca.MX, positions: NDArray[np.intp]) -> ca.MX:
    return vector[[int(p) for p in positions]] if len(positions) else ca.MX(0, 1)


def _columns(z: ca.MX, positions: NDArray[np.intp]) -> ca.MX:
    """Return z at (M, n) positions as an (n, M) matrix."""
    return ca.reshape(_entries(z, positions.ravel()), positions.shape[1], positions.shape[0])


def _mapped(program: Program, z: ca.MX) -> tuple[ca.MX, ca.MX, ca.MX]:
    layout, P = program.layout, len(program.point_state)
    X = _columns(z, layout.states_at(program.point_state))
    U = _point_controls(program, z, np.arange(P))
    q = ca.repmat(_entries(z, layout.global_positions), 1, P)
    L, F, g = program.point.map(P)(X, U, q, program.point_time[None, :])
    return L, F, g


def _point_controls(program: Program, z: ca.MX, points: NDArray[np.intp]) -> ca.MX:
    layout, weights = program.layout, program.point_weights[points]
    total = ca.MX(layout.nu, len(points))
    for i in range(weights.shape[1]):
        if np.any(weights[:, i]):
            values = _columns(z, layout.controls_at(program.point_control[points, i]))
            rows = ca.DM(np.tile(weights[:, i], (layout.nu, 1)))
            total = total + (values if np.all(weights[:, i] == 1) else rows * values)
    return total


def _defect_rows(program: Program, X: list[ca.MX], F: ca.MX) -> ca.MX:
    """Return the defects as (rows · nx, N): one column a segment."""
    delta = ca.repmat(ca.DM(program.fractions).T, program.layout.nx, 1)
    points = [
        F[:, [int(p) for p in program.segment_points[:, j]]] for j in range(len(program.used))
    ]
    rows = [
        row for row in range(len(program.C)) if not program.compressed or row == len(program.C) - 1
    ]
    parts = []
    for i in rows:
        states = sum((program.C[i, j] * X[j] for j in np.flatnonzero(program.C[i])), ca.MX(0))
        rates = sum((program.A[i, j] * points[j] for j in np.flatnonzero(program.A[i])), ca.MX(0))
        parts.append(states + delta * rates)
    return ca.vertcat(*parts)


def _compressed(program: Program, y: ca.MX, kept: NDArray[np.intp]) -> ca.MX:
    """Return z with interior states as expressions: x_c from its Hermite row."""
    if program.C.shape[1] != 3 or program.A[0, 1] != 0:
        raise UserError(
            "Only a scheme with one explicit interior state can be compressed.",
            where="form",
            found="'compressed'",
            expected="'separated' for this scheme",
            do="Use form='separated'; the optimum is the same.",
        )
    layout, N, nx = program.layout, program.segments, program.layout.nx
    slots = np.full(layout.size, -1)
    slots[kept] = np.arange(len(kept))
    ends = np.unique(program.segment_points[:, [0, 2]])
    partial = ca.vertcat(y, ca.MX(nx, 1))
    lookup = np.where(slots >= 0, slots, len(kept))
    spread = _entries(partial, lookup)
    F = program.point.map(len(ends))(
        _columns(spread, layout.states_at(program.point_state[ends])),
        _point_controls(program, spread, ends),
        ca.repmat(_entries(spread, layout.global_positions), 1, len(ends)),
        program.point_time[None, ends],
    )[1]
    at = {int(p): i for i, p in enumerate(ends)}
    left, right = ([at[int(p)] for p in program.segment_points[:, j]] for j in (0, 2))
    delta = ca.repmat(ca.DM(program.fractions).T, nx, 1)
    C, A = program.C[0], program.A[0]
    rates = delta * (A[0] * F[:, left] + A[2] * F[:, right])
    states = sum(C[j] * _columns(spread, layout.states_at(layout.state[:, j])) for j in (0, 2))
    centre = -(states + rates) / C[1]
    pool = ca.vertcat(y, ca.vec(centre))
    where = np.where(slots >= 0, slots, 0)
    inner = layout.states_at(layout.state[:, 1])
    where[inner] = len(kept) + np.arange(N * nx).reshape(N, nx)
    return _entries(pool, where)


def _recover_interior_rows(program: Program, m: Multipliers, z: Array) -> None:
    """Set the Hermite rows' multipliers from stationarity in x_c, where their block is −I."""
    values = evaluate(program, z)
    m.defects[:, 0] = 0.0
    residual = gradient(program, values, m)
    inner = program.layout.states_at(program.layout.state[:, 1])
    m.defects[:, 0] = -residual[inner] / program.C[0, 1]


def _rate_part(
    program: Program, z: ca.MX
) -> tuple[ca.MX, tuple[Array, Array], tuple[NDArray[np.intp], NDArray[np.intp]]]:
    rows = program.rates
    everything, nothing = np.arange(len(rows.length)), np.empty(0, dtype=np.intp)
    if not len(rows.length):
        return ca.MX(0, 1), (np.empty(0), np.empty(0)), (nothing, nothing)
    weights = ca.DM(rows.weights)
    values = ca.sum2(
        weights * ca.reshape(_entries(z, rows.positions.ravel(order="F")), *weights.shape)
    )
    if program.duration is not None:
        span = rows.length * program.duration
        return values, (rows.lower * span, rows.upper * span), (everything, nothing)
    T = z[int(program.layout.globals)]
    high, low = np.flatnonzero(np.isfinite(rows.upper)), np.flatnonzero(np.isfinite(rows.lower))
    above = _entries(values - ca.DM(np.nan_to_num(rows.upper, posinf=0) * rows.length) * T, high)
    below = _entries(values - ca.DM(np.nan_to_num(rows.lower, neginf=0) * rows.length) * T, low)
    lower = np.concatenate([np.full(len(high), -np.inf), np.zeros(len(low))])
    upper = np.concatenate([np.zeros(len(high)), np.full(len(low), np.inf)])
    return ca.vertcat(above, below), (lower, upper), (high, low)
