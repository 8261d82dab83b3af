"""The first guess that a mission file asks for."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from skyknot.missions.formulation import end_state
from skyknot.missions.schema import MissionFile
from skyknot.models.base import Model
from skyknot.problem.guess import flat_lift
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]

NODES = 81


def guess_of(file: MissionFile, problem: Problem, model: Model) -> Trajectory | None:
    """Return the guess asked for; None leaves it to the guess ladder."""
    kind = None if file.guess is None else file.guess.kind
    if kind == "flat":
        return flat_lift(problem)
    if kind is None and "phi" in problem.state_names:
        return None
    times = problem.duration_guess * np.linspace(0, 1, NODES)
    states = _line(file, model, times)
    if file.guess is not None and kind == "bow":
        states[:, :2] += _bow(file, file.guess.offset or 0.0, times)
    if file.guess is not None and kind == "via":
        states[:, :6] = _through(file, file.guess.points or [], times)
    controls = np.clip(model.trim_control, problem.control_lower, problem.control_upper)
    return Trajectory(
        times,
        states,
        np.tile(controls, (NODES, 1)),
        state_names=problem.state_names,
        control_names=problem.control_names,
    )


def _line(file: MissionFile, model: Model, times: Array) -> Array:
    """Return states linear from start to goal, (M, nx)."""
    share = (times / times[-1])[:, None]
    first, last = end_state(file.start, model), end_state(file.goal, model)
    states: Array = (1 - share) * first + share * last
    return states


def _bow(file: MissionFile, offset: float, times: Array) -> Array:
    """Return a half sine of sideways offsets north, east, (M, 2); positive is to the right."""
    dx, dy = np.subtract(file.goal.ned, file.start.ned)[:2]
    length = math.hypot(dx, dy) or 1.0
    right = np.array([-dy, dx]) / length
    sideways: Array = offset * np.sin(np.pi * times / times[-1])[:, None] * right
    return sideways


def _through(file: MissionFile, points: list[list[float]], times: Array) -> Array:
    """Return position and velocity along straight legs, from rest to rest, (M, 6)."""
    corners = np.array([file.start.ned, *points, file.goal.ned])
    legs = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    corners, legs = corners[np.append(True, legs > 0)], legs[legs > 0]
    reached = np.append(0.0, np.cumsum(legs))
    s = times / times[-1]
    flown = reached[-1] * s * s * (3 - 2 * s)
    position = np.column_stack([np.interp(flown, reached, corners[:, i]) for i in range(3)])
    return np.hstack([position, np.gradient(position, times, axis=0)])
