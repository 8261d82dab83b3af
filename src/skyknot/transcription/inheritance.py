"""Multipliers on a new mesh, from those on the old one: a warm start across meshes.

Multipliers of bounds and path constraints belong to one point each, so they grow with the share of
the horizon that the point stands for: divided by it they are densities, which the mesh does not
change. The last row of a segment carries a costate, which the mesh does not change either; the
other rows carry h dp/dt and grow with the segment.

Legend: as in kernel/program.py; b quadrature weights, δ segment lengths as shares of the horizon.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.program import Multipliers, Program

Array = NDArray[np.float64]
Offsets = NDArray[np.intp]


def inherited(old: Program, multipliers: Multipliers, new: Program, points: Array) -> Multipliers:
    """Return multipliers for ``new``, a program of the same problem and scheme on another mesh.

    Parameters
    ----------
    old, multipliers : program solved, and its multipliers
    new : program to be solved
    points : (s,) state points of the scheme
    """
    result = new.empty_multipliers()
    result.defects[:] = _defects(old, multipliers.defects, new)
    result.path[:] = _path(old, multipliers.path, new)
    if len(old.rates.length):
        result.rates[:] = _rates(old, multipliers.rates, new)
    result.bounds[new.layout.global_positions] = multipliers.bounds[old.layout.global_positions]
    for here, there in zip(_families(old, points), _families(new, points), strict=True):
        fixed = (old.lower == old.upper)[here.positions]
        result.bounds[there.positions] = _bounds(multipliers.bounds, here, there, fixed)
    return result


def _defects(old: Program, defects: Array, new: Program) -> Array:
    """Return (N, s−1, nx): every row as a function of the middle of its segment."""
    scale_old, scale_new = old.fractions[:, None, None], new.fractions[:, None, None]
    last = np.arange(defects.shape[1]) == defects.shape[1] - 1
    factor_old = np.where(last[None, :, None], 1.0, scale_old)
    factor_new = np.where(last[None, :, None], 1.0, scale_new)
    return _interpolated(_middles(old), defects / factor_old, _middles(new)) * factor_new


def _path(old: Program, path: Array, new: Program) -> Array:
    result = np.zeros((len(new.point_time), path.shape[1]))
    weights_old, weights_new = _point_shares(old), _point_shares(new)
    for column in range(path.shape[1]):
        rows_old, rows_new = (_bounded(program, column) for program in (old, new))
        if len(rows_old) == 1 and len(rows_new) == 1:  # a point constraint: a number, no density
            result[rows_new, column] = path[rows_old, column]
        elif len(rows_old) and len(rows_new):
            times, which = np.unique(old.point_time[rows_old], return_inverse=True)
            total = np.bincount(which, path[rows_old, column])
            density = total / np.bincount(which, weights_old[rows_old])
            values = np.interp(new.point_time[rows_new], times, density)
            result[rows_new, column] = values * weights_new[rows_new]
    return result


def _bounded(program: Program, column: int) -> Offsets:
    """Return the evaluated points where a constraint applies."""
    lower, upper = program.path_lower[:, column], program.path_upper[:, column]
    return np.flatnonzero(np.isfinite(lower) | np.isfinite(upper))


def _rates(old: Program, rates: Array, new: Program) -> Array:
    """Return (R,): rows of one kind stand in equal order on both meshes."""
    kinds = len(rates) // max(_rate_bases(old), 1)
    places = [(np.arange(n) + 0.5) / n for n in (_rate_bases(old), _rate_bases(new))]
    return _interpolated(places[0], rates.reshape(-1, kinds), places[1]).ravel()


def _rate_bases(program: Program) -> int:
    return program.segments - (1 if len(program.control_points) == 1 else 0)


@dataclass(frozen=True)
class _Family:
    """All states, or all control values, in the order of time: M of them, n numbers each.

    Attributes
    ----------
    positions : (M, n) in z
    times, shares : (M,) place in the horizon and share of it
    """

    positions: Offsets
    times: Array
    shares: Array


def _families(program: Program, points: Array) -> tuple[_Family, _Family]:
    """Return states and controls."""
    layout = program.layout
    b = np.zeros(len(points))
    b[program.used] = program.A[-1]
    W = program.A[-1] @ program.control_weights
    states = _family(program, layout.state, points, b, layout.nx)
    return states, _family(program, layout.control, program.control_points, W, layout.nu)


def _family(
    program: Program, offsets: Offsets, places: Array, weights: Array, size: int
) -> _Family:
    delta = program.fractions
    weights = np.where(weights > 0, weights, 1 / len(weights))
    shares = np.zeros(offsets.max() + 1)
    np.add.at(shares, offsets, delta[:, None] * weights)
    start = np.cumsum(delta) - delta
    rows, first = np.unique(offsets, return_index=True)
    times = (start[:, None] + delta[:, None] * places).ravel()[first]
    order = np.argsort(times, kind="stable")
    rows = rows[order]
    return _Family(rows[:, None] + np.arange(size), times[order], shares[rows])


def _bounds(bounds: Array, here: _Family, there: _Family, fixed: NDArray[np.bool_]) -> Array:
    """Return (M, n) bound multipliers of a family; what is fixed at an end keeps its number."""
    numbers = bounds[here.positions]
    density = np.where(fixed, 0.0, numbers / here.shares[:, None])
    values: Array = _interpolated(here.times, density, there.times) * there.shares[:, None]
    for end in (0, -1):
        values[end] = np.where(fixed[end], numbers[end], values[end])
    return values


def _point_shares(program: Program) -> Array:
    b = program.A[-1]
    shares = program.fractions[:, None] * np.where(b > 0, b, 1 / len(b))
    total = np.zeros(len(program.point_time))
    np.add.at(total, program.segment_points, shares)
    return total


def _middles(program: Program) -> Array:
    ends = np.cumsum(program.fractions)
    result: Array = ends - 0.5 * program.fractions
    return result


def _interpolated(times: Array, values: Array, places: Array) -> Array:
    """Return values (M, …) at times (M,), linear in between and constant beyond, at places."""
    k = np.clip(np.searchsorted(times, places) - 1, 0, max(len(times) - 2, 0))
    right = np.minimum(k + 1, len(times) - 1)
    span = np.where(times[right] > times[k], times[right] - times[k], 1.0)
    share = np.clip((places - times[k]) / span, 0.0, 1.0).reshape(-1, *[1] * (values.ndim - 1))
    result: Array = (1 - share) * values[k] + share * values[right]
    return result
