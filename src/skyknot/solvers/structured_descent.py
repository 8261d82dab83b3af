"""The projected gradient in the metric of a Riccati-factored Gauss–Newton matrix.

Legend: w scaled unknowns, c defects, A₀ frozen Jacobian, M metric, λ multipliers, δ step, α step
length, ν penalty of the defects in the merit J + ν ‖c‖₁.

    M δ + A₀ᵀ Δ + ζ = −α (∇J + ∇cᵀλ),    c + A₀ δ = 0,    λ⁺ = λ + Δ / α

is the gradient step projected on the linearised defects; the same solve restores feasibility and
gives the multipliers of equation (17). The full step is tried first, then with a correction of the
defects it leaves, then halves. A step is safe when the merit falls below the largest of the last
few (L. Grippo, F. Lampariello, S. Lucidi, SIAM J. Numer. Anal. 23, 1986), as Barzilai–Borwein steps
need.

The metric is frozen anew, and this alone, when four steps have not halved the error, when the
safeguard leaves less than an eighth of a step, and when it leaves none; where even a fresh metric
gives no step, ten times more of the identity is added.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from skyknot.solvers.bounded_projection import BoundedProjection, Projection
from skyknot.solvers.descent import Errors, Iterate, Move
from skyknot.solvers.metric import Array, Metric
from skyknot.solvers.step_size import dot
from skyknot.status import Status

_LEAST_REGULARISATION = 1e-6
_MEMORY = 5  # merits that the next may not exceed
_PATIENCE = 4  # steps in which the error must halve
_DECREASE = 1e-4
_SHORTEST = 2.0**-12
_STALE = 0.125
_MOST_REGULARISATION = 1e6
_DIFFERENCE = 1e-6


class StructuredDescent:
    """See the module; duties in descent.py."""

    safeguarded = True
    ends_without_defects = False
    first_length: float | None = 1.0  # right where the metric is the Hessian

    def __init__(
        self, metric: Metric, multipliers: Array, tolerance: float, optimality_tolerance: float
    ) -> None:
        self.metric = metric
        self.why, self.why_status = "", Status.STALLED
        self._tolerances = tolerance, optimality_tolerance
        self._projection = BoundedProjection(metric, _LEAST_REGULARISATION)
        self._merits: deque[tuple[float, float]] = deque(maxlen=_MEMORY)
        self._errors: deque[float] = deque(maxlen=_PATIENCE + 1)
        self._penalty = 1.0
        self._stale = False
        self._start = Iterate(metric.differentiate(metric.start), multipliers)
        metric.freeze()

    @property
    def start(self) -> Iterate:
        """The first iterate; the metric is frozen there."""
        return self._start

    @property
    def regularisation(self) -> float:
        """Multiple of the identity in M."""
        return self._projection.regularisation

    @property
    def work(self) -> dict[str, int]:
        """How often the interior point was asked for an active set."""
        return {"interior_projections": self._projection.interior}

    def gradient(self, at: Iterate) -> Array:
        """Return ∇J + ∇cᵀλ, equation (17)."""
        return at.point.gradient + self.metric.adjoint(at.multipliers)

    def metric_times(self, step: Array) -> Array:
        """Return M s where s may move, 0 elsewhere."""
        moving = (self._projection.active == 0) & self.metric.moving
        return np.where(moving, self.metric.product(step)[0], 0.0)

    def tangent(self, at: Iterate, direction: Array) -> Array:
        """Return the direction projected on linearised defects and active bounds."""
        self._projection.hold()
        forces = -self.metric.product(direction)[0]
        return self.metric.solve(forces, np.zeros_like(at.multipliers))[0]

    def curvature(self, at: Iterate, direction: Array) -> Array:
        """Return M⁻¹∇²L v on the steps that defects and bounds leave."""
        metric = self.metric
        change = self._gradient_at(at, _DIFFERENCE * direction) - self._gradient_at(
            at, -_DIFFERENCE * direction
        )
        metric.differentiate(at.w)
        slope = change / (2.0 * _DIFFERENCE)
        return -metric.solve(slope, np.zeros_like(at.multipliers))[0]

    def advance(self, at: Iterate, gradient: Array, found: Errors, alpha: float) -> Move | None:
        """Return the projected step from an iterate, made safe."""
        if self._slow(found) or self._stale:
            self._renew(at)
        fresh = self._stale
        self._stale = False
        c = at.point.defects
        self._merits.append((at.point.objective, float(np.sum(np.abs(c)))))
        while self.regularisation < _MOST_REGULARISATION:
            projection = self._projection.project(at.w, alpha * gradient, c)
            move = self._safe(at, projection, alpha) if projection is not None else None
            if move is not None:
                self._stale = move.length < _STALE
                return move
            if fresh:
                more = 10.0 if projection is not None else 1000.0
                self._projection.regularisation = max(1e-4, more * self.regularisation)
                self._projection.forget()
            else:
                self._renew(at)
                fresh = True
        self.why = "No step along the projected gradient lowers the merit any more."
        if projection is None:
            self.why = "No step meets the linearised defects and all bounds."
            self.why_status = Status.INFEASIBLE
        return None

    def _slow(self, found: Errors) -> bool:
        """Return whether the last few steps have not halved the error, in tolerances."""
        self._errors.append(found.measure(*self._tolerances))
        return len(self._errors) > _PATIENCE and self._errors[-1] > 0.5 * self._errors[0]

    def _renew(self, at: Iterate) -> None:
        """Freeze the metric at an iterate; trials may have been evaluated since."""
        self.metric.differentiate(at.w)
        self.metric.freeze()
        self._projection.forget()
        self._projection.regularisation = max(
            _LEAST_REGULARISATION, 0.1 * self._projection.regularisation
        )
        self._errors.clear()
        self._stale = True

    def _safe(self, at: Iterate, found: Projection, alpha: float) -> Move | None:
        """Return the longest trial whose merit is low enough."""
        metric, c = self.metric, at.point.defects
        multipliers = at.multipliers + found.multipliers / alpha
        size = float(np.max(np.abs(multipliers), initial=0.0))
        self._penalty = nu = max(1.2 * size, 0.5 * self._penalty)
        highest = max(J + nu * norm for J, norm in self._merits)
        slope = dot(at.point.gradient, found.step) - found.share * nu * float(np.sum(np.abs(c)))
        length = 1.0
        while length >= _SHORTEST:
            limit = highest + _DECREASE * length * min(slope, 0.0) + 1e-12 * (1 + abs(highest))
            trial = self._onto_bounds(at.w + length * found.step)
            J, left = metric.evaluate(trial)
            if not J + nu * np.sum(np.abs(left)) <= limit and length == 1.0:
                trial = self._onto_bounds(trial + self._projection.restore(trial, left))
                J, left = metric.evaluate(trial)
            if J + nu * np.sum(np.abs(left)) <= limit:
                new = at.multipliers + length * found.multipliers / alpha
                before = at.point.gradient + metric.adjoint(new)
                to = Iterate(metric.differentiate(trial), new)
                return Move(to, trial - at.w, before, length)
            length *= 0.5
        return None

    def _onto_bounds(self, w: Array) -> Array:
        """Return w within its bounds, exactly on those it is a rounding away from."""
        metric = self.metric
        near = 1e-13 * (1.0 + np.abs(w))
        w = np.where(w <= metric.lower + near, metric.lower, w)
        return np.where(w >= metric.upper - near, metric.upper, w)

    def _gradient_at(self, at: Iterate, step: Array) -> Array:
        point = self.metric.differentiate(at.w + step)
        return point.gradient + self.metric.adjoint(at.multipliers)
