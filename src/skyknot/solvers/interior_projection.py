"""Projection on defects and bounds by a primal–dual interior point, from nothing known.

    minimise  rᵀδ + ½ δᵀMδ    subject to  d + A δ = 0,  low ≤ δ ≤ high

S. Mehrotra, "On the implementation of a primal-dual interior point method", SIAM J. Optim. 2
(1992): predictor and corrector on one factorisation.

Legend: s slacks, y multipliers of d + A δ, z multipliers of bounds (l lower, u upper), μ mean
product of the two, ρ = r + Mδ + Aᵀy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.solvers.metric import Array, Metric
from skyknot.solvers.step_size import dot

_MOST_ROUNDS = 40
_CLOSE = 1e-9  # of μ and of the defects, scaled
_STATIONARY = 1e-6
_DIVERGED = 1e10
_PUSH = 0.05  # start this share of the box inside it
_TO_BOUNDARY = 0.995


@dataclass
class _Box:
    """One side of all bounds: slacks and multipliers; 1 and 0 where there is no bound."""

    sign: float  # +1 at upper bounds
    bound: Array
    finite: NDArray[np.bool_]
    slack: Array
    multiplier: Array

    def place(self, step: Array) -> None:
        gap = self.sign * (self.bound - step)
        self.slack = np.where(self.finite, np.maximum(gap, 1e-14), 1.0)

    def change(self, step: Array, aim: Array | float) -> Array:
        """Return dz with (z + dz) s − sign z dδ = aim to first order."""
        dz = (aim + self.sign * self.multiplier * step) / self.slack - self.multiplier
        return np.where(self.finite, dz, 0.0)

    def longest(self, step: Array, dz: Array) -> float:
        """Return the step to the boundary of slacks and multipliers."""
        shrinking = [
            (self.sign * step, self.slack),
            (-dz, self.multiplier),
        ]
        most = 1.0
        for fall, room in shrinking:
            falls = self.finite & (fall > 0)
            most = min(most, float(np.min(room[falls] / fall[falls], initial=np.inf)))
        return most


@dataclass(frozen=True)
class Interior:
    """A projection found: step δ, multipliers y, and +1 or −1 at active upper or lower bounds."""

    step: Array
    multipliers: Array
    active: NDArray[np.int8]


def interior_projection(
    metric: Metric, r: Array, d: Array, low: Array, high: Array, regularisation: float
) -> Interior | None:
    """Return the projection; None when no step meets defects and bounds, or M is not definite."""
    free = metric.here & ~metric.fixed
    lower = _Box(-1.0, low, np.isfinite(low) & free, low, low)
    upper = _Box(1.0, high, np.isfinite(high) & free, high, high)
    boxes = (lower, upper)
    count = max(1, sum(int(box.finite.sum()) for box in boxes))
    step = _inside(lower, upper)
    for box in boxes:
        box.place(step)
        box.multiplier = np.where(box.finite, 1.0 / box.slack, 0.0)
    Md, Ad = metric.product(step)
    rho, defect, y = r + Md, d + Ad, np.zeros_like(d)
    for _ in range(_MOST_ROUNDS):
        mu = sum(dot(box.multiplier, box.slack) for box in boxes) / count
        dual = (rho - lower.multiplier + upper.multiplier)[free]
        size = float(np.max(np.abs(defect)))
        if not np.isfinite(mu + size) or np.max(np.abs(y)) > _DIVERGED:
            return None
        if mu < _CLOSE and size < _CLOSE and np.max(np.abs(dual), initial=0.0) < _STATIONARY:
            break
        weights = lower.multiplier / lower.slack + upper.multiplier / upper.slack
        if not metric.factor(metric.fixed, regularisation, weights):
            return None
        right, change, y_change, dz = _mehrotra(metric, boxes, rho, defect, mu, count)
        length = min(b.longest(change, c) for b, c in zip(boxes, dz, strict=True))
        length = min(1.0, _TO_BOUNDARY * length)
        Ad = metric.product(change)[1]
        rho = rho - length * (right + weights * change)
        defect, y, step = defect + length * Ad, y + length * y_change, step + length * change
        for box, c in zip(boxes, dz, strict=True):
            box.multiplier = box.multiplier + length * c
            box.place(step)
    if size > 1e-6 * (1.0 + np.max(np.abs(d))):
        return None
    active = np.zeros(len(step), dtype=np.int8)
    for box in boxes:
        active[box.finite & (box.multiplier > box.slack)] = int(box.sign)
    return Interior(step, y, active)


def _mehrotra(
    metric: Metric, boxes: tuple[_Box, _Box], rho: Array, defect: Array, mu: float, count: int
) -> tuple[Array, Array, Array, list[Array]]:
    """Return right-hand side, step, multipliers' change and the bounds' of the corrected step."""
    lower, upper = boxes

    def solve(aims: list[Array | float]) -> tuple[Array, Array, Array, list[Array]]:
        right = rho - np.where(lower.finite, aims[0] / lower.slack, 0.0)
        right = right + np.where(upper.finite, aims[1] / upper.slack, 0.0)
        change, y, _ = metric.solve(right, defect)
        return (
            right,
            change,
            y,
            [box.change(change, aim) for box, aim in zip(boxes, aims, strict=True)],
        )

    _, change, _, dz = solve([0.0, 0.0])
    length = min(1.0, *(b.longest(change, c) for b, c in zip(boxes, dz, strict=True)))
    reached = 0.0
    for box, c in zip(boxes, dz, strict=True):
        slack = box.slack - box.sign * length * change
        reached += float(np.sum(((box.multiplier + length * c) * slack)[box.finite]))
    aim = mu * (reached / count / mu) ** 3
    second = [aim + box.sign * c * change for box, c in zip(boxes, dz, strict=True)]
    return solve(list(second))


def _inside(lower: _Box, upper: _Box) -> Array:
    """Return the step nearest to none that stays off the bounds."""
    both = lower.finite & upper.finite
    span = np.where(both, upper.bound - lower.bound, 1.0)
    step = np.zeros(len(span))
    step = np.where(lower.finite, np.maximum(step, lower.bound + _PUSH * span), step)
    return np.where(upper.finite, np.minimum(step, upper.bound - _PUSH * span), step)
