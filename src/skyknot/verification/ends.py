"""Checks at single times: the horizon, both ends, point constraints, free parameters."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.problem.horizon import Free
from skyknot.verification.base import Check, outside, worst_of
from skyknot.verification.evidence import Evidence
from skyknot.verification.tolerances import Limits

Array = NDArray[np.float64]


def horizon(evidence: Evidence, limits: Limits) -> Check:
    """Check that the trajectory takes the time asked for, and that free parameters keep bounds."""
    asked = {"duration": evidence.problem.horizon, **evidence.problem.free_parameters}
    found = {"duration": evidence.trajectory.duration, **evidence.problem.parameter_values()}
    found |= evidence.parameters
    pairs = [
        (value.lower, value.upper) if isinstance(value, Free) else (value, value)
        for value in asked.values()
    ]
    lower, upper = np.array(pairs).T
    values = np.array([[found[name] for name in asked]])
    return worst_of(
        "horizon",
        "Duration of the trajectory, and free parameters, against what was asked.",
        outside(values, lower, upper),
        limits.feasibility * magnitudes(lower, upper),
        tuple(asked),
        tuple("s" if name == "duration" else "" for name in asked),
    )


def ends(evidence: Evidence, limits: Limits) -> Check:
    """Check the first and the last node against the ends asked for."""
    p, states = evidence.problem, evidence.trajectory.states
    excess = np.stack(
        [
            outside(states[0], p.initial_lower, p.initial_upper),
            outside(states[-1], p.final_lower, p.final_upper),
        ]
    )
    sizes = np.maximum(
        magnitudes(p.initial_lower, p.initial_upper), magnitudes(p.final_lower, p.final_upper)
    )
    return worst_of(
        "ends",
        "First and last node against the initial and final conditions.",
        excess,
        limits.feasibility * sizes,
        p.state_names,
        evidence.state_units,
        evidence.times[[0, -1]],
    )


def points(evidence: Evidence, limits: Limits) -> Check | None:
    """Check every point constraint at its own time."""
    entries = evidence.problem.points
    if not entries:
        return None
    lower, upper = bounds_of(entries)
    places = np.array([entry.at for entry in entries])
    times = evidence.times[0] + evidence.trajectory.duration * places
    X, U = _at(evidence, times)
    values = np.diag(evidence.equations.points(X, U, times))
    excess = np.diag(outside(values, lower, upper))
    return worst_of(
        "points",
        "Point constraints (waypoints, events) at the times they are asked for.",
        excess,
        limits.feasibility * magnitudes(lower, upper),
        tuple(entry.name for entry in entries),
        tuple(entry.unit for entry in entries),
        times,
    )


def magnitudes(lower: Array, upper: Array) -> Array:
    """Return the largest of 1 and the finite bounds of each quantity."""
    known = np.abs(np.stack([lower, upper]))
    result: Array = np.maximum(np.max(np.where(np.isfinite(known), known, 0.0), axis=0), 1.0)
    return result


def bounds_of(entries: tuple[object, ...]) -> tuple[Array, Array]:
    """Return the bounds of constraints as arrays, infinite where there is none."""
    low = [-np.inf if e.lower is None else e.lower for e in entries]  # type: ignore[attr-defined]
    high = [np.inf if e.upper is None else e.upper for e in entries]  # type: ignore[attr-defined]
    return np.array(low, dtype=float), np.array(high, dtype=float)


def _at(evidence: Evidence, times: Array) -> tuple[Array, Array]:
    """Return states and controls; those of the node itself where a time is a node's."""
    X, U = evidence.trajectory.state(times), evidence.trajectory.control(times)
    distance = np.abs(evidence.times[None, :] - times[:, None])
    nearest = np.argmin(distance, axis=1)
    exact = np.min(distance, axis=1) <= 1e-9 * evidence.trajectory.duration
    X[exact] = evidence.trajectory.states[nearest[exact]]
    return X, U
