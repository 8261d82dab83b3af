"""A proved bound on how far the flight leaves the answer's polynomial within a segment.

The flight begins at the segment's first node and flies the answer's controls. Legend: N segments of
length h; r(t) = dx/dt − f(x, u) along the polynomial; e = flight − polynomial, |e| entry by entry;
|J| entries of |∂f/∂x| over everything that polynomial and flight can reach. Then
    d|e|/dt ≤ |r| + |J| |e|,  |e(0)| = 0,  so that  |e| ≤ exp(|J| h) ∫ |r| dt,
provided that the flight stays where |J| was taken: a box around the polynomial is assumed, and the
bound must come out inside it (the bound then holds from the start on, by continuity).

On a piece with place σ in [−1, 1], r differs from the chord through its ends by no more than
max |r″| (1 − σ²)/2, so that its mean is at most (|r(−1)| + |r(1)|)/2 + max |r″|/3, with r″ from
interval arithmetic, as in enclosures.py.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from skyknot.verification.enclosures import ROUNDING, Path, Pieces, boxes
from skyknot.verification.equations import Equations
from skyknot.verification.intervals import enclosed

Array = NDArray[np.float64]

DEEPEST = 4
"""Times that a piece may be split, in four parts each, while r″ decides; every segment is once."""

CLOSE = 1e-4
"""Share of a state's size, a second, that r″ may add to the residual without a further split."""

ROOM = 2.0
"""How much wider than expected the assumed box is; doubled until the bound fits, a few times."""

TRIES = 3
"""Boxes tried."""

TERMS = 12
"""Terms of the exponential series; what follows them is bounded by a geometric one."""


class Drift:
    """Residual and Jacobian of the dynamics along the answer's polynomials.

    Parameters
    ----------
    equations : of the problem
    states, controls : (N, d, nx), (N, m, nu) Chebyshev coefficients in τ
    times : (N+1,) nodes, s
    sizes : (nx,) sizes of the states: they bring the series of the exponential to one unit
    """

    def __init__(
        self, equations: Equations, states: Array, controls: Array, times: Array, sizes: Array
    ) -> None:
        self.nx, nu, self.sizes = states.shape[2], controls.shape[2], sizes
        degree = max(states.shape[1], controls.shape[1])
        padded = [np.pad(C, ((0, 0), (0, degree - C.shape[1]), (0, 0))) for C in (states, controls)]
        self.path = Path(np.concatenate(padded, axis=2), times)
        x, u, t, f = equations.rates_expression()
        y = ca.vertcat(x, u, t)
        v, a = ca.SX.sym("v", self.nx + nu + 1), ca.SX.sym("a", self.nx + nu + 1)
        first = ca.jtimes(f, y, v)
        second = ca.jtimes(first, ca.vertcat(y, v), ca.vertcat(v, a))
        self._rates = ca.Function("rates", [y], [f])
        self._second = ca.Function("second", [y, v, a], [ca.cse(ca.densify(second))])
        J = ca.densify(ca.jacobian(f, x))
        self._jacobian = ca.Function("jacobian", [y], [ca.cse(ca.vec(J))])

    def bound(self) -> Array:
        """Return (N, nx) proved bounds on |e|; infinite where the proof does not close.

        Raises
        ------
        NotImplementedError
            When the dynamics use an operation that has no interval form.
        """
        E = self.residual()
        low, high = boxes(self.path.local(self.path.whole()))
        with np.errstate(all="ignore"):
            assumed = ROOM * self._carried(self._slopes(low, high), E) + ROUNDING
            proved = np.full_like(E, np.inf)
            for _ in range(TRIES):
                wide = [side.copy() for side in (low, high)]
                wide[0][:, : self.nx] -= assumed
                wide[1][:, : self.nx] += assumed
                found = self._carried(self._slopes(*wide), E)
                fits = np.all(found <= assumed, axis=1)
                proved[fits] = np.minimum(proved[fits], found[fits])
                if np.all(fits):
                    break
                assumed = np.where(fits[:, None], assumed, ROOM * np.maximum(assumed, found))
        return proved

    def residual(self) -> Array:
        """Return (N, nx) proved bounds on ∫ |dx/dt − f| dt over every segment."""
        total = np.zeros((len(self.path.h), self.nx))
        pieces = self.path.whole()
        for depth in range(DEEPEST + 1):
            ends, bend = self._on(pieces)
            length = self.path.h[pieces.segment] * (pieces.end - pieces.start)
            coarse = np.any((bend > ends) & (bend > CLOSE * self.sizes), axis=1)
            split = (coarse | (depth == 0)) & (depth < DEEPEST)
            done = length[:, None] * (ends + bend) * (1 + ROUNDING)
            np.add.at(total, pieces.segment[~split], done[~split])
            if not np.any(split):
                break
            pieces = pieces.split(split)
        return total

    def _on(self, pieces: Pieces) -> tuple[Array, Array]:
        """Return the mean of |r| at both ends of pieces, and max |r″| / 3: they bound its mean."""
        half = 0.5 * self.path.h[pieces.segment] * (pieces.end - pieces.start)
        C = self.path.local(pieces)
        derivatives = [np.asarray(chebyshev.chebder(C, m, axis=1), dtype=float) for m in (1, 2, 3)]
        enclosing = [boxes(each) for each in (C, *derivatives[:2])]
        ((least, most),) = enclosed(
            self._second, *(list(side) for side in zip(*enclosing, strict=True))
        )
        third = [side[:, : self.nx] / half[:, None] for side in boxes(derivatives[2])]
        bend = np.maximum(np.abs(third[0] - most), np.abs(third[1] - least))
        at_ends = [self._residual_at(C, derivatives[0], half, sigma) for sigma in (-1.0, 1.0)]
        return 0.5 * (at_ends[0] + at_ends[1]), bend / 3

    def _residual_at(self, C: Array, slopes: Array, half: Array, sigma: float) -> Array:
        """Return (M, nx) |r| at one end of every piece, rounded up."""
        Y, V = (
            np.einsum("j,mjy->my", chebyshev.chebvander(sigma, each.shape[1] - 1).ravel(), each)
            for each in (C, slopes)
        )
        f = np.array(self._rates.map(len(Y))(Y.T).full()).T
        rate = V[:, : self.nx] / half[:, None]
        result: Array = np.abs(rate - f) + ROUNDING * (np.abs(rate) + np.abs(f))
        return result

    def _slopes(self, low: Array, high: Array) -> Array:
        """Return (N, nx, nx) bounds on |∂f/∂x| over boxes."""
        ((least, most),) = enclosed(self._jacobian, [low], [high])
        largest = np.maximum(np.abs(least), np.abs(most))
        return largest.reshape(-1, self.nx, self.nx).transpose(0, 2, 1)

    def _carried(self, J: Array, E: Array) -> Array:
        """Return (N, nx) at least exp(J h) E for J (N, nx, nx) without negative entries."""
        h, sizes = self.path.h, self.sizes
        scaled = J * sizes / sizes[:, None]
        total = term = E / sizes
        for order in range(1, TERMS + 1):
            term = h[:, None] / order * np.einsum("kij,kj->ki", scaled, term)
            total = total + term
        ratio = h * np.max(np.sum(scaled, axis=2), axis=1) / (TERMS + 1)
        rest = np.where(ratio < 1, np.max(term, axis=1) * ratio / (1 - ratio), np.inf)
        result: Array = (total * (1 + ROUNDING) + rest[:, None]) * sizes
        return result
