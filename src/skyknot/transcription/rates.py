"""Bounds on du/dt as linear rows on the control values.

A linear control has one rate in a segment; the rate of a quadratic control is linear in the
segment, so bounding it at both ends bounds it everywhere (a cubic or higher one is bounded at its
control points). A held control jumps: the jump is
bounded by the rate times the time between the middles of the two segments.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.layout import Layout
from skyknot.kernel.program import RateRows
from skyknot.problem.problem import Problem

Array = NDArray[np.float64]


def rate_rows(problem: Problem, layout: Layout, fractions: Array, points: Array) -> RateRows:
    """Return the rate rows of the controls that have a finite bound."""
    bounded = np.flatnonzero(np.isfinite(problem.rate_lower) | np.isfinite(problem.rate_upper))
    if len(points) == 1:
        bases = np.stack([layout.control[:-1, 0], layout.control[1:, 0]], axis=1)
        weights = np.tile([-1.0, 1.0], (len(bases), 1))
        length = 0.5 * (fractions[:-1] + fractions[1:])
    else:
        places = np.array([0.0]) if len(points) == 2 else points[[0, -1]]
        places = points if len(points) > 3 else places
        derivative = derivative_weights(points, places)
        bases = np.repeat(layout.control, len(places), axis=0)
        weights = np.tile(derivative, (len(fractions), 1))
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
    """Return (len(places), m): derivatives at ``places`` of the Lagrange polynomials on points."""
    rows = []
    for place in places:
        row = []
        for i, p in enumerate(points):
            others = np.delete(points, i)
            terms = [
                np.prod([(place - q) for j, q in enumerate(others) if j != skip])
                for skip in range(len(others))
            ]
            row.append(sum(terms) / np.prod(p - others))
        rows.append(row)
    return np.array(rows)
