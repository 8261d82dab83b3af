"""Typical sizes of the unknowns, from what the user said: scales, vehicle, bounds, ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.layout import Layout
from skyknot.problem.problem import Problem

Array = NDArray[np.float64]

# A bound this far out means "free": it says nothing of the size of the unknown.
BEYOND_ENDS = 1e3  # times the largest end
BEYOND = 1e4  # where no end is known


def decision_scales(problem: Problem, layout: Layout) -> Array:
    """Return the (size,) typical sizes of the unknowns, all positive."""
    scales = np.ones(layout.size)
    scales[layout.states_at(layout.state)] = state_scales(problem)
    scales[layout.controls_at(layout.control)] = control_scales(problem)
    free = [problem.duration_guess] if problem.free_horizon else []
    free += [max(abs(value.lower), abs(value.upper)) for value in problem.free_parameters.values()]
    scales[layout.global_positions] = free
    return np.where(scales > 0, scales, 1.0)


def state_scales(problem: Problem) -> Array:
    """Return (nx,) typical sizes: given, else the vehicle's, else from bounds and ends."""
    own = [state.scale for state in problem.states]
    vehicle = getattr(problem.vehicle, "state_scales", None)
    ends = (
        problem.initial_lower,
        problem.initial_upper,
        problem.final_lower,
        problem.final_upper,
    )
    return _first_known(own, vehicle, (problem.state_lower, problem.state_upper), ends)


def control_scales(problem: Problem) -> Array:
    """Return (nu,) typical sizes: given, else the vehicle's, else from bounds."""
    own = [control.scale for control in problem.controls]
    vehicle = getattr(problem.vehicle, "control_scales", None)
    return _first_known(own, vehicle, (problem.control_lower, problem.control_upper))


def _first_known(
    own: list[float | None],
    vehicle: Array | None,
    bounds: tuple[Array, ...],
    ends: tuple[Array, ...] = (),
) -> Array:
    from_ends = _largest(ends) if ends else np.zeros(len(own))
    credible = np.where(from_ends > 0, BEYOND_ENDS * from_ends, BEYOND)
    from_bounds = _largest(bounds, credible)
    known = np.maximum(from_ends, from_bounds)
    scales = np.where(known > 0, known, 1.0)
    if vehicle is not None and np.shape(vehicle) == scales.shape:
        scales = np.asarray(vehicle, dtype=float)
    return np.array([s if given is None else given for given, s in zip(own, scales, strict=True)])


def _largest(values: tuple[Array, ...], limit: Array | float = np.inf) -> Array:
    """Return the largest finite magnitudes up to ``limit``; 0 where there is none."""
    magnitudes = np.abs(np.stack(values))
    counted = np.isfinite(magnitudes) & (magnitudes <= limit)
    largest: Array = np.max(np.where(counted, magnitudes, 0.0), axis=0)
    return largest
