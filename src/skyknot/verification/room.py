"""Checks of bounds and path constraints, at the scheme's own points and between them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.verification.base import Check, outside, worst_of
from skyknot.verification.ends import bounds_of, magnitudes
from skyknot.verification.evidence import Evidence
from skyknot.verification.tolerances import Limits

Array = NDArray[np.float64]

AT_BOUND = 0.01
"""Share of its room from a bound at which a control counts as saturated."""


def state_bounds(evidence: Evidence, limits: Limits) -> Check | None:
    """Check the states at the nodes."""
    p = evidence.problem
    if not _any(p.state_lower, p.state_upper):
        return None
    return worst_of(
        "state bounds",
        "States at the nodes against their bounds.",
        outside(evidence.trajectory.states, p.state_lower, p.state_upper),
        limits.feasibility * magnitudes(p.state_lower, p.state_upper),
        p.state_names,
        evidence.state_units,
        evidence.times,
    )


def control_bounds(evidence: Evidence, limits: Limits) -> Check | None:
    """Check the controls at every point where the scheme has a value."""
    p, inside = evidence.problem, evidence.segments
    if not _any(p.control_lower, p.control_upper):
        return None
    places = evidence.times[:-1, None] + evidence.lengths[:, None] * inside.control_points
    values = np.concatenate([inside.control_values.reshape(-1, p.nu), evidence.trajectory.controls])
    return worst_of(
        "control bounds",
        "Controls at the nodes, and at the scheme's own points, against their bounds.",
        outside(values, p.control_lower, p.control_upper),
        limits.feasibility * magnitudes(p.control_lower, p.control_upper),
        p.control_names,
        evidence.control_units,
        np.concatenate([places.ravel(), evidence.times]),
    )


def path(evidence: Evidence, limits: Limits) -> Check | None:
    """Check the path constraints at the nodes."""
    entries = evidence.problem.path
    if not entries:
        return None
    lower, upper = bounds_of(entries)
    trajectory = evidence.trajectory
    values = evidence.equations.path(trajectory.states, trajectory.controls, trajectory.times)
    return worst_of(
        "path",
        "Path constraints at the nodes, evaluated anew.",
        outside(values, lower, upper),
        limits.feasibility * magnitudes(lower, upper),
        tuple(entry.name for entry in entries),
        tuple(entry.unit for entry in entries),
        evidence.times,
    )


def states_between(evidence: Evidence, limits: Limits) -> Check | None:
    """Check the states between the nodes."""
    p, samples = evidence.problem, evidence.samples
    if not _any(p.state_lower, p.state_upper):
        return None
    return worst_of(
        "state bounds between nodes",
        f"Peak excess of the interpolated states over {evidence.density} samples in every segment.",
        outside(samples.states, p.state_lower, p.state_upper),
        allowances(samples.states, p.state_lower, p.state_upper, evidence.state_units, limits),
        p.state_names,
        evidence.state_units,
        samples.times,
    )


def controls_between(evidence: Evidence, limits: Limits) -> Check | None:
    """Check the controls between the nodes, by the mean of their excess (see ``Limits``)."""
    p, samples = evidence.problem, evidence.samples
    if not _any(p.control_lower, p.control_upper):
        return None
    excess = outside(samples.controls, p.control_lower, p.control_upper)
    rooms = _rooms(samples.controls, p.control_lower, p.control_upper)
    return worst_of(
        "control bounds between nodes",
        "Excess of the interpolated controls, averaged over the horizon; its peak is timed.",
        _averaged(evidence, excess),
        limits.control_excess * rooms,
        p.control_names,
        evidence.control_units,
        samples.times,
    )


def saturation(evidence: Evidence, _limits: Limits) -> Check | None:
    """Tell how long the controls lie at their bounds; information, it cannot fail.

    A control at its bound has nothing left against a gust.
    """
    p, samples = evidence.problem, evidence.samples
    if not _any(p.control_lower, p.control_upper):
        return None
    gaps = np.minimum(samples.controls - p.control_lower, p.control_upper - samples.controls)
    shares = gaps / _rooms(samples.controls, p.control_lower, p.control_upper)
    weights = np.repeat(evidence.lengths, evidence.density)
    at_bound = 100 * np.average(shares < AT_BOUND, axis=0, weights=weights)
    kept = 100 * np.maximum(np.min(shares, axis=0), 0.0)
    told = zip(p.control_names, at_bound, kept, strict=True)
    return Check(
        name="saturation",
        value=float(np.max(at_bound)),
        limit=100.0,
        unit="%",
        passed=True,
        how=f"Share of the time that a control spends within {100 * AT_BOUND:g} % of its room from"
        " a bound, sampled between the nodes; information, not a limit.",
        worst=", ".join(
            f"{name} {time:.2g} %" if time > 0 else f"{name} keeps {room:.2g} %"
            for name, time, room in told
        ),
        information=True,
    )


def path_between(evidence: Evidence, limits: Limits) -> Check | None:
    """Check the path constraints between the nodes.

    Constraints on states are judged by their peak; those on controls by their mean, as controls.
    """
    entries, samples = evidence.problem.path, evidence.samples
    if not entries:
        return None
    lower, upper = bounds_of(entries)
    units = tuple(entry.unit for entry in entries)
    excess = outside(samples.path, lower, upper)
    actuated = evidence.equations.path_uses_controls
    allowed = allowances(samples.path, lower, upper, units, limits)
    impulse = limits.control_excess * _rooms(samples.path, lower, upper)
    return worst_of(
        "path between nodes",
        f"Peak excess of the path constraints over {evidence.density} samples in every segment; of"
        " those that involve controls, the average over the horizon.",
        np.where(actuated, _averaged(evidence, excess), excess),
        np.where(actuated, impulse, allowed),
        tuple(entry.name for entry in entries),
        units,
        samples.times,
    )


def _any(lower: Array, upper: Array) -> bool:
    return bool(np.any(np.isfinite(lower) | np.isfinite(upper)))


def _rooms(values: Array, lower: Array, upper: Array) -> Array:
    """Return (n,) the room of each quantity: between its bounds, else its bound, else its range."""
    sizes = np.max(np.where(np.isfinite([lower, upper]), np.abs([lower, upper]), 0.0), axis=0)
    both = np.isfinite(lower) & np.isfinite(upper) & (upper > lower)
    room = np.where(both, np.where(both, upper, 0.0) - np.where(both, lower, 0.0), sizes)
    reached = np.ptp(np.where(np.isfinite(values), values, 0.0), axis=0)
    room = np.where(room > 0, room, reached)
    result: Array = np.where(room > 0, room, 1.0)
    return result


def allowances(
    values: Array, lower: Array, upper: Array, units: tuple[str, ...], limits: Limits
) -> Array:
    """Return (n,) what each quantity may pass its bounds by between nodes, in its unit."""
    lengths = np.array([unit == "m" for unit in units])
    shares: Array = limits.between_nodes * _rooms(values, lower, upper)
    return np.where(lengths, limits.clearance, shares)


def _averaged(evidence: Evidence, excess: Array) -> Array:
    """Return the mean over the horizon in the row of each column's peak, zero elsewhere."""
    weights = np.repeat(evidence.lengths, evidence.density) / (
        evidence.density * evidence.trajectory.duration
    )
    peak = np.argmax(np.where(np.isfinite(excess), excess, np.inf), axis=0)
    result = np.zeros_like(excess)
    result[peak, np.arange(excess.shape[1])] = weights @ excess
    return result
