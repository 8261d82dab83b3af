"""The metric of a gradient projection, and values and slopes of a program in its unknowns.

Legend: w scaled unknowns, z = S w; c defects, J cost, λ multipliers of the defects, M metric,
A = ∇c the frozen Jacobian, δ step, r gradient, ζ forces that hold unknowns in place.

The unknowns stand in rows, as the native room keeps them, then the globals; entries of a row past
its end are zero and fixed. A factorisation costs O(N (nx + nu)³), everything else, as equation (16)
of the source report claims for an iteration, O(N (nx + nu)²).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel import native
from skyknot.kernel.program import Multipliers, Program
from skyknot.kernel.rows import Rows, native_solver, tapes

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

HELD = 1e8
"""Weight of a global held in place."""


@dataclass(frozen=True)
class Point:
    """Values and slopes at w.

    Attributes
    ----------
    w : (n,), objective : J, defects : (D, N) scaled, gradient : (n,) ∇J in scaled unknowns
    """

    w: Array
    objective: float
    defects: Array
    gradient: Array


class Metric:
    """A program in scaled unknowns, with a Gauss–Newton matrix frozen at one point of it.

    M is the Hessian of the cost at the frozen point, plus a multiple of the identity.

    Attributes
    ----------
    lower, upper, scale, start : (n,) bounds, S and start
    here : (n,) what is an unknown, fixed : (n,) what cannot move, moving : (n,), controls : (n,)
    defect_scale : (D, 1) unscaled defect = scaled × this
    work : counts of evaluations, gradients, solves, factorisations and linearisations
    """

    def __init__(self, program: Program) -> None:
        self.program, self._rows = program, Rows(program)
        rows, layout = self._rows, program.layout
        made = tapes(program, rows.path_scale)
        held = native_solver(rows.structure(made.patterns), made)
        self._native = native.FrozenMetric(held, made.value.native, made.full.native)
        self._native.load(rows.data(program.start) | {"objective_scale": 1.0})
        self._table = rows.positions.shape
        self._size = rows.positions.size
        self._place = np.concatenate([rows.positions.ravel(), layout.global_positions])
        self.here = self._place >= 0
        self.scale = np.concatenate([np.repeat(rows.scale, self._table[1]), rows.S_q])
        self.lower, self.upper = self.scaled(program.lower), self.scaled(program.upper)
        self.start = np.clip(self.scaled(program.start), self.lower, self.upper)
        self.fixed = self.lower == self.upper
        self.moving = self.here & ~self.fixed
        control = np.zeros(layout.size, dtype=bool)
        control[layout.controls_at(layout.control)] = True
        self.controls = self.here & control[self._place]
        first = np.zeros(self._table, dtype=bool)
        first[: layout.nx, 0] = self.fixed[: self._size].reshape(self._table)[: layout.nx, 0]
        self._pinnable = (rows.positions >= 0) & ~first
        self.defect_scale = np.tile(rows.S_x, len(program.C))[:, None]
        self.no_multipliers = np.zeros((len(program.C) * layout.nx, rows.N))
        self._held = np.empty((0, 2), dtype=np.intp)
        self._held_q = np.zeros(layout.nq, dtype=bool)
        names = ("evaluations", "gradients", "solves", "factorisations", "linearisations")
        self.work = dict.fromkeys(names, 0)

    def scaled(self, z: Array) -> Array:
        """Return w of a vector like z."""
        w: Array = np.where(self.here, z[self._place], 0.0) / self.scale
        return w

    def unscaled(self, w: Array) -> Array:
        """Return z of a vector like w."""
        z = self.program.start.copy()
        z[self._place[self.here]] = (w * self.scale)[self.here]
        return z

    def evaluate(self, w: Array) -> tuple[float, Array]:
        """Return cost and defects at w."""
        self.work["evaluations"] += 1
        J, c = self._native.evaluate(*self._split(w))
        return J, c

    def differentiate(self, w: Array) -> Point:
        """Return values and slopes at w."""
        self.work["gradients"] += 1
        J, c, gradient = self._native.differentiate(*self._split(w), self.no_multipliers)
        return Point(w, J, c, self._joined(*gradient))

    def adjoint(self, multipliers: Array) -> Array:
        """Return ∇cᵀ λ, (n,), at the point last differentiated."""
        return self._joined(*self._native.adjoint(multipliers))

    def freeze(self) -> None:
        """Take matrix and Jacobian from the point last differentiated."""
        self.work["linearisations"] += 1
        self._native.freeze()

    def factor(self, held: Mask, regularisation: float, weights: Array | None = None) -> bool:
        """Factor M + regularisation I + diag(weights) with some unknowns held.

        Returns False when it is not definite where held unknowns and defects leave freedom.
        """
        self.work["factorisations"] += 1
        self._held = np.argwhere(held[: self._size].reshape(self._table) & self._pinnable)
        self._held_q = held[self._size :]
        v, q = self._split(np.zeros(len(self.scale)) if weights is None else weights)
        q = (np.array(q) + HELD * self._held_q).tolist()
        return bool(self._native.factor(self._held, v, q, regularisation))

    def solve(self, r: Array, d: Array, refinements: int = 1) -> tuple[Array, Array, Array]:
        """Return (δ, λ, ζ): M δ + Aᵀ λ + ζ = −r, A δ = −d, with ζ and no δ where held."""
        self.work["solves"] += 1
        v, q, multipliers, pins = self._native.solve(*self._split(r), d, refinements)
        forces = np.zeros(self._table)
        forces[self._held[:, 0], self._held[:, 1]] = pins
        forces_q = np.where(self._held_q, HELD * np.array(q), 0.0)
        return self._joined(v, q), multipliers, np.concatenate([forces.ravel(), forces_q])

    def product(self, step: Array) -> tuple[Array, Array]:
        """Return (M δ, A δ)."""
        gradient, d = self._native.product(*self._split(step))
        return self._joined(*gradient), d

    def multipliers(self, multipliers: Array, bounds: Array) -> Multipliers:
        """Return the program's multipliers from λ and those of the bounds, unscaled."""
        program = self.program
        m = program.empty_multipliers()
        rows = multipliers.reshape(len(program.C), program.layout.nx, self._rows.N)
        m.defects[:] = rows.transpose(2, 0, 1) / self._rows.S_x
        m.bounds[self._place[self.here]] = (bounds / self.scale)[self.here]
        return m

    def scaled_multipliers(self, m: Multipliers) -> Array:
        """Return λ of a program's multipliers."""
        rows = (m.defects * self._rows.S_x).transpose(1, 2, 0)
        return np.ascontiguousarray(rows.reshape(self.no_multipliers.shape))

    def _split(self, w: Array) -> tuple[Array, list[float]]:
        return w[: self._size].reshape(self._table), w[self._size :].tolist()

    def _joined(self, v: Array, q: list[float]) -> Array:
        w: Array = np.concatenate([v.ravel(), q])
        w[~self.here] = 0.0
        return w
