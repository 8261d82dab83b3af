"""A program as the native room wants it: scaled, in rows, with its tapes.

Legend: as in program.py; a tilde-free name here is scaled: z = S z̃, F̃ = F / S_x, g̃ = g / s_g,
objective σ f. One row holds one quantity of all segments (or nodes).
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.kernel import native
from skyknot.kernel.evaluation import evaluate
from skyknot.kernel.functions import Functions
from skyknot.kernel.program import Multipliers, Program
from skyknot.kernel.tape import Tape

Array = NDArray[np.float64]
Offsets = NDArray[np.intp]


RELAXATION = 1e-8


@dataclass(frozen=True)
class Tapes:
    """The tapes of a program and the sparsity they write.

    Attributes
    ----------
    value : (x, u, q, τ, p) → (L, F, g); full : (x, u, q, τ, p, c, ν, y) → L, F, g, ∂L, ∂F, ∂g, H;
    terminal : (x, q, p) → M, ∂M, ∂²M; patterns : rows and columns of the non-zeros
    """

    value: Tape
    full: Tape
    terminal: Tape
    patterns: dict[str, list[int]]


def tapes(program: Program, path_scale: Array) -> Tapes:
    """Return the scaled tapes of a program; programs that differ in mesh or numbers share them."""
    scales = [tuple(S.tolist()) for S in (*_scales(program), path_scale)]
    return _tapes(program.functions, len(program.parameters), *scales)


@lru_cache(maxsize=32)
def _tapes(functions: Functions, parameters: int, *scales: tuple[float, ...]) -> Tapes:
    S_x, S_u, S_q, path_scale = (np.array(scale) for scale in scales)
    nq, ng = len(S_q), len(path_scale)
    x, u, q = (ca.SX.sym(n, len(S)) for n, S in (("x", S_x), ("u", S_u), ("q", S_q)))
    tau, p = ca.SX.sym("tau"), ca.SX.sym("p", parameters)
    L, F, g = functions.point(x * S_x, u * S_u, q * S_q if nq else q, tau, p)
    F, g = ca.densify(F) / S_x, ca.densify(g) / path_scale if ng else g
    y = ca.vertcat(x, u, q)
    c, nu_F, nu_g = ca.SX.sym("c"), ca.SX.sym("nu", len(S_x)), ca.SX.sym("y", ng)
    JL, JF, Jg = ca.gradient(L, y), ca.jacobian(F, y), ca.jacobian(g, y)
    H = ca.tril(ca.hessian(c * L + ca.dot(nu_F, F) + (ca.dot(nu_g, g) if ng else 0), y)[0])
    value = _function("value", [x, u, q, tau, p], [ca.densify(L), F, g])
    full = _function("full", [x, u, q, tau, p, c, nu_F, nu_g], [ca.densify(L), F, g, JL, JF, Jg, H])
    M = functions.terminal(x * S_x, q * S_q if nq else q, p)
    end = ca.vertcat(x, q)
    HM, JM = ca.hessian(M, end)
    terminal = _function("terminal", [x, q, p], [ca.densify(e) for e in (M, JM, HM)])
    patterns = {"gradient": JL.sparsity().get_triplet()[0]}
    for name, matrix in (("JF", JF), ("Jg", Jg), ("H", H)):
        patterns[f"{name}_row"], patterns[f"{name}_column"] = matrix.sparsity().get_triplet()
    return Tapes(Tape(value), Tape(full), Tape(terminal), patterns)


def _function(name: str, inputs: list[ca.SX], outputs: list[ca.SX]) -> ca.Function:
    return ca.Function(name, inputs, ca.cse(outputs))


def _scales(program: Program) -> tuple[Array, Array, Array]:
    layout, scales = program.layout, program.scales
    return (
        scales[layout.states_at(layout.state[0, :1])[0]],
        scales[layout.controls_at(layout.control[0, :1])[0]],
        scales[layout.global_positions],
    )


class Rows:
    """Translates a program, its unknowns and its multipliers to rows and back.

    Attributes
    ----------
    positions : (rows, N+1) where in z each entry of the rows stands, −1 where there is none
    places : (globals,) where in the rows, one after the other, each entry of z before its globals
        stands
    """

    def __init__(self, program: Program) -> None:
        self.program = program
        layout, N = program.layout, program.segments
        nx, nu, _, ng = program.sizes
        self.N, s, m = N, layout.state.shape[1], layout.control.shape[1]
        own = m - 1 if program.shared else m
        self.S_x, self.S_u, self.S_q = _scales(program)
        self.positions = np.full(((s - 1) * nx + own * nu, N + 1), -1, dtype=np.intp)
        for j in range(s - 1):
            self.positions[j * nx : (j + 1) * nx, :N] = layout.states_at(layout.state[:, j]).T
        self.positions[:nx, N] = layout.states_at(layout.state[-1, -1:])[0]
        for c in range(own):
            rows = slice((s - 1) * nx + c * nu, (s - 1) * nx + (c + 1) * nu)
            self.positions[rows, :N] = layout.controls_at(layout.control[:, c]).T
        if program.shared:
            rows = slice((s - 1) * nx, (s - 1) * nx + nu)
            self.positions[rows, N] = layout.controls_at(layout.control[-1, -1:])[0]
        self.here = self.positions >= 0
        self._absent = None if self.here.all() else ~self.here
        self.places = np.empty(layout.globals, dtype=np.intp)
        self.places[self.positions[self.here]] = np.flatnonzero(self.here)
        self.scale = np.concatenate([np.tile(self.S_x, s - 1), np.tile(self.S_u, own)])
        n_used = len(program.used)
        self.classes = [program.segment_points[:, c] for c in range(n_used - program.shared)]
        if program.shared:
            self.classes[0] = np.append(self.classes[0], program.segment_points[-1, -1])
        self.rates = _RateTypes(program, self.S_u)
        self.path_scale = np.ones(ng)
        self.objective_scale = 1.0
        self.path_columns: list[list[int]] = []
        self._limits: _Limits | None = None
        self._constants = self._unchanging()

    def at(self, program: Program) -> Rows:
        """Return the rows of a program that differs in numbers only; see Prepared."""
        other = copy.copy(self)
        other.program = program
        other._limits = self.limits if _same_limits(self.program, program) else None
        return other

    def structure(self, patterns: dict[str, list[int]]) -> dict[str, Any]:
        """Return sizes, scheme and sparsity for the native constructor."""
        program = self.program
        nx, nu, nq, ng = program.sizes
        pairs = list(zip(patterns["Jg_row"], patterns["Jg_column"], strict=True))
        self.path_columns = [[c for r, c in pairs if r == row] for row in range(ng)]
        return {
            "nx": nx, "nu": nu, "nq": nq, "ng": ng, "N": self.N, "np": len(program.parameters),
            "s": program.layout.state.shape[1], "m": program.layout.control.shape[1],
            "shared": bool(program.shared), "carry": bool(self.rates.carry),
            "free_duration": program.duration is None,
            "used": [int(j) for j in program.used],
            "C": program.C.ravel().tolist(), "A": program.A.ravel().tolist(),
            "W": program.control_weights.ravel().tolist(),
            **{name: [int(i) for i in entries] for name, entries in patterns.items()},
            "places": self.places,
            "rate_control": self.rates.control, "rate_weights": self.rates.weights,
        }  # fmt: skip

    def to_rows(self, z: Array, fill: float = 0.0) -> Array:
        """Return (rows, N+1) entries of a vector like z; ``fill`` where a row has no entry."""
        rows: Array = z[self.positions]
        if self._absent is not None:
            rows[self._absent] = fill
        return rows

    @property
    def limits(self) -> _Limits:
        """Bounds of the program in rows; kept, since most solves ask again with the same."""
        if self._limits is None:
            self._limits = _Limits(self)
        return self._limits

    @property
    def pins(self) -> Offsets:
        """(n, 2) rows and columns of fixed unknowns but for those of the first state."""
        return self.limits.pins

    def data(self, z: Array) -> dict[str, Any]:
        """Return bounds, start and scales for the native solve."""
        return {
            **self._constants,
            **self.limits.data,
            "z": self.to_rows(z) / self.scale[:, None],
            "q": (z[self.program.incidence.globals] / self.S_q).tolist(),
            "parameters": self.program.parameters.tolist(),
            **self._without_settled(z),
        }

    def _unchanging(self) -> dict[str, Any]:
        """Return what the native solve is told whatever the numbers of the program."""
        program = self.program
        cost = program.point_cost * self.objective_scale
        return {
            "scale": np.repeat(self.scale[:, None], self.N + 1, axis=1),
            "q_scale": self.S_q.tolist(),
            "defect_scale": self.S_x.tolist(),
            "objective_scale": self.objective_scale,
            "length": np.vstack([program.fractions, self.rates.coefficients(self.S_q)]),
            "time": [np.ascontiguousarray(program.point_time[None, p]) for p in self.classes],
            "cost": [np.ascontiguousarray(cost[None, p]) for p in self.classes],
            "path_unscale": self.path_scale.tolist(),
            "rate_lower": self.rates.lower,
            "rate_upper": self.rates.upper,
            "rate_unscale": self.rates.scale.tolist(),
        }

    def path_tables(self, lower: Array, upper: Array) -> dict[str, list[Array]]:
        """Return (P, ng) path bounds as the native room wants them: (ng, n) by class of points."""
        scale = self.path_scale[:, None]
        return {
            name: [np.ascontiguousarray(side[points].T / scale) for points in self.classes]
            for name, side in (("path_lower", lower), ("path_upper", upper))
        }

    def _without_settled(self, z: Array) -> dict[str, list[Array]]:
        """Return path bounds without rows that hold where nothing can move, if there are any.

        At a node whose state is fixed, a row of the state alone is settled: it is dropped when it
        holds.
        """
        program, (lower, upper) = self.program, self.limits.path
        nx = program.layout.nx
        rows = [i for i, read in enumerate(self.path_columns) if all(c < nx for c in read)]
        points = self.limits.fixed_points
        if not rows or not len(points):
            return {}
        g = evaluate(program, z, points).g[:, rows]
        holds = (lower[points][:, rows] <= g) & (g <= upper[points][:, rows])
        if not holds.any():
            return {}
        lower, upper = lower.copy(), upper.copy()
        where, which = np.nonzero(holds)
        at = points[where], np.array(rows)[which]
        lower[at], upper[at] = -np.inf, np.inf
        return self.path_tables(lower, upper)

    def unknowns(self, result: dict[str, Any]) -> Array:
        """Return z of a native result."""
        z: Array = result["z"][0]
        return z.clip(self.program.lower, self.program.upper)

    def multipliers(self, result: dict[str, Any]) -> Multipliers:
        """Return the multipliers of a native result, unscaled.

        Of bounds that fix unknowns, other than globals, they are those of the point where the
        native solve last differentiated: its result, when it succeeded.
        """
        program, sigma = self.program, self.objective_scale
        path = np.zeros(program.path_lower.shape)
        for points, y in zip(self.classes, result["y"][:-1], strict=True):
            path[points] = y.T / (sigma * self.path_scale)
        rates = np.zeros(len(program.rates.length))
        self.rates.add_multipliers(result["y"][-1] / sigma, rates)
        return Multipliers(
            defects=result["defects"].reshape(self.N, len(program.C), program.layout.nx),
            path=path,
            rates=rates,
            bounds=result["bounds"][0],
        )

    def gains(self, gains: Array) -> Array | None:
        """Return native gains, (N or none, nu · nx), unscaled: (N, nu, nx), or None.

        With shared controls (N+1, nu, nx): nothing lies ahead of the last node, whose gains
        continue those before.
        """
        if not len(gains):
            return None
        K: Array = gains.reshape(self.N, len(self.S_u), len(self.S_x))
        K = K * self.S_u[:, None] / self.S_x
        if not self.program.shared:
            return K
        ahead = self.program.fractions[-1] / self.program.fractions[max(self.N - 2, 0)]
        last: Array = K[-1] + ahead * (K[-1] - K[max(self.N - 2, 0)])
        return np.concatenate([K, last[None]])

    def warm(self, m: Multipliers) -> dict[str, Any]:
        """Return multipliers as the native solve wants them."""
        sigma, program = self.objective_scale, self.program
        bounds = self.to_rows(m.bounds) * sigma * self.scale[:, None]
        limits, least = self.limits, 1e-8
        q = m.bounds[program.incidence.globals] * sigma * self.S_q
        return {
            "lambda": np.ascontiguousarray(
                (m.defects * sigma * self.S_x).transpose(1, 2, 0).reshape(-1, self.N)
            ),
            "zl": np.where(np.isfinite(limits.data["lower"]), np.maximum(-bounds, least), 0.0),
            "zu": np.where(np.isfinite(limits.data["upper"]), np.maximum(bounds, least), 0.0),
            "q_zl": np.maximum(-q, least).tolist(),
            "q_zu": np.maximum(q, least).tolist(),
            "pin_multipliers": bounds[limits.pinned].tolist(),
            "y": [
                np.ascontiguousarray((m.path[points] * sigma * self.path_scale).T)
                for points in self.classes
            ]
            + [self.rates.take_multipliers(m.rates) * sigma],
        }


class _Limits:
    """Bounds of a program in scaled rows; fixed unknowns are told apart.

    Attributes
    ----------
    pins : (n, 2) rows and columns of fixed unknowns but for those of the first state
    pinned : the same as an index; fixed_globals : whether a global is fixed, too
    path : (P, ng) lower and upper path bounds as the barrier can meet them
    fixed_points : evaluated points whose state is fixed
    data : entries for the native solve
    """

    def __init__(self, rows: Rows) -> None:
        program, scale, nx = rows.program, rows.scale[:, None], rows.program.layout.nx
        lower = rows.to_rows(program.lower, -np.inf) / scale
        upper = rows.to_rows(program.upper, np.inf) / scale
        pinned = (lower == upper) & rows.here
        lower[pinned], upper[pinned] = -np.inf, np.inf
        fixed_first = pinned[:nx, 0].astype(int).tolist()
        pinned[:nx, 0] = False
        self.pins = np.argwhere(pinned)
        self.pinned = tuple(self.pins.T)
        fixed = (program.lower == program.upper)[program.incidence.point_states]
        self.fixed_points = np.flatnonzero(fixed.all(axis=1))
        self.path = _relaxed(program)
        q = program.incidence.globals
        self.fixed_globals = bool((program.lower[q] == program.upper[q]).any())
        self.data: dict[str, Any] = {
            "lower": lower,
            "upper": upper,
            "q_lower": (program.lower[q] / rows.S_q).tolist(),
            "q_upper": (program.upper[q] / rows.S_q).tolist(),
            "pin_row": self.pins[:, 0].tolist(),
            "pin_k": self.pins[:, 1].tolist(),
            "fixed_first": fixed_first,
            **rows.path_tables(*self.path),
        }


def _same_limits(one: Program, other: Program) -> bool:
    """Whether the limits of one program are the other's: where values differ, both fix them."""
    if one.path_lower is not other.path_lower or one.path_upper is not other.path_upper:
        return False
    if one.lower is other.lower and one.upper is other.upper:
        return True
    moved = np.flatnonzero((one.lower != other.lower) | (one.upper != other.upper))
    if np.any(moved >= one.layout.globals):
        return False
    return all(np.array_equal(each.lower[moved], each.upper[moved]) for each in (one, other))


