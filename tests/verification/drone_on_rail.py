"""A craft on a rail: small, with one of everything that a certificate looks at."""

from dataclasses import replace
from typing import Any

import numpy as np

from skyknot.problem.constraints import PathConstraint, PointConstraint
from skyknot.problem.problem import Problem
from skyknot.problem.variables import Control, State
from skyknot.trajectory import SegmentData, Trajectory


def dynamics(x, u, p):
    return [x[1], u[0] - p.drag * x[1]]


def problem(**changes: Any) -> Problem:
    """Return x'' = a − drag x' from rest at 0 to rest at 1 m in 2 s, least ∫ a² dt."""
    choices: dict[str, Any] = {
        "name": "drone on a rail",
        "states": [State("x", "m"), State("v", "m/s")],
        "controls": [Control("a", "m/s²")],
        "dynamics": dynamics,
        "horizon": 2.0,
        "initial": [0, 0],
        "final": [1, 0],
        "running_cost": lambda x, u: u[0] ** 2,
        "state_bounds": ([-1, None], [2, 0.9]),
        "control_bounds": (-3, 3),
        "rates": [6.0],
        "path": [PathConstraint("fence", lambda x, u: x[0], upper=1.2, unit="m")],
        "points": [PointConstraint("gate", lambda x, u: x[0], at=0.5, lower=0.45, unit="m")],
        "parameters": {"drag": 0.2},
    }
    return Problem(**(choices | changes))


def with_segments(trajectory: Trajectory, **changes: Any) -> Trajectory:
    """Return the trajectory with other segment data."""
    assert trajectory.segments is not None
    return replace(trajectory, segments=replace(trajectory.segments, **changes))


def bumped(values: np.ndarray, where: tuple[int, ...], by: float) -> np.ndarray:
    """Return a copy with one entry changed."""
    result = values.copy()
    result[where] += by
    return result


def flat(times: Any, states: Any, control_values: Any, rates: Any) -> Trajectory:
    """Return a hand-made trajectory with three rate points and three control points a segment."""
    thirds = np.array([0.0, 0.5, 1.0])
    states, values = np.array(states, dtype=float), np.array(control_values, dtype=float)
    n = len(values)
    return Trajectory(
        np.array(times, dtype=float),
        states,
        np.concatenate([values[:, 0], values[-1:, -1]]),
        SegmentData(
            rate_points=thirds,
            rates=np.broadcast_to(rates, (n, 3, states.shape[1])).astype(float),
            control_points=thirds,
            control_values=values,
            interior_points=np.array([]),
            interior_states=np.zeros((n, 0, states.shape[1])),
        ),
    )
