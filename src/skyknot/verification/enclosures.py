"""A guarantee between nodes: lower bounds of margins along the answer's own polynomials.

Legend: a piece is part of a segment, σ in [−1, 1] the place in it; x(σ) and t(σ) polynomials, v
and a their first and second derivatives by σ; G(σ) = g(x(σ), t(σ)) a margin, positive when kept.
If G'' ≤ K on the piece, then G lies above the chord through its ends by no less than −K/2:
    G(σ) ≥ min(G(−1), G(1)) − max(K, 0)/2.
K comes from interval arithmetic on G'', so that the bound holds for every σ and not for samples
only; its excess falls with the square of the piece, and pieces that need it are split.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from skyknot.verification.equations import Equations
from skyknot.verification.intervals import enclosed

Array = NDArray[np.float64]

SPLIT = 4
"""Parts that a piece is split into."""

DEEPEST = 6
"""Times that a piece may be split: down to a four-thousandth of a segment."""

ROUNDING = 1e-12
"""Share by which values at the ends of pieces are lowered, for the rounding in computing them."""


@dataclass(frozen=True)
class Pieces:
    """Parts of segments.

    Attributes
    ----------
    segment : (M,) index, start and end : (M,) τ in that segment
    """

    segment: NDArray[np.intp]
    start: Array
    end: Array

    def split(self, chosen: NDArray[np.bool_]) -> Pieces:
        """Return the chosen pieces, each in equal parts."""
        low, high = self.start[chosen, None], self.end[chosen, None]
        shares = np.arange(SPLIT + 1) / SPLIT
        cuts = low + (high - low) * shares
        segment = np.repeat(self.segment[chosen], SPLIT)
        return Pieces(segment, cuts[:, :-1].ravel(), cuts[:, 1:].ravel())


class Path:
    """The answer's state polynomials, enclosed piece by piece.

    Parameters
    ----------
    C : (N, d, nx) Chebyshev coefficients in τ of the states
    times : (N+1,) nodes, s
    """

    def __init__(self, C: Array, times: Array) -> None:
        self.C, self.times, self.h = C, times, np.diff(times)

    def whole(self) -> Pieces:
        """Return every segment as one piece."""
        N = len(self.h)
        return Pieces(np.arange(N), np.zeros(N), np.ones(N))

    def local(self, pieces: Pieces) -> Array:
        """Return (M, d, nx + 1) Chebyshev coefficients in σ of x and t; exact up to rounding."""
        d = max(self.C.shape[1], 2)
        angles = np.pi * (np.arange(d) + 0.5) / d
        sigma = np.cos(angles)
        tau = pieces.start[:, None] + 0.5 * (pieces.end - pieces.start)[:, None] * (sigma + 1)
        V = chebyshev.chebvander(2 * tau - 1, self.C.shape[1] - 1)
        values = np.einsum("mpj,mjx->mpx", V, self.C[pieces.segment])
        t = self.times[pieces.segment, None] + self.h[pieces.segment, None] * tau
        values = np.concatenate([values, t[:, :, None]], axis=2)
        inverse = np.linalg.inv(chebyshev.chebvander(sigma, d - 1))
        result: Array = np.einsum("jp,mpx->mjx", inverse, values)
        return result

    def ends(self, pieces: Pieces) -> tuple[Array, Array]:
        """Return (2M, nx) states and (2M,) times at the starts, then the ends of pieces."""
        tau = np.concatenate([pieces.start, pieces.end])
        segment = np.tile(pieces.segment, 2)
        V = chebyshev.chebvander(2 * tau - 1, self.C.shape[1] - 1)
        X = np.einsum("mj,mjx->mx", V, self.C[segment])
        return X, self.times[segment] + self.h[segment] * tau


def boxes(C: Array) -> tuple[Array, Array]:
    """Return (M, n) bounds of polynomials with Chebyshev coefficients (M, d, n): |T_j| ≤ 1."""
    spread = np.sum(np.abs(C[:, 1:]), axis=1) + ROUNDING * np.abs(C[:, 0])
    return C[:, 0] - spread, C[:, 0] + spread


class Margin:
    """One path constraint on states as a margin to keep, with what encloses it.

    Parameters
    ----------
    equations : of the problem
    index : which path constraint
    bound : its lower or upper bound
    sign : +1 for a lower bound, −1 for an upper one
    """

    def __init__(self, equations: Equations, index: int, bound: float, sign: float) -> None:
        x, t, g = equations.path_expression(index)
        nx = x.numel()
        G = sign * (g - bound)
        y, v, a = ca.vertcat(x, t), ca.SX.sym("v", nx + 1), ca.SX.sym("a", nx + 1)
        first = ca.jtimes(G, y, v)
        second = ca.jtimes(first, ca.vertcat(y, v), ca.vertcat(v, a))
        slope = ca.densify(ca.gradient(G, x))
        self._value = ca.Function("margin", [x, t], [G])
        self._second = ca.Function("second", [y, v, a], [ca.cse(second)])
        self._slope = ca.Function("slope", [y], [ca.cse(slope)])

    def values(self, X: Array, t: Array) -> Array:
        """Return (M,) margins at states (M, nx) and times (M,)."""
        found: Array = np.array(self._value.map(len(t))(X.T, t[None, :]).full()[0])
        lowered: Array = found - ROUNDING * np.abs(found)
        return lowered

    def bound(self, path: Path, pieces: Pieces) -> tuple[Array, Array]:
        """Return (M,) the least of both ends, and a lower bound over the whole piece."""
        X, t = path.ends(pieces)
        at_ends = self.values(X, t).reshape(2, -1).min(axis=0)
        C = path.local(pieces)
        derivatives = [np.asarray(chebyshev.chebder(C, m, axis=1), dtype=float) for m in (1, 2)]
        enclosing = [boxes(each) for each in (C, *derivatives)]
        ((_, K),) = enclosed(self._second, *(list(side) for side in zip(*enclosing, strict=True)))
        return at_ends, at_ends - 0.5 * np.maximum(K[:, 0], 0.0)

    def least(self, path: Path, enough: float, slack: float) -> Array:
        """Return (N,) a proved lower bound of the margin over every segment.

        Parameters
        ----------
        enough : margins proved to be larger than this are not refined
        slack : pieces are split until the proof is this close to the values at their ends
        """
        pieces = path.whole()
        proved = np.full(len(path.h), np.inf)
        for depth in range(DEEPEST + 1):
            at_ends, bound = self.bound(path, pieces)
            open_ = (bound < enough) & (at_ends - bound > slack) & (depth < DEEPEST)
            np.minimum.at(proved, pieces.segment[~open_], bound[~open_])
            if not np.any(open_):
                break
            pieces = pieces.split(open_)
        return proved

    def steepest(self, path: Path, around: Array) -> Array:
        """Return (N, nx) bounds on |∂g/∂x| over every segment and (N, nx) around its states."""
        low, high = boxes(path.local(path.whole()))
        low[:, :-1] -= around
        high[:, :-1] += around
        ((least, most),) = enclosed(self._slope, [low], [high])
        result: Array = np.maximum(np.abs(least), np.abs(most))
        return result
