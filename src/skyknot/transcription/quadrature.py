"""Collocation points and quadrature weights on [0, 1], for any number of points.

Legend: x in [−1, 1], τ = (1 + x)/2, P_n Legendre polynomial of degree n, s number of points.

Points are eigenvalues of a Jacobi matrix (Golub & Welsch, Math. Comp. 23 (1969) 221–230) polished
by Newton's method on the Legendre recurrence; weights follow from closed forms.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def lobatto(s: int) -> tuple[Array, Array]:
    """Return the s Legendre–Gauss–Lobatto points and weights, exact up to degree 2s − 3.

    The points are −1, the zeros of P'_{s−1} and 1; the weights 2 / (s (s−1) P_{s−1}(x)²).

    References
    ----------
    Abramowitz & Stegun, Handbook of Mathematical Functions, 25.4.32.
    """
    x = np.concatenate([[-1.0], _jacobi_zeros(s - 2, 1, 1), [1.0]])
    n = s - 1
    for _ in range(3):  # (1 − x²) P_n'' = 2x P_n' − n(n+1) P_n, so Newton needs P_n and P_{n−1}
        P, previous = _legendre(n, x[1:-1])
        slope = n * (previous - x[1:-1] * P) / (1 - x[1:-1] ** 2)
        curvature = (2 * x[1:-1] * slope - n * (n + 1) * P) / (1 - x[1:-1] ** 2)
        x[1:-1] -= slope / curvature
    x = 0.5 * (x - x[::-1])
    weights = 2 / (s * n * _legendre(n, x)[0] ** 2)
    return 0.5 * (1 + x), 0.5 * weights


def radau(s: int) -> tuple[Array, Array]:
    """Return the s Legendre–Gauss–Radau points that end at 1, and weights, exact to degree 2s − 2.

    The points are the zeros of P_s − P_{s−1}; the weights (1 + x)/(s P_{s−1}(x))², and 2/s² at 1.

    References
    ----------
    Abramowitz & Stegun, 25.4.31, mirrored; Hairer & Wanner, Solving ODEs II, IV.5 (Radau IIA).
    """
    x = np.append(_jacobi_zeros(s - 1, 1, 0), 1.0)
    inner = x[:-1]
    for _ in range(3):
        P, previous = _legendre(s, inner)
        before = _legendre(s - 1, inner)[1] if s > 1 else inner
        slope = s * (previous - inner * P) - (s - 1) * (before - inner * previous)
        inner = inner - (P - previous) * (1 - inner**2) / slope
    x[:-1] = inner
    weights = (1 + x) / (s * _legendre(s - 1, x)[0]) ** 2
    return 0.5 * (1 + x), 0.5 * weights


def chebyshev(s: int) -> tuple[Array, Array]:
    """Return the s Chebyshev–Gauss–Lobatto points and Clenshaw–Curtis weights.

    x_j = −cos(πj/n) with n = s − 1; w_j = (c_j/n)(1 − Σ_k b_k cos(2kjπ/n)/(4k² − 1)), k up to n/2,
    with b = 1 where 2k = n, else 2, and c = 1 at the ends, else 2. Exact up to degree s − 1, and
    s when s is odd.

    References
    ----------
    J. Waldvogel, BIT 46 (2006) 195–202, equation (2.4).
    """
    n = s - 1
    j, k = np.arange(s), np.arange(1, n // 2 + 1)
    b = np.where(2 * k == n, 1.0, 2.0)
    c = np.where((j == 0) | (j == n), 1.0, 2.0)
    angles = 2 * np.pi * ((k[None, :] * j[:, None]) % n) / n
    weights = c / n * (1 - np.cos(angles) @ (b / (4 * k**2 - 1.0)))
    points = np.sin(0.5 * np.pi * j / n) ** 2
    return 0.5 * (points + 1 - points[::-1]), 0.5 * weights


def _jacobi_zeros(n: int, a: int, b: int) -> Array:
    """Return the n zeros of the Jacobi polynomial P_n^{(a, b)}: eigenvalues of its matrix."""
    k = np.arange(n, dtype=float)
    total = 2 * k + a + b
    diagonal = np.where(total == 0, (b - a) / 2.0, 0.0)
    positive = total > 0
    diagonal[positive] = (b**2 - a**2) / (total[positive] * (total[positive] + 2))
    k, total = k[1:], total[1:]
    squares = 4 * k * (k + a) * (k + b) * (k + a + b) / (total**2 * (total + 1) * (total - 1))
    beside = np.sqrt(squares)
    result: Array = np.linalg.eigvalsh(np.diag(diagonal) + np.diag(beside, 1) + np.diag(beside, -1))
    return result


def _legendre(n: int, x: Array) -> tuple[Array, Array]:
    """Return P_n and P_{n−1} at x, by the three-term recurrence; P_{−1} = 0."""
    P, previous = np.ones_like(x), np.zeros_like(x)
    for k in range(1, n + 1):
        P, previous = ((2 * k - 1) * x * P - (k - 1) * previous) / k, P
    return P, previous
