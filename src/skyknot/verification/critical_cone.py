"""The finite program to second order, stage by stage, on directions that keep its constraints.

Legend: stage vector σ_k = (x_k, u_k where nodes share it, q), stage control v_k = the other control
values of segment k; nσ, nv their sizes, ny = nx + nu + nq; everything is scaled by the sizes of its
states and the rooms of its controls. Inside a segment the linearised defects give all states, so
that each point moves by P_kj (σ_k, v_k). H_k is the Lagrangian's Hessian on (σ_k, v_k), N_k the
step to σ_{k+1}, D_k the rows that must stay zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from skyknot.verification.finite_program import FiniteProgram

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

LEAST_PULL = 1e-6
"""Share of the objective that a multiplier times its room must reach to be strongly active."""


@dataclass(frozen=True)
class Stage:
    """One segment: H (n, n), N (nσ, n) and D (rows, n) on (σ, v), n = nσ + nv."""

    H: Array
    N: Array
    D: Array


class CriticalCone:
    """Stages of a program on its strongly active constraints.

    Parameters
    ----------
    program : put together from the witness
    sizes : (nx,) sizes of the states
    """

    def __init__(self, program: FiniteProgram, sizes: Array) -> None:
        self.program = program
        p = program.problem
        self.rooms = program.rooms
        self.q_sizes = np.maximum(np.abs(program.lagrangian.q), 1e-9)
        self.shared = program.witness.shared
        carried = [sizes, self.rooms, self.q_sizes] if self.shared else [sizes, self.q_sizes]
        self.sizes, self.scale = sizes, np.concatenate(carried)
        self.m = program.values.shape[1]
        own = self.m - 1 if self.shared else self.m
        self.n_stage, self.n_control = len(self.scale), own * p.nu

    @cached_property
    def stages(self) -> list[Stage]:
        """All segments in order."""
        H, N, D = self._hessians, self._steps, self._rows
        return [Stage(H[k], N[k], D[k]) for k in range(len(H))]

    @cached_property
    def _second(self) -> tuple[Array, Array, Array]:
        program, (count, s) = self.program, self.program.places.shape
        w = program.witness
        arrays = (program.X, program.U, program.places, w.weights, program.nu, w.path)
        flat = [each.reshape(count * s, *each.shape[2:]) for each in arrays]
        found = program.lagrangian.second(*flat)
        hessian, rates, rows = (each.reshape(count, s, *each.shape[1:]) for each in found)
        return hessian, rates, rows

    @cached_property
    def _values(self) -> Array:
        """(m nu, n) control values as functions of (σ, v)."""
        nu, n = self.program.problem.nu, self.n_stage + self.n_control
        nx = self.program.problem.nx
        result = np.zeros((self.m * nu, n))
        rooms = np.tile(self.rooms, self.m)
        if self.shared:
            result[:nu, nx : nx + nu] = np.eye(nu)
            result[nu:, self.n_stage :] = np.eye(self.n_control)
        else:
            result[:, self.n_stage :] = np.eye(self.n_control)
        scaled: Array = rooms[:, None] * result
        return scaled

    @cached_property
    def moves(self) -> Array:
        """(N, s, ny, n) how x, u and q of every point move with (σ, v)."""
        program, p = self.program, self.program.problem
        _, F, _ = self._second
        count, s, nx, _ = F.shape
        nu, nq, n = p.nu, len(self.q_sizes), self.n_stage + self.n_control
        P = np.zeros((count, s, nx + nu + nq, n))
        P[:, 0, :nx, :nx] = np.diag(self.sizes)
        controls = np.einsum("jm,mun->jun", program.W, self._values.reshape(self.m, nu, n))
        P[:, :, nx : nx + nu] = controls
        P[:, :, nx + nu :, self.n_stage - nq : self.n_stage] = np.diag(self.q_sizes)
        C, A = program.witness.C, program.witness.A
        weighted = program.fractions[:, None, None] * A
        known = np.einsum("ij,jxn->ixn", C[:, :1], P[0, :1, :nx])
        right = known + np.einsum("kij,kjxy,kjyn->kixn", weighted, F, P, optimize=True)
        M = np.einsum("kij,kjxy->kixjy", weighted[:, :, 1:], F[:, 1:, :, :nx])
        M += np.einsum("ij,xy->ixjy", C[:, 1:], np.eye(nx))
        size = (s - 1) * nx
        solved = np.linalg.solve(M.reshape(count, size, size), -right.reshape(count, size, n))
        P[:, 1:, :nx] = solved.reshape(count, s - 1, nx, n)
        return P

    @cached_property
    def _hessians(self) -> Array:
        hessian, _, _ = self._second
        H: Array = np.einsum("kjan,kjam->knm", self.moves, hessian @ self.moves, optimize=True)
        nx, nq = self.program.problem.nx, len(self.q_sizes)
        last: Array = self.moves[-1, -1]
        end = last[np.r_[:nx, len(last) - nq : len(last)]]
        H[-1] += end.T @ self.program.end[2] @ end
        return H

    @cached_property
    def _steps(self) -> Array:
        """(N, nσ, n) the next stage vector, scaled."""
        p, nq = self.program.problem, len(self.q_sizes)
        last = self.moves[:, -1]
        parts = [last[:, : p.nx], last[:, p.nx + p.nu :]] if nq else [last[:, : p.nx]]
        if self.shared:
            carried = np.broadcast_to(self._values[-p.nu :], (len(last), p.nu, last.shape[2]))
            parts.insert(1, carried)
        result: Array = np.concatenate(parts, axis=1) / self.scale[:, None]
        return result

    @cached_property
    def _rows(self) -> list[Array]:
        """Strongly active rows of every segment, each of length one."""
        program, p = self.program, self.program.problem
        w, count = program.witness, len(program.places)
        _, _, g = self._second
        controls = np.broadcast_to(self._values, (count, *self._values.shape))
        shape = program.values.shape
        low, high = np.broadcast_to(p.control_lower, shape), np.broadcast_to(p.control_upper, shape)
        active = [
            self._active(program.X, *program.state_bounds, w.state_bounds),
            self._active(program.rows, *program.row_bounds, w.path),
            self._active(program.values, low, high, w.control_bounds),
        ]
        all_rows = [
            self.moves[:, :, : p.nx].reshape(count, -1, self.moves.shape[3]),
            (g @ self.moves).reshape(count, -1, self.moves.shape[3]),
            controls,
        ]
        taken = [self._rate_rows(k) for k in range(count)]
        for flags, rows in zip(active, all_rows, strict=True):
            chosen = flags.reshape(count, -1)
            for k in range(count):
                taken[k].append(rows[k][chosen[k]])
        return [_unit(np.concatenate(rows)) for rows in taken]

    def _rate_rows(self, k: int) -> list[Array]:
        """Return the active rate rows that lie within segment k alone."""
        program, w = self.program, self.program.witness
        nothing: list[Array] = [np.zeros((0, self.moves.shape[3]))]
        inside = np.all(program.rate_segments == k, axis=1)
        if not np.any(inside):
            return nothing
        value, lower, upper = program.rate_rows
        chosen = np.flatnonzero(inside & self._active(value, lower, upper, w.rates))
        per_segment = self.m * program.problem.nu
        for row in chosen:
            total = w.rate_weights[row] @ self._values[w.rate_values[row] % per_segment]
            if program.problem.free_horizon:
                bound = upper[row] if w.rates[row] > 0 else lower[row]
                total = total - bound / program.duration * self._duration_row
            nothing.append(total[None])
        return nothing

    @property
    def _duration_row(self) -> Array:
        """(n,) how the duration moves with (σ, v); the first of the globals when it is free."""
        row = np.zeros(self.n_stage + self.n_control)
        first = self.n_stage - len(self.q_sizes)
        row[first] = self.q_sizes[0]
        return row

    def _active(self, value: Array, lower: Array, upper: Array, multiplier: Array) -> Flags:
        """Return what is fixed, or pulled at by more than its distance from the bound."""
        pulled = np.where(multiplier > 0, upper, lower)
        room = np.where(np.isfinite(upper - lower), upper - lower, np.maximum(np.abs(value), 1.0))
        room = np.where(room > 0, room, 1.0)
        pull = np.abs(multiplier) * room / self.program.objective_size
        away = np.where(np.isfinite(pulled), np.abs(pulled - value) / room, np.inf)
        result: Flags = (lower == upper) | ((pull > LEAST_PULL) & (pull > away))
        return result


def _unit(rows: Array) -> Array:
    """Return rows of length one; those that do not move at all are left out."""
    length = np.linalg.norm(rows, axis=1)
    result: Array = rows[length > 0] / length[length > 0, None]
    return result
