"""How a scheme treats ẋ = λx: its stability function, region, A- and L-stability.

Legend: z = hλ, R(z) = x_{k+1}/x_k, rows C x + z A x = 0 of the scheme; 𝒜, b Butcher's tableau over
the points where a rate is used, μ eigenvalues of 𝒜, ν those of 𝒜 − 1bᵀ.

    R(z) = det(I − z𝒜 + z1bᵀ)/det(I − z𝒜) = Π(1 − ν_i z)/Π(1 − μ_i z)
(Hairer & Wanner, Solving Ordinary Differential Equations II, proposition IV.3.2.)
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

AXIS = np.concatenate([[0.0], np.geomspace(1e-3, 1e6, 4001)])
"""Places y at which |R(iy)| ≤ 1 is looked at; R(i∞) besides."""

ROUNDING = 1e-9
"""How far |R| may pass 1 on the axis by rounding."""


@dataclass(frozen=True)
class Stability:
    """The stability function of a scheme; ``stability(z)`` is R(z) for z of any shape.

    Attributes
    ----------
    C, A : (s−1, s) rows of the scheme
    """

    C: Array = field(repr=False)
    A: Array = field(repr=False)

    def __call__(self, z: ArrayLike) -> Complex:
        """Return R(z), of the shape of z; infinite at a pole."""
        at = np.asarray(z, dtype=np.complex128)
        rows = self.C + at[..., None, None] * self.A
        try:
            solved = np.linalg.solve(rows[..., 1:], -rows[..., :1])[..., -1, 0]
        except np.linalg.LinAlgError:
            return self._by_roots(at)
        return np.asarray(solved, dtype=np.complex128)

    def _by_roots(self, z: Complex) -> Complex:
        mu, nu = self._eigenvalues
        above, below = (np.prod(1 - z[..., None] * each, axis=-1) for each in (nu, mu))
        known = below != 0
        result: Complex = np.where(known, above / np.where(known, below, 1.0), np.inf + 0j)
        return result

    @property
    def poles(self) -> Complex:
        """Poles of R."""
        return 1 / self._eigenvalues[0]

    @property
    def zeros(self) -> Complex:
        """Zeros of R."""
        return 1 / self._eigenvalues[1]

    @property
    def denominator(self) -> Array:
        """Coefficients of 1, z, z² and so on in Π(1 − μ_i z)."""
        return np.atleast_1d(np.real(np.poly(self._eigenvalues[0])))

    @property
    def numerator(self) -> Array:
        """Coefficients of 1, z, z² and so on in Π(1 − ν_i z)."""
        return np.atleast_1d(np.real(np.poly(self._eigenvalues[1])))

    @property
    def at_infinity(self) -> float:
        """R(∞): 0 where stiff modes die at once, infinite for explicit schemes."""
        mu, nu = self._eigenvalues
        if len(mu) != len(nu):
            return 0.0 if len(mu) > len(nu) else float("inf")
        return float(np.real(np.prod(nu / mu)))

    @cached_property
    def axis_excess(self) -> float:
        """Largest |R(iy)| − 1 found on the imaginary axis, infinity included."""
        return max(float(np.max(np.abs(self(1j * AXIS)))), abs(self.at_infinity)) - 1

    @property
    def a_stable(self) -> bool:
        """Whether |R| ≤ 1 in the left half plane.

        By the maximum principle that holds where |R(iy)| ≤ 1 and all poles lie in the right half
        plane (Hairer & Wanner II, IV.3). The axis is sampled, the poles are eigenvalues.
        """
        return self.axis_excess <= ROUNDING and bool(np.all(np.real(self.poles) > 0))

    @property
    def l_stable(self) -> bool:
        """Whether it is A-stable and R(∞) = 0: stiff modes are damped, not only kept."""
        return self.a_stable and self.at_infinity == 0.0

    def region(self, real: ArrayLike, imaginary: ArrayLike) -> Array:
        """Return |R| on a grid, (len(imaginary), len(real)); the stability region is |R| ≤ 1."""
        return np.abs(self(np.asarray(real)[None, :] + 1j * np.asarray(imaginary)[:, None]))

    @cached_property
    def _eigenvalues(self) -> tuple[Complex, Complex]:
        """Eigenvalues of 𝒜 and of 𝒜 − 1bᵀ that are not zero."""
        used = np.flatnonzero(np.any(self.A != 0, axis=0))
        tableau = np.zeros((self.A.shape[1],) * 2)
        tableau[1:] = np.linalg.solve(-self.C[:, 1:], self.A)
        square = tableau[np.ix_(used, used)]
        found = [np.linalg.eigvals(square - shift) for shift in (0.0, tableau[-1, used][None, :])]
        mu, nu = (each[np.abs(each) > 1e-12].astype(complex) for each in found)
        return mu, nu


def iteration_matrix_norm(H: ArrayLike, alpha: float) -> float:
    """Return ‖I − αH‖ in the Euclidean norm, the left side of equation (15) of the source report.

    Below 1 a descent with the fixed step α converges on a quadratic with Hessian H; that asks for
    0 < α < 2/λ_max(H) and H positive definite.

    Parameters
    ----------
    H : (n, n) symmetric Hessian, or (n,) its diagonal
    alpha : step length
    """
    H = np.asarray(H, dtype=float)
    eigenvalues = H if H.ndim == 1 else np.linalg.eigvalsh(H)
    return float(np.max(np.abs(1 - alpha * eigenvalues)))
