"""The projected gradient in the plain metric: as printed, and with multipliers.

Legend: w scaled unknowns, z = S w, J cost, c defects, λ multipliers, ρ penalty, α step length, D
diagonal of the metric.

PrintedDescent is Algorithm 1 of the source report to the letter: z ← z − α∇J(z), controls clipped.
MultiplierDescent is its line 4 read with equation (17), as the method of multipliers:

    L(w; λ, ρ) = J + λᵀc + ½ρ ‖c‖²,    ∇L = ∇J + ∇cᵀ(λ + ρc),    λ ← λ + ρc

M. R. Hestenes, J. Optim. Theory Appl. 4 (1969); spectral projected gradients as in E. G. Birgin,
J. M. Martínez, M. Raydan, SIAM J. Optim. 10 (2000). The conditioning of L grows with ρ, and early
torques act on position through four integrations: it gains digits slowly.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from skyknot.solvers.descent import Errors, Iterate, Move, largest
from skyknot.solvers.metric import Array, Metric
from skyknot.solvers.step_size import dot
from skyknot.status import Status

_BLIND = (
    "Algorithm 1 as printed follows the gradient of the objective alone, which knows nothing of "
    "the defects nor of fixed states."
)
_DIFFERENCE = 1e-6
_DIVERGED = 1e12
_MEMORY = 10
_DECREASE = 1e-4
_SHORTEST = 2.0**-40
_INNER_STEPS = 2000  # at most between two updates of λ
_MOST_PENALTY = 1e3


class PrintedDescent:
    """Algorithm 1 to the letter; the gradient of J knows nothing of the defects."""

    safeguarded = False
    ends_without_defects = True
    regularisation = 0.0
    first_length: float | None = None

    def __init__(self, metric: Metric) -> None:
        self.metric = metric
        self.work: dict[str, int] = {}
        self.why, self.why_status = _BLIND, Status.STALLED
        self._D = np.where(metric.here, metric.scale**2, 1.0)
        self._start = Iterate(metric.differentiate(metric.start), metric.no_multipliers)

    @property
    def start(self) -> Iterate:
        """The first iterate."""
        return self._start

    def gradient(self, at: Iterate) -> Array:
        """Return ∇J; what w-entries of it mean for z is in the metric D = S²."""
        return at.point.gradient

    def metric_times(self, step: Array) -> Array:
        """Return D s."""
        return self._D * step

    def tangent(self, at: Iterate, direction: Array) -> Array:
        """Return the direction without controls at a bound."""
        metric = self.metric
        inside = (at.w > metric.lower) & (at.w < metric.upper)
        return np.where(inside | ~metric.controls, direction, 0.0)

    def curvature(self, at: Iterate, direction: Array) -> Array:
        """Return D⁻¹∇²J v."""
        ahead = self.metric.differentiate(at.w + _DIFFERENCE * direction).gradient
        change = ahead - self.metric.differentiate(at.w).gradient
        return change / _DIFFERENCE / self._D

    def advance(self, at: Iterate, gradient: Array, found: Errors, alpha: float) -> Move | None:  # noqa: ARG002
        """Return the move of lines 5 and 6; None when nothing moves or all of it diverges."""
        metric = self.metric
        w = at.w - alpha * gradient / self._D
        w = np.where(metric.controls, np.clip(w, metric.lower, metric.upper), w)
        if not largest(w) < _DIVERGED:
            self.why += f" The iterates diverge with the step length {alpha:.3g}."
            return None
        if np.array_equal(w, at.w):
            self.why += " It has vanished here, and the step changes no digit."
            return None
        return Move(Iterate(metric.differentiate(w), at.multipliers), w - at.w, gradient)


class MultiplierDescent:
    """The method of multipliers with projected gradient steps."""

    safeguarded = True
    ends_without_defects = False
    regularisation = 0.0
    first_length: float | None = None

    def __init__(
        self, metric: Metric, multipliers: Array, tolerance: float, optimality_tolerance: float
    ) -> None:
        self.metric = metric
        self.work: dict[str, int] = {}
        self.why, self.why_status = "", Status.STALLED
        self._multipliers, self._penalty = multipliers, 10.0
        self._tolerances = tolerance, optimality_tolerance
        self._inner_tolerance, self._inner, self._last_defect = 1.0, 0, np.inf
        self._values: deque[float] = deque(maxlen=_MEMORY)
        self._start = self._iterate(metric.start)

    @property
    def start(self) -> Iterate:
        """The first iterate."""
        return self._start

    def gradient(self, at: Iterate) -> Array:
        """Return ∇J + ∇cᵀ(λ + ρc), equation (17)."""
        return at.point.gradient + self.metric.adjoint(at.multipliers)

    def metric_times(self, step: Array) -> Array:
        """Return s."""
        return step

    def tangent(self, at: Iterate, direction: Array) -> Array:
        """Return the direction without fixed unknowns and those at a bound."""
        metric = self.metric
        moving = metric.moving & (at.w > metric.lower) & (at.w < metric.upper)
        return np.where(moving, direction, 0.0)

    def curvature(self, at: Iterate, direction: Array) -> Array:
        """Return ∇²L v."""
        ahead = self.gradient(self._iterate(at.w + _DIFFERENCE * direction))
        return (ahead - self.gradient(self._iterate(at.w))) / _DIFFERENCE

    def advance(self, at: Iterate, gradient: Array, found: Errors, alpha: float) -> Move | None:
        """Return a projected gradient step on L, after an update of λ when it is due."""
        metric = self.metric
        if found.optimality <= self._inner_tolerance or self._inner >= _INNER_STEPS:
            self._update(at, found)
            at = self._iterate(at.w)
            gradient = self.gradient(at)
        self._inner += 1
        step = np.clip(at.w - alpha * gradient, metric.lower, metric.upper) - at.w
        slope = dot(gradient, step)
        self._values.append(self._value(at.point.objective, at.point.defects))
        length = 1.0
        while length >= _SHORTEST:
            trial = np.clip(at.w + length * step, metric.lower, metric.upper)
            if (
                self._value(*metric.evaluate(trial))
                <= max(self._values) + length * _DECREASE * slope
            ):
                return Move(self._iterate(trial), trial - at.w, gradient, length)
            length *= 0.5
        self.why = "No step lowers the augmented Lagrangian any more."
        return None

    def _iterate(self, w: Array) -> Iterate:
        point = self.metric.differentiate(w)
        return Iterate(point, self._multipliers + self._penalty * point.defects)

    def _value(self, J: float, c: Array) -> float:
        return J + float(np.sum(self._multipliers * c) + 0.5 * self._penalty * np.sum(c * c))

    def _update(self, at: Iterate, found: Errors) -> None:
        """λ ← λ + ρc; a larger ρ where the defects have not fallen to a quarter."""
        tolerance, optimality = self._tolerances
        self._multipliers = at.multipliers
        if found.defect > max(0.25 * self._last_defect, 0.1 * tolerance):
            self._penalty = min(10.0 * self._penalty, _MOST_PENALTY)
        self._last_defect = found.defect
        self._inner = 0
        self._inner_tolerance = max(0.3 * self._inner_tolerance, 0.5 * optimality)
        self._values.clear()
