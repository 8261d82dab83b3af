"""Polynomials through values inside a segment, by their coefficients.

Legend: τ in [0, 1] the place inside a segment; V the Vandermonde matrix, V_ij = τ_i^j; a polynomial
is Σ_j c_j τ^j. (The trajectory reads itself by Lagrange polynomials; this is the second road.)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def coefficients(points: Array, values: Array) -> Array:
    """Return (N, s, n) coefficients c_j of the polynomials through values (N, s, n) at (s,)."""
    V = np.vander(points, increasing=True)
    result: Array = np.einsum("js,ksn->kjn", np.linalg.inv(V), values)
    return result


def evaluated(C: Array, tau: Array) -> Array:
    """Return (N, M, n) values of the polynomials (N, s, n) at places tau (M,)."""
    powers = tau[:, None] ** np.arange(C.shape[1])
    result: Array = np.einsum("mj,kjn->kmn", powers, C)
    return result


def integrated(C: Array) -> Array:
    """Return (N, s + 1, n) coefficients of the integrals from 0."""
    degrees = np.arange(1, C.shape[1] + 1)
    return np.concatenate([np.zeros_like(C[:, :1]), C / degrees[None, :, None]], axis=1)


def differentiated(C: Array) -> Array:
    """Return (N, max(s − 1, 1), n) coefficients of the derivatives."""
    if C.shape[1] == 1:
        return np.zeros_like(C)
    return C[:, 1:] * np.arange(1, C.shape[1])[None, :, None]
