"""The partition of the horizon into segments."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from skyknot.errors import UserError

Array = NDArray[np.float64]


def uniform(segments: int) -> Array:
    """Return the (N+1,) nodes of N equal segments, as fractions of the horizon."""
    if not isinstance(segments, int | np.integer) or segments < 1:
        raise UserError(
            "A mesh needs at least one segment.",
            where="segments",
            found=segments,
            expected="a whole number, 1 or more",
            do="Give the number of segments, e.g. 100.",
        )
    return np.linspace(0.0, 1.0, int(segments) + 1)


def checked(nodes: ArrayLike) -> Array:
    """Return nodes given as fractions of the horizon, after checking that they increase 0 → 1."""
    fractions = np.asarray(nodes, dtype=float)
    inside = fractions.ndim == 1 and len(fractions) >= 2
    if not inside or abs(fractions[0]) > 1e-12 or abs(fractions[-1] - 1) > 1e-12:
        raise UserError(
            "The mesh does not cover the horizon.",
            where="mesh",
            found=f"{fractions[:1]} … {fractions[-1:]}",
            expected="fractions of the horizon from 0 to 1",
            do="Divide the node times by the duration.",
        )
    if not np.all(np.diff(fractions) > 0):
        raise UserError(
            "The nodes of the mesh do not increase.",
            where="mesh",
            found=f"smallest step {np.diff(fractions).min():g}",
            expected="increasing fractions",
            do="Sort the nodes and drop repeated ones.",
        )
    return fractions


def with_nodes_at(nodes: Array, places: Sequence[float]) -> Array:
    """Return the mesh with a node at each place; a place that is a node already adds none."""
    for place in places:
        if np.min(np.abs(nodes - place)) > 1e-12:
            nodes = np.sort(np.append(nodes, place))
    return nodes
