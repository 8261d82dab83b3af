"""The finite program an answer was solved as, put together again from its witness.

Legend: N segments with s state points and m control values, nx states, nu controls, ng constraints,
nq globals; w, C, A, λ, μ, ρ, ζ as in witness.py; W (s, m) control at state point j = Σ_i W_ji value
i; ny = nx + nu + nq. Nothing is scaled: every number is in the user's units.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.trajectory import SegmentData, Trajectory
from skyknot.verification import polynomials
from skyknot.verification.lagrangian import Lagrangian
from skyknot.witness import Witness

Array = NDArray[np.float64]
Offsets = NDArray[np.intp]


class FiniteProgram:
    """Unknowns, multipliers and first derivatives of the Lagrangian.

    Parameters
    ----------
    problem : what was asked
    trajectory : the answer
    inside : what happens inside its segments
    parameters : values by name; the problem's own where left out
    witness : scheme and multipliers
    """

    def __init__(
        self,
        problem: Problem,
        trajectory: Trajectory,
        inside: SegmentData,
        parameters: Mapping[str, float],
        witness: Witness,
    ) -> None:
        self.problem, self.trajectory, self.inside = problem, trajectory, inside
        self.witness, self.duration = witness, trajectory.duration
        self.lagrangian = Lagrangian(problem, parameters, self.duration)
        self.fractions = np.diff(trajectory.times) / self.duration
        self.W = polynomials.cardinal(witness.control_points, witness.points)

    @cached_property
    def places(self) -> Array:
        """(N, s) times of the state points, as fractions of the horizon."""
        start = (self.trajectory.times[:-1] - self.trajectory.times[0]) / self.duration
        result: Array = start[:, None] + self.fractions[:, None] * self.witness.points
        return result

    @cached_property
    def X(self) -> Array:
        """(N, s, nx) states."""
        states, interior = self.trajectory.states, self.inside.interior_states
        return np.concatenate([states[:-1, None], interior, states[1:, None]], axis=1)

    @cached_property
    def values(self) -> Array:
        """(N, m, nu) control values."""
        return self.inside.control_values

    @cached_property
    def U(self) -> Array:
        """(N, s, nu) controls at the state points."""
        result: Array = np.einsum("jm,kmu->kju", self.W, self.values)
        return result

    @cached_property
    def nu(self) -> Array:
        """(N, s, nx) multipliers that act on T f at the points: δ_k Σ_i A_ij λ_ki."""
        weighted = np.einsum("ij,kix->kjx", self.witness.A, self.witness.defects)
        result: Array = self.fractions[:, None, None] * weighted
        return result

    @cached_property
    def _first(self) -> tuple[Array, ...]:
        N, s = self.places.shape
        arrays = (self.X, self.U, self.places, self.witness.weights, self.nu, self.witness.path)
        flat = [each.reshape(N * s, *each.shape[2:]) for each in arrays]
        found = self.lagrangian.first(*flat)
        return tuple(each.reshape(N, s, *each.shape[1:]) for each in found)

    @property
    def cost(self) -> Array:
        """(N, s) running cost ℓ."""
        return self._first[0]

    @property
    def rates(self) -> Array:
        """(N, s, nx) dynamics f."""
        return self._first[1]

    @property
    def rows(self) -> Array:
        """(N, s, ng) path and point constraints."""
        return self._first[2]

    @property
    def motion(self) -> Array:
        """(N, s, ny) gradient of T (wℓ + νᵀf)."""
        return self._first[3]

    @property
    def room(self) -> Array:
        """(N, s, ny) gradient of μᵀg."""
        return self._first[4]

    @cached_property
    def end(self) -> tuple[float, Array, Array]:
        """End cost M, its gradient over (x, q), its Hessian."""
        return self.lagrangian.end(self.trajectory.states[-1])

    @cached_property
    def rooms(self) -> Array:
        """(nu,) room of each control: between its bounds, else the largest of 1 and its range."""
        p = self.problem
        rooms = p.control_upper - p.control_lower
        reached = np.ptp(self.values.reshape(-1, p.nu), axis=0)
        given = np.isfinite(rooms) & (rooms > 0)
        return np.where(given, np.where(given, rooms, 1.0), np.maximum(reached, 1.0))

    @cached_property
    def objective(self) -> float:
        """Objective of the finite program."""
        return self.duration * float(np.sum(self.witness.weights * self.cost)) + self.end[0]

    @cached_property
    def objective_size(self) -> float:
        """The largest of 1 and the objective taken with all its parts positive."""
        parts = self.duration * float(np.sum(self.witness.weights * np.abs(self.cost)))
        return max(1.0, parts + abs(self.end[0]))

    @cached_property
    def partials(self) -> Array:
        """(N, s, nx) ∂/∂x of every segment's own cost and defects, constraints left out."""
        nx = self.problem.nx
        linear = np.einsum("ij,kix->kjx", self.witness.C, self.witness.defects)
        result: Array = linear + self.motion[:, :, :nx]
        return result

    @cached_property
    def costates(self) -> tuple[Array, Array]:
        """(N, nx) costate after each segment's first node, and before its last: p⁺_k, p⁻_{k+1}."""
        return self.partials[:, 0], -self.partials[:, -1]

    @cached_property
    def state_bounds(self) -> tuple[Array, Array]:
        """(N, s, nx) lower and upper bounds; initial and final conditions at the ends."""
        p, shape = self.problem, self.X.shape
        lower = np.broadcast_to(p.state_lower, shape).copy()
        upper = np.broadcast_to(p.state_upper, shape).copy()
        for place, low, high in (
            ((0, 0), p.initial_lower, p.initial_upper),
            ((-1, -1), p.final_lower, p.final_upper),
        ):
            lower[place] = np.maximum(lower[place], low)
            upper[place] = np.minimum(upper[place], high)
        return lower, upper

    @cached_property
    def row_bounds(self) -> tuple[Array, Array]:
        """(N, s, ng) bounds of path and point constraints, infinite where one does not apply."""
        p = self.problem
        lower, upper = np.full(self.rows.shape, -np.inf), np.full(self.rows.shape, np.inf)
        for i, entry in enumerate(p.constraints):
            here = np.ones(self.places.shape, dtype=bool)
            if i >= len(p.path):
                here = np.abs(self.places - p.points[i - len(p.path)].at) < 1e-9
            lower[here, i] = -np.inf if entry.lower is None else entry.lower
            upper[here, i] = np.inf if entry.upper is None else entry.upper
        return lower, upper

    @cached_property
    def rate_rows(self) -> tuple[Array, Array, Array]:
        """(R,) value of every rate row, and its bounds, control unit."""
        w, p = self.witness, self.problem
        flat = self.values.reshape(-1)
        values = np.sum(w.rate_weights * flat[w.rate_values], axis=1)
        control = w.rate_values[:, 0] % p.nu if len(values) else np.zeros(0, dtype=np.intp)
        span = self.duration * w.rate_spans
        return values, p.rate_lower[control] * span, p.rate_upper[control] * span

    @cached_property
    def global_bounds(self) -> tuple[Array, Array]:
        """(nq,) bounds of the free duration and parameters."""
        found = {"horizon": self.problem.horizon, **self.problem.free_parameters}
        free = [found[name] for name in self.lagrangian.names]
        pairs = [(each.lower, each.upper) for each in free if isinstance(each, Free)]
        lower, upper = np.array(pairs).reshape(-1, 2).T
        return lower, upper

    @property
    def rate_segments(self) -> Offsets:
        """(R, w) segment of every control value that a rate row reads."""
        result: Offsets = self.witness.rate_values // (self.values.shape[1] * self.problem.nu)
        return result

    @cached_property
    def state_terms(self) -> Array:
        """(3, N, s, nx) what ∂L/∂x sums: cost and motion, constraints, bounds."""
        nx = self.problem.nx
        ends = np.zeros_like(self.partials)
        ends[-1, -1] = self.end[1][:nx]
        return np.stack(
            [self.partials, self.room[:, :, :nx], self.witness.state_bounds + ends], axis=0
        )

    @cached_property
    def state_slopes(self) -> Array:
        """(N, s, nx) ∂L/∂x; of a node shared by two segments once, in the segment it begins."""
        return _merged(np.sum(self.state_terms, axis=0))

    @cached_property
    def control_terms(self) -> Array:
        """(4, N, m, nu) what ∂L/∂u sums: cost and motion, constraints, rates, bounds."""
        inside = slice(self.problem.nx, self.problem.nx + self.problem.nu)
        w = self.witness
        rates = np.zeros(self.values.size)
        np.add.at(rates, w.rate_values, w.rates[:, None] * w.rate_weights)
        return np.stack(
            [
                np.einsum("jm,kju->kmu", self.W, self.motion[:, :, inside]),
                np.einsum("jm,kju->kmu", self.W, self.room[:, :, inside]),
                rates.reshape(self.values.shape),
                w.control_bounds,
            ]
        )

    @cached_property
    def control_slopes(self) -> Array:
        """(N, m, nu) ∂L/∂u; of a value shared by two segments once, in the segment it begins."""
        slopes = np.sum(self.control_terms, axis=0)
        return _merged(slopes) if self.witness.shared else slopes

    @cached_property
    def global_terms(self) -> Array:
        """(4, nq) what ∂L/∂q sums: cost and motion, constraints, end and bounds, rates."""
        nx, nu = self.problem.nx, self.problem.nu
        rates = np.zeros(len(self.lagrangian.q))
        if self.problem.free_horizon:
            rates[0] = -np.sum(self.rate_pull * self.witness.rate_spans)
        return np.stack(
            [
                np.sum(self.motion[:, :, nx + nu :], axis=(0, 1)),
                np.sum(self.room[:, :, nx + nu :], axis=(0, 1)),
                self.end[1][nx:] + self.witness.global_bounds,
                rates,
            ]
        )

    @property
    def global_slopes(self) -> Array:
        """(nq,) ∂L/∂q."""
        result: Array = np.sum(self.global_terms, axis=0)
        return result

    @property
    def rate_pull(self) -> Array:
        """(R,) multiplier of every rate row times the rate bound it pulls at."""
        _, lower, upper = self.rate_rows
        span = self.duration * self.witness.rate_spans
        rho = self.witness.rates
        bound = np.where(rho > 0, upper, lower) / span
        result: Array = rho * np.where(rho == 0, 0.0, bound)
        return result


def _merged(values: Array) -> Array:
    """Return values (N, j, n) with each last entry moved onto the next segment's first."""
    merged = values.copy()
    merged[1:, 0] += values[:-1, -1]
    merged[:-1, -1] = 0.0
    return merged
