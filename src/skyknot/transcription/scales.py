"""Typical sizes of the unknowns, from what the user said: scales, vehicle, bounds, ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.layout import Layout
from skyknot.problem.problem import Problem

Array = NDArray[np.float64]


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
    known = (
        problem.state_lower,
        problem.state_upper,
        problem.initial_lower,
        problem.initial_upper,
        problem.final_lower,
        problem.final_upper,
    )
    return _first_known(own, vehicle, known)


def control_scales(problem: Problem) -> Array:
    """Return (nu,) typical sizes: given, else the vehicle's, else from bounds."""
    own = [control.scale for control in problem.controls]
    vehicle = getattr(problem.vehicle, "control_scales", None)
    return _first_known(own, vehicle, (problem.control_lower, problem.control_upper))


def _first_known(own: list[float | None], vehicle: Array | None, known: tuple[Array, ...]) -> Array:
    magnitudes = np.abs(np.stack(known))
    from_bounds = np.max(np.where(np.isfinite(magnitudes), magnitudes, 0.0), axis=0)
    scales = np.where(from_bounds > 0, from_bounds, 1.0)
    if vehicle is not None and np.shape(vehicle) == scales.shape:
        scales = np.asarray(vehicle, dtype=float)
    return np.array([s if given is None else given for given, s in zip(own, scales, strict=True)])
