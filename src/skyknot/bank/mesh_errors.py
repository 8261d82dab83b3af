"""The error of a reference problem's objective against the number of segments.

Legend: N segments, order p: error ~ N^−p, the slope of a line through log error against log N.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from skyknot.bank.base import Reference
from skyknot.solve import solve
from skyknot.transcription import HermiteSimpson, Transcription

MESHES = (10, 20, 40, 80)

TOLERANCE = 1e-12
"""Of the solver: the barrier of an active bound then costs less than rounding shows."""

ROUNDING = 3e-11
"""A relative error below it shows no order."""

LEAST_MESHES = 3
"""An order needs so many errors above what is known and above rounding."""


@dataclass(frozen=True)
class MeshErrors:
    """Errors of the objective on uniform meshes.

    Attributes
    ----------
    name : in the catalogue
    meshes : numbers of segments, rising
    errors : relative errors, not negative; NaN where the solver did not succeed
    order : observed; NaN where fewer than three errors show one
    exact : whether every error is rounding
    """

    name: str
    meshes: tuple[int, ...]
    errors: tuple[float, ...]
    order: float
    exact: bool


def mesh_errors(
    name: str,
    reference: Reference,
    meshes: Sequence[int] = MESHES,
    scheme: Callable[[int], Transcription] = HermiteSimpson,
) -> MeshErrors:
    """Solve a reference problem on uniform meshes and fit the order.

    Parameters
    ----------
    name : in the catalogue
    reference : what is to be found
    meshes : numbers of segments
    scheme : N → transcription; Hermite–Simpson with its free midpoint control by default
    """
    counts = tuple(sorted(meshes))
    errors = np.array([_error(reference, scheme(N)) for N in counts])
    known = np.isfinite(errors)
    shown = known & (errors > _floor(reference))
    order = float("nan")
    if np.count_nonzero(shown) >= LEAST_MESHES:
        order = float(-np.polyfit(np.log(np.array(counts)[shown]), np.log(errors[shown]), 1)[0])
    exact = bool(np.all(known) and np.all(errors <= ROUNDING))
    return MeshErrors(name, counts, tuple(map(float, errors)), order, exact)


def _error(reference: Reference, scheme: Transcription) -> float:
    solution = solve(reference.problem, scheme, guess=reference.guess, tolerance=TOLERANCE)
    if not solution.success:
        return float("nan")
    return abs(solution.objective - reference.optimum) / (abs(reference.optimum) or 1.0)


def _floor(reference: Reference) -> float:
    """Return the relative error that says something: above rounding and the digits known."""
    if reference.digits is None:
        return ROUNDING
    return max(ROUNDING, 10.0 ** (1 - reference.digits))
