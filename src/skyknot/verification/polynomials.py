"""Polynomials through values inside a segment, by their Chebyshev coefficients.

Legend: τ in [0, 1] the place inside a segment, s = 2τ − 1; V_ij = T_j(s_i); a polynomial is
Σ_j c_j T_j(s). Stable at any number of collocation points, which monomials are not. (The trajectory
reads itself by Lagrange polynomials; this is the second road.)
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

Array = NDArray[np.float64]


def coefficients(points: Array, values: Array) -> Array:
    """Return (N, s, n) coefficients c_j of the polynomials through values (N, s, n) at (s,)."""
    V = chebyshev.chebvander(2 * points - 1, len(points) - 1)
    result: Array = np.einsum("js,ksn->kjn", np.linalg.inv(V), values)
    return result


def evaluated(C: Array, tau: Array) -> Array:
    """Return (N, M, n) values of the polynomials (N, s, n) at places tau (M,)."""
    V = chebyshev.chebvander(2 * tau - 1, C.shape[1] - 1)
    result: Array = np.einsum("mj,kjn->kmn", V, C)
    return result


def cardinal(points: Array, tau: Array) -> Array:
    """Return (M, s): the value at places tau (M,) as a sum of values at points (s,)."""
    identity = np.eye(len(points))[None]
    result: Array = evaluated(coefficients(points, identity), tau)[0]
    return result


def integrated(C: Array) -> Array:
    """Return (N, s + 1, n) coefficients of the integrals over τ from 0."""
    return np.asarray(chebyshev.chebint(C, lbnd=-1, scl=0.5, axis=1), dtype=np.float64)


def differentiated(C: Array) -> Array:
    """Return (N, max(s − 1, 1), n) coefficients of the derivatives by τ."""
    return np.asarray(chebyshev.chebder(C, scl=2, axis=1), dtype=np.float64)
