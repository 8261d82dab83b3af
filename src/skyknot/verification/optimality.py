"""Checks of the finite program's optimality conditions, in the user's units, without scaling.

Legend: N segments, s state points, m control values, nx states, nu controls, ng constraints, nq
globals; L Lagrangian and ζ, μ, ρ multipliers as in witness.py. Costs are in the objective's unit.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.verification.base import Check, cost_per, worst_of
from skyknot.verification.evidence import Evidence
from skyknot.verification.finite_program import FiniteProgram
from skyknot.verification.tolerances import Limits

Array = NDArray[np.float64]
Group = tuple[Array, Array, tuple[str, ...], tuple[str, ...], Array]
"""Excess (M, n), allowed (n,), names (n,), units (n,), times (M,) of quantities of one kind."""


def stationarity(evidence: Evidence, limits: Limits) -> Check | None:
    """Check ∂L/∂z = 0 for every unknown: states, control values, free duration and parameters."""
    program = evidence.program
    if program is None:
        return None
    groups = [
        _group(evidence, program, "states", _sizes(program.state_terms)),
        _group(evidence, program, "controls", _sizes(program.control_terms)),
        _group(evidence, program, "globals", _sizes(program.global_terms)),
    ]
    return worst_of(
        "stationarity",
        "Slope of the Lagrangian along every unknown, from the problem's own expressions and the"
        " multipliers, unscaled; allowed is a share of the largest term that it sums.",
        *_stacked(groups, limits.optimality),
    )


def signs(evidence: Evidence, limits: Limits) -> Check | None:
    """Check that no multiplier pulls at a bound that is not there or lies on the far side."""
    if evidence.program is None:
        return None
    groups = []
    for name, value, lower, upper, multiplier in _boxes(evidence.program):
        pulled = np.where(multiplier > 0, upper, lower)
        other = np.where(multiplier > 0, lower, upper)
        away = np.abs(pulled - value)
        wrong = ~np.isfinite(pulled) | (np.abs(other - value) < away)
        size = np.where(np.isfinite(away), away, np.maximum(np.abs(value), 1.0))
        groups.append(_priced(evidence, name, np.where(wrong, np.abs(multiplier) * size, 0.0)))
    return worst_of(
        "multiplier signs",
        "Multipliers that pull at a missing bound, or at the farther of two, times the distance.",
        *_stacked(groups, limits.optimality * evidence.program.objective_size),
    )


def complementarity(evidence: Evidence, limits: Limits) -> Check | None:
    """Check that a multiplier acts only where its bound is met: |multiplier × distance| = 0."""
    if evidence.program is None:
        return None
    groups = []
    for name, value, lower, upper, multiplier in _boxes(evidence.program):
        pulled = np.where(multiplier > 0, upper, lower)
        away = np.where(np.isfinite(pulled), pulled - value, 0.0)
        groups.append(_priced(evidence, name, np.abs(multiplier * away)))
    return worst_of(
        "complementarity",
        "Every multiplier times the distance to the bound it belongs to, evaluated anew.",
        *_stacked(groups, limits.optimality * evidence.program.objective_size),
    )


def _boxes(program: FiniteProgram) -> list[tuple[str, Array, Array, Array, Array]]:
    """Return kind, values, bounds and multipliers of everything that is bounded."""
    w, p, shape = program.witness, program.problem, program.values.shape
    low, high = np.broadcast_to(p.control_lower, shape), np.broadcast_to(p.control_upper, shape)
    return [
        ("states", program.X, *program.state_bounds, w.state_bounds),
        ("controls", program.values, low, high, w.control_bounds),
        ("constraints", program.rows, *program.row_bounds, w.path),
        ("rates", *program.rate_rows, w.rates),
        ("globals", program.lagrangian.q, *program.global_bounds, w.global_bounds),
    ]


def _group(evidence: Evidence, program: FiniteProgram, kind: str, sizes: Array) -> Group:
    slopes = {
        "states": program.state_slopes,
        "controls": program.control_slopes,
        "globals": program.global_slopes[None],
    }[kind]
    names, units, times = _labels(evidence, kind)
    flat = np.abs(slopes).reshape(len(times), len(names))
    return flat, sizes, names, tuple(cost_per(unit) for unit in units), times


def _priced(evidence: Evidence, kind: str, excess: Array) -> Group:
    names, _, times = _labels(evidence, kind)
    flat = excess.reshape(len(times), len(names)) if kind != "rates" else excess[:, None]
    return flat, np.ones(flat.shape[1]), names, ("cost",) * len(names), times


def _labels(evidence: Evidence, kind: str) -> tuple[tuple[str, ...], tuple[str, ...], Array]:
    """Return names, units and times of the entries of one kind."""
    program, p = evidence.program, evidence.problem
    assert program is not None
    start, h = evidence.times[:-1, None], evidence.lengths[:, None]
    at_points = (start + h * program.witness.points).ravel()
    if kind == "states":
        return p.state_names, evidence.state_units, at_points
    if kind == "controls":
        places = (start + h * program.witness.control_points).ravel()
        return p.control_names, evidence.control_units, places
    if kind == "constraints":
        entries = p.constraints
        return tuple(e.name for e in entries), tuple(e.unit for e in entries), at_points
    if kind == "rates":
        segment = program.rate_segments[:, 0]
        return ("rate of a control",), ("",), evidence.times[segment]
    names = tuple("duration" if n == "horizon" else n for n in program.lagrangian.names)
    units = tuple("s" if n == "duration" else "" for n in names)
    return names, units, evidence.times[:1]


def _sizes(terms: Array) -> Array:
    """Return the largest of 1 and the terms (…, n) of each quantity."""
    known = np.where(np.isfinite(terms), np.abs(terms), 0.0)
    largest: Array = np.max(known, axis=tuple(range(terms.ndim - 1)), initial=1.0)
    return largest


def _stacked(groups: list[Group], share: float) -> tuple[Array, Array, list[str], list[str], Array]:
    """Return the arguments of ``worst_of`` for groups side by side, each with rows of its own."""
    filled = [group for group in groups if group[0].size]
    rows, columns = (sum(g[0].shape[axis] for g in filled) for axis in (0, 1))
    excess = np.zeros((rows, columns))
    row = column = 0
    for values, *_ in filled:
        excess[row : row + values.shape[0], column : column + values.shape[1]] = values
        row, column = row + values.shape[0], column + values.shape[1]
    return (
        excess,
        share * np.concatenate([g[1] for g in filled]),
        [name for g in filled for name in g[2]],
        [unit for g in filled for unit in g[3]],
        np.concatenate([g[4] for g in filled]),
    )
