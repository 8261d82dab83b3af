"""Projection of a gradient step on linearised defects and bounds, in the frozen metric.

    minimise  rᵀδ + ½ δᵀMδ    subject to  d + A δ = 0,  lower ≤ w + δ ≤ upper

Two metrics as in D. P. Bertsekas, "Projected Newton methods for optimization problems with simple
constraints", SIAM J. Control Optim. 20 (1982): unknowns at a bound whose multiplier pushes outward
are frozen there, the others move in the metric M. Frozen unknowns are rows held in the same Riccati
factorisation, which therefore stays as it is while the active set does. A set whose changes grow,
or do not cease in a few rounds, is found by an interior point first.

Legend: w scaled unknowns, δ step, r gradient, d defects, ζ multipliers of the bounds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.solvers.interior_projection import interior_projection
from skyknot.solvers.metric import Array, Metric

_ROUNDS = 12  # of the active set before the interior point is asked
_WORSE = 2.0  # growth of its changes from round to round after which it is asked at once
_OUTSIDE = 1e-10  # scaled
_WRONG_SIGN = 1e-9  # scaled
_SHARES = (1.0, 0.3, 0.1, 0.03, 0.01)
_MOST_REGULARISATION = 1e10


@dataclass(frozen=True)
class Projection:
    """A projected step.

    Attributes
    ----------
    step : (n,) δ, multipliers : λ's change, share : of the defects that δ removes
    """

    step: Array
    multipliers: Array
    share: float


class BoundedProjection:
    """Projects in a metric, remembering the active set and its factorisation.

    Attributes
    ----------
    active : (n,) +1 at active upper bounds, −1 at active lower ones
    regularisation : multiple of the identity in M
    pinned : whether the factorisation at hand is that of the active set
    interior : how often the interior point was asked
    """

    def __init__(self, metric: Metric, regularisation: float) -> None:
        self._metric = metric
        self.regularisation = regularisation
        self.active = np.zeros(len(metric.start), dtype=np.int8)
        self.pinned = False
        self.interior = 0

    def forget(self) -> None:
        """Factor anew next time: the frozen matrix is another."""
        self.pinned = False

    def hold(self) -> bool:
        """Factor for the active set unless that is at hand; more identity until M is definite."""
        metric = self._metric
        while not self.pinned:
            held = (self.active != 0) | metric.fixed
            self.pinned = metric.factor(held, self.regularisation)
            if not self.pinned:
                self.regularisation = max(1e-4, 4.0 * self.regularisation)
                if self.regularisation > _MOST_REGULARISATION:
                    return False
        return True

    def project(self, w: Array, r: Array, d: Array) -> Projection | None:
        """Return the projected step from w; None when no share of the defects can be removed."""
        settled = self._settle(w, r, d)
        if settled is not None:
            return Projection(*settled, 1.0)
        for share in _SHARES:
            self.interior += 1
            self.pinned = False
            metric = self._metric
            low, high = metric.lower - w, metric.upper - w
            found = interior_projection(metric, r, share * d, low, high, self.regularisation)
            if found is None:
                continue
            self.active = found.active
            settled = self._settle(w, r, share * d)
            if settled is not None:
                return Projection(*settled, share)
            self.active, self.pinned = found.active, False
            return Projection(found.step, found.multipliers, share)
        self.active[:] = 0
        return None

    def restore(self, w: Array, defects: Array) -> Array:
        """Return the step that removes defects with the frozen Jacobian, inside the bounds."""
        metric = self._metric
        if not self.pinned:
            return np.zeros_like(w)
        step = metric.solve(np.zeros_like(w), defects)[0]
        return np.clip(w + step, metric.lower, metric.upper) - w

    def _settle(self, w: Array, r: Array, d: Array) -> tuple[Array, Array] | None:
        """Return step and multipliers when the active set settles; None when it does not."""
        metric = self._metric
        low, high = metric.lower - w, metric.upper - w
        most = np.inf
        for _ in range(_ROUNDS):
            if not self.hold():
                return None
            moved = np.where(self.active > 0, high, np.where(self.active < 0, low, 0.0))
            if moved.any():
                Mm, Am = metric.product(moved)
                step, multipliers, forces = metric.solve(r + Mm, d + Am)
                step += moved
            else:
                step, multipliers, forces = metric.solve(r, d)
            active = self._next_active(step, forces, low, high)
            changes = np.count_nonzero(active != self.active)
            if not changes:
                return np.clip(step, low, high), multipliers
            self.active, self.pinned = active, False
            if changes > most:
                return None
            most = _WORSE * changes
        return None

    def _next_active(self, step: Array, forces: Array, low: Array, high: Array) -> NDArray[np.int8]:
        """Release what is pulled inward, freeze what would leave its bounds."""
        active = self.active
        released = active * forces < -_WRONG_SIGN
        result: NDArray[np.int8] = np.where(released, 0, active).astype(np.int8)
        free = (active == 0) & ~self._metric.fixed
        result[free & (step > high + _OUTSIDE)] = 1
        result[free & (step < low - _OUTSIDE)] = -1
        return result
