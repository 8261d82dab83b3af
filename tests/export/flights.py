"""Flights whose motion is known by heart: a pure yaw, a pure roll, an asymmetric path."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np

from skyknot.missions import vehicles
from skyknot.models.quadrotor import CONTROL_NAMES, CONTROL_UNITS, STATE_NAMES, STATE_UNITS
from skyknot.solution import Record, Solution
from skyknot.status import Status
from skyknot.trajectory import SegmentData, Trajectory

CERTIFIED = SimpleNamespace(passed=True, sentence="Certified: all checks hold.")
FAILED = SimpleNamespace(passed=False, sentence="Not certified: 'arrival' is 2 m/s above.")
DURATION = 4.0


def pure_yaw(t):
    """Hover 5 m up, 10 m north of the origin, while the nose turns from north over east."""
    still = 0 * t
    return [10 + still, still, still - 5, *(still,) * 5, 0.4 * t, still, still, 0.4 + still]


def pure_roll(t):
    """Stay in place, nose north, while the right side goes down."""
    still = 0 * t
    return [
        still,
        still,
        still - 5,
        *(still,) * 3,
        0.3 * t,
        still,
        still,
        0.3 + still,
        still,
        still,
    ]


def asymmetric(t):
    """Fly north fast, west slowly, up gently, turning about all axes."""
    phi, theta, psi = 0.2 + 0.05 * t, -0.3 + 0.1 * t, 0.7 + 0.4 * t
    phi_rate, theta_rate, psi_rate = 0.05, 0.1, 0.4
    return [
        *(3 * t + 0.5 * t**2, -2 * t + 0.125 * t**2, -1 - 0.25 * t**2),
        *(3 + t, -2 + 0.25 * t, -0.5 * t),
        *(phi, theta, psi),
        phi_rate - psi_rate * np.sin(theta),
        theta_rate * np.cos(phi) + psi_rate * np.cos(theta) * np.sin(phi),
        -theta_rate * np.sin(phi) + psi_rate * np.cos(theta) * np.cos(phi),
    ]


MOTIONS = {"pure yaw": pure_yaw, "pure roll": pure_roll, "asymmetric path": asymmetric}


def state_of(motion, t):
    return np.stack([np.asarray(entry, dtype=float) for entry in motion(np.asarray(t))], axis=-1)


def rate_of(motion, t):
    """Return the derivative of a motion by central differences, to 1e-9."""
    step = 1e-4
    return (state_of(motion, t + step) - state_of(motion, t - step)) / (2 * step)


@cache
def flown(name: str, segments: int = 40, offset: float = 0.0) -> Solution:
    """Return a solution that follows a motion; its controls are arbitrary but known."""
    motion, craft = MOTIONS[name], vehicles.load("hummingbird")
    times = np.linspace(0.0, DURATION, segments + 1)
    points = np.array([0.0, 0.5, 1.0])
    inside = times[:-1, None] + np.diff(times)[:, None] * points
    wrench = craft.hover + np.array([0.3, 0.002, -0.003, 0.001])
    data = SegmentData(
        rate_points=points,
        rates=rate_of(motion, inside),
        control_points=points,
        control_values=np.broadcast_to(wrench, (segments, 3, 4)).copy(),
        interior_points=np.array([0.5]),
        interior_states=state_of(motion, inside[:, 1:2]),
    )
    trajectory = Trajectory(
        times + offset,
        state_of(motion, times),
        np.tile(wrench, (segments + 1, 1)),
        data,
        STATE_NAMES,
        CONTROL_NAMES,
    )
    return solution_of(trajectory, name, craft)


def solution_of(trajectory, name, craft, units=(STATE_UNITS, CONTROL_UNITS)) -> Solution:
    """Return a solved solution around a trajectory."""
    count = len(trajectory.times)
    return Solution(
        status=Status.SOLVED,
        objective=1.0,
        iterations=1,
        solve_time=0.0,
        history=np.zeros((0, 7)),
        trajectory=trajectory,
        costates=np.zeros((count, trajectory.states.shape[1])),
        kkt_residual=0.0,
        max_defect=0.0,
        multipliers={},
        decision=np.zeros(0),
        record=Record(name, "hermite-simpson", "none", count - 1, 1e-6, "NED", *units),
        problem=SimpleNamespace(vehicle=craft, path=(), target=None),
    )
