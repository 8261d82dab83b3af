"""What the forms of the projected gradient share: iterates, moves and errors.

Legend: w scaled unknowns, λ multipliers of the defects, ∇ gradient, L = J + λᵀc, M metric.

Duties of a form:
1. ``gradient`` is what line 4 of Algorithm 1 computes at an iterate, last differentiated.
2. ``advance`` does lines 5–7: update, projection and defects at the new iterate; None when no step
   can be taken, ``why`` then says why.
3. ``metric_times``, ``tangent`` and ``curvature`` serve the step-length rules: s → M s, any v → the
   nearest step the form may take, and v → M⁻¹∇²L v on such steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from skyknot.solvers.metric import Array, Metric, Point
from skyknot.status import Status


@dataclass(frozen=True)
class Iterate:
    """A point with the multipliers that belong to it."""

    point: Point
    multipliers: Array

    @property
    def w(self) -> Array:
        """(n,) scaled unknowns."""
        return self.point.w


@dataclass(frozen=True)
class Move:
    """A step taken.

    Attributes
    ----------
    to : the new iterate
    step : (n,) s
    before : (n,) gradient at the old point with the new multipliers, for the change y
    length : share of the projected step that the safeguard left
    """

    to: Iterate
    step: Array
    before: Array
    length: float = 1.0


@dataclass(frozen=True)
class Errors:
    """Largest entries, unscaled: defects (19), violation of bounds, optimality (20)."""

    defect: float
    outside: float
    optimality: float

    @property
    def primal(self) -> float:
        """The larger of defects and violation of bounds."""
        return max(self.defect, self.outside)

    def measure(self, tolerance: float, optimality: float) -> float:
        """Return the largest error in tolerances; not above 1 at a solution."""
        return max(self.primal / tolerance, self.optimality / optimality)


class Form(Protocol):
    """One form of the projected gradient; see the module's numbered duties.

    Attributes
    ----------
    why, why_status : why no step can be taken, and what that is called
    safeguarded : whether an unstable step length is cut before it does harm
    ends_without_defects : whether it stops, as line 8 does, once the defects are small
    first_length : step length where no step has been taken; None for the best along the gradient
    """

    metric: Metric
    why: str
    why_status: Status

    safeguarded: bool
    ends_without_defects: bool
    first_length: float | None

    @property
    def start(self) -> Iterate:
        """The first iterate."""

    @property
    def regularisation(self) -> float:
        """Multiple of the identity in the metric."""

    @property
    def work(self) -> dict[str, int]:
        """Counts of the form's own."""

    def gradient(self, at: Iterate) -> Array:
        """Return the gradient of line 4, (n,) in scaled unknowns."""

    def advance(self, at: Iterate, gradient: Array, found: Errors, alpha: float) -> Move | None:
        """Return the move of lines 5–7 from an iterate, given the errors found there."""

    def metric_times(self, step: Array) -> Array:
        """Return M s."""

    def tangent(self, at: Iterate, direction: Array) -> Array:
        """Return the step nearest to a direction that the form may take."""

    def curvature(self, at: Iterate, direction: Array) -> Array:
        """Return M⁻¹∇²L v, by differences of the gradient."""


def errors(metric: Metric, at: Iterate, gradient: Array) -> Errors:
    """Return the errors that Algorithm 1 is judged by."""
    outside = np.maximum(metric.lower - at.w, at.w - metric.upper)  # 0 where there is no unknown
    return Errors(
        defect=largest(at.point.defects * metric.defect_scale),
        outside=max(0.0, float(np.max(outside * metric.scale))),
        optimality=largest(projected(metric, at.w, gradient) / metric.scale),
    )


def projected(metric: Metric, w: Array, gradient: Array) -> Array:
    """Return the gradient without what bounds hold: fixed unknowns, outward pulls at bounds."""
    inward = np.where(w <= metric.lower, np.minimum(gradient, 0.0), gradient)
    inward = np.where(w >= metric.upper, np.maximum(inward, 0.0), inward)
    return np.where(metric.moving, inward, 0.0)


def largest(values: Array) -> float:
    """Return the largest entry's size; NaN when one is."""
    return float(np.max(np.abs(values), initial=0.0))
