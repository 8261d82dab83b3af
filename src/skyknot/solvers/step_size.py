"""Step lengths: Barzilai–Borwein's, and what a fixed one must satisfy.

Legend: s = z_k − z_{k−1}, y = ∇_k − ∇_{k−1} change of the gradient, M metric, H = ∇²L.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHORTEST, LONGEST = 1e-8, 1e4
"""Limits of a Barzilai–Borwein step."""


def dot(a: Array, b: Array) -> float:
    """Return aᵀb without BLAS, whose threads wait for one another on a busy machine."""
    return float(np.einsum("i,i->", a, b))


def barzilai_borwein(s: Array, y: Array, Ms: Array, last: float) -> float:
    """Return α = sᵀMs / sᵀy, equation (18) of the source report in the metric M.

    J. Barzilai, J. M. Borwein, "Two-point step size gradient methods", IMA J. Numer. Anal. 8
    (1988). 1/α lies between the least and the largest eigenvalue of M⁻¹H. Along a direction
    without positive curvature the step grows tenfold.

    Parameters
    ----------
    s, y : (n,) last step and change of the gradient
    Ms : (n,) the metric times s; s itself in the plain metric
    last : step length before, used where (18) has no positive value
    """
    curvature = dot(s, y)
    alpha = dot(s, Ms) / curvature if curvature > 0.0 else 10.0 * last
    return float(np.clip(alpha, SHORTEST, LONGEST))


def spectral_norm(
    curvature: Callable[[Array], Array],
    norm: Callable[[Array], float],
    tangent: Callable[[Array], Array],
    start: Array,
    alpha: float,
    rounds: int = 60,
) -> float:
    """Return ‖I − α M⁻¹H‖ by power iteration, the left side of equation (15).

    Parameters
    ----------
    curvature : v → M⁻¹H v
    norm : the metric's norm, in which I − α M⁻¹H is symmetric
    tangent : v → the nearest of the steps on which the norm is taken, against rounding
    start : (n,) where the iteration begins; generic
    alpha : fixed step length
    rounds : products with H at most; fewer once the value changes by less than 1e-6
    """
    v, value = tangent(start), 0.0
    if norm(v) == 0.0:
        return 0.0
    v = v / norm(v)
    for _ in range(rounds):
        image = tangent(v - alpha * curvature(v))
        before, value = value, norm(image)
        if value == 0.0 or not np.isfinite(value) or abs(value - before) < 1e-6 * value:
            return value
        v = image / value
    return value


def cauchy_length(direction: Array, Md: Array, curved: Array) -> float:
    """Return dᵀMd / dᵀHd, the first step length along d where no step has been taken.

    Parameters
    ----------
    direction, Md, curved : (n,) d, M d and H d
    """
    curvature = dot(direction, curved)
    alpha = dot(direction, Md) / curvature if curvature > 0.0 else 1.0
    return float(np.clip(alpha, SHORTEST, LONGEST))