def _relaxed(program: Program) -> tuple[Array, Array]:
    """Return (P, ng) path bounds, inequalities relaxed by 1e-8 (relative).

    So that one exactly active where nothing can move still has an interior; Wächter & Biegler 2006,
    section 3.5.
    """
    lower, upper = program.path_lower.copy(), program.path_upper.copy()
    loose = lower < upper
    lower[loose] -= RELAXATION * np.maximum(1.0, np.abs(lower[loose]))
    upper[loose] += RELAXATION * np.maximum(1.0, np.abs(upper[loose]))
    return lower, upper


class _RateTypes:
    """The rate rows grouped by kind: one row of N entries for each control and place."""

    def __init__(self, program: Program, S_u: Array) -> None:
        rows, N = program.rates, program.segments
        self.program = program
        self.held = len(program.control_points) == 1
        entries = N - 1 if self.held else N
        self.types = len(rows.length) // entries if entries else 0
        self.carry = self.held and self.types > 0
        first = 1 if self.held else 0
        self.index = np.full((self.types, N), -1, dtype=np.intp)
        if self.types:
            self.index[:, first:] = np.arange(len(rows.length)).reshape(entries, self.types).T
        names = list(program.control_names)
        kinds = [int(self.index[i, -1]) for i in range(self.types)]
        one = [(i, names.index(rows.names[kind])) for i, kind in enumerate(kinds)]
        self.free = program.duration is None
        sides = ("upper", "lower") if self.free else ("both",)
        self.rows = [(i, control, side) for i, control in one for side in sides]
        self.control = [control for _, control, _ in self.rows]
        here = self.index >= 0
        self.scale = np.ones(len(self.rows))
        self.weights = []
        self.lower = np.full((len(self.rows), N), -np.inf)
        self.upper = np.full((len(self.rows), N), np.inf)
        T = program.duration or 0.0
        for r, (i, control, side) in enumerate(self.rows):
            weights = rows.weights[kinds[i]] * S_u[control]
            self.scale[r] = np.max(np.abs(weights))
            self.weights.append((weights / self.scale[r]).tolist())
            at = self.index[i][here[i]]
            if side == "both":
                self.lower[r, here[i]] = rows.lower[at] * rows.length[at] * T / self.scale[r]
                self.upper[r, here[i]] = rows.upper[at] * rows.length[at] * T / self.scale[r]
            elif side == "upper" and np.isfinite(rows.upper[kinds[i]]):
                self.upper[r, here[i]] = 0.0
            elif side == "lower" and np.isfinite(rows.lower[kinds[i]]):
                self.lower[r, here[i]] = 0.0

    def coefficients(self, S_q: Array) -> Array:
        """Return (rows, N): coefficient of the scaled duration, −bound · length."""
        N, rates = self.program.segments, self.program.rates
        values = np.zeros((len(self.rows), N))
        if self.free:
            for r, (i, _, side) in enumerate(self.rows):
                at = self.index[i][self.index[i] >= 0]
                bound = getattr(rates, side)[at]
                bound = np.where(np.isfinite(bound), bound, 0.0)
                values[r, self.index[i] >= 0] = -bound * rates.length[at] * S_q[0] / self.scale[r]
        return values

    def add_multipliers(self, y: Array, out: Array) -> None:
        """Add the rows' multipliers, (rows, N), to the program's rate multipliers."""
        for r, (i, _, _) in enumerate(self.rows):
            here = self.index[i] >= 0
            out[self.index[i][here]] += y[r, here] / self.scale[r]

    def take_multipliers(self, rates: Array) -> Array:
        """Return (rows, N) multipliers from the program's."""
        y = np.zeros((len(self.rows), self.program.segments))
        for r, (i, _, side) in enumerate(self.rows):
            here = self.index[i] >= 0
            values = rates[self.index[i][here]] * self.scale[r]
            clipped = {
                "both": values,
                "upper": np.maximum(values, 0),
                "lower": np.minimum(values, 0),
            }
            y[r, here] = clipped[side]
        return y


def native_solver(structure: dict[str, Any], made: Tapes) -> Any:
    """Return the native interior point of one structure."""
    return native.InteriorPoint(
        structure, made.value.native, made.full.native, made.terminal.native
    )
