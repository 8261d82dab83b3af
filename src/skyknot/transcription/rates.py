"""Bounds on du/dt as linear rows on the control values.

A linear control has one rate in a segment; the rate of a quadratic control is linear in the
segment, so bounding it at both ends bounds it everywhere (a cubic or higher one is bounded at its
control points). A held control jumps: the jump is bounded by the rate times the time between the
middles of the two segments. Polynomials that may jump at the nodes have no rate there.
"""

from __future__ import annotations

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
        places = {2: points[:1], 3: points[[0, -1]]}.get(len(points), points)
        bases = np.repeat(layout.control, len(places), axis=0)
        weights = np.tile(derivative_weights(points, places), (len(fractions), 1))
        length = np.repeat(fractions, len(places))
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
