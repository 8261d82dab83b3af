"""Bounds on du/dt as linear rows on the control values.

A polynomial's rate is a polynomial of one degree less. Its Bernstein coefficients enclose it, so
that bounding them bounds the rate everywhere; of a linear or quadratic control they are the rates
at the ends, and nothing is given away (G. Farin, Curves and Surfaces for CAGD, chapter 5: the
convex hull property). A held control jumps: the jump is bounded by the rate times the time between
the middles of the two segments. Polynomials that may jump at the nodes have no rate there.
"""

from __future__ import annotations

from math import comb

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.kernel.layout import Layout
from skyknot.kernel.program import RateRows
from skyknot.problem.problem import Problem
from skyknot.trajectory import barycentric_weights, lagrange_basis

Array = NDArray[np.float64]


def rate_rows(
    problem: Problem, layout: Layout, fractions: Array, points: Array, shared: bool
) -> RateRows:
    """Return the rate rows of the controls that have a finite bound.

    Parameters
    ----------
    points, shared : places of the control values, and whether the ends belong to the nodes

    Raises
    ------
    UserError
        When a rate is bounded and the control may jump from one polynomial to the next.
    """
    bounded = np.flatnonzero(np.isfinite(problem.rate_lower) | np.isfinite(problem.rate_upper))
    if len(points) == 1:
        bases = np.stack([layout.control[:-1, 0], layout.control[1:, 0]], axis=1)
        weights = np.tile([-1.0, 1.0], (len(bases), 1))
        length = 0.5 * (fractions[:-1] + fractions[1:])
    else:
        if len(bounded) and not shared:
            raise _jumps(problem.control_names[bounded[0]])
        enclosing = enclosing_weights(points)
        bases = np.repeat(layout.control, len(enclosing), axis=0)
        weights = np.tile(enclosing, (len(fractions), 1))
        length = np.repeat(fractions, len(enclosing))
    rows = len(bases) * len(bounded)
    control = np.tile(bounded, len(bases))
    return RateRows(
        positions=np.repeat(bases, len(bounded), axis=0) + control[:, None],
        weights=np.repeat(weights, len(bounded), axis=0),
        length=np.repeat(length, len(bounded)),
        lower=problem.rate_lower[control].reshape(rows),
        upper=problem.rate_upper[control].reshape(rows),
        names=tuple(problem.control_names[i] for i in control),
    )


MOST_ENCLOSED = 16
"""Control values up to which Bernstein coefficients are well enough conditioned."""


def enclosing_weights(points: Array) -> Array:
    """Return (rows, m): combinations of the control values that enclose the rate on [0, 1].

    The rate's m − 1 Bernstein coefficients. Of more than ``MOST_ENCLOSED`` values they lose too
    many digits: there the rate itself, at four times as many places as it has coefficients.
    """
    n = len(points) - 2
    if len(points) > MOST_ENCLOSED:
        return derivative_weights(points, 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 4 * n + 5)))
    places = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, n + 1)) if n else np.zeros(1)
    j = np.arange(n + 1)
    binomials = np.array([comb(n, int(each)) for each in j], dtype=float)
    B = binomials * places[:, None] ** j * (1 - places[:, None]) ** (n - j)
    return np.asarray(np.linalg.solve(B, derivative_weights(points, places)), dtype=float)


def derivative_weights(points: Array, places: Array) -> Array:
    """Return (len(places), m): derivatives at ``places`` of the Lagrange polynomials on points.

    L_i' is a polynomial of lower degree, so that L_i'(t) = Σ_j L_j(t) L_i'(p_j) with the
    differentiation matrix of Berrut & Trefethen, SIAM Review 46 (2004) 501–517, section 9.3.
    """
    w, gaps = barycentric_weights(points), points[:, None] - points[None, :]
    np.fill_diagonal(gaps, 1.0)
    D = w[None, :] / w[:, None] / gaps
    np.fill_diagonal(D, 0.0)
    np.fill_diagonal(D, -D.sum(axis=1))
    return lagrange_basis(points, places) @ D


def _jumps(control: str) -> UserError:
    return UserError(
        "A control that may jump at the nodes has no rate there to bound.",
        where="controls",
        found=f"a bound on the rate of {control}, and polynomials that may jump",
        expected="controls continuous at the nodes",
        do="Use controls='linear', or Lobatto with controls='polynomial'.",
    )
