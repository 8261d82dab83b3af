"""Turning of rigid bodies in least time.

Legend: q unit quaternion (scalar first), w body rates, u torques, a, b lengths of bang arcs.
"""

from __future__ import annotations

from itertools import accumulate

import casadi as ca
import numpy as np

from skyknot.bank.base import COMPUTED, Recipe, Reference
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.transcription import Radau

SIGNS = ((1, 1, 1), (-1, 1, 1), (-1, -1, 1), (-1, -1, -1), (1, -1, -1), (1, 1, -1))


def reorientation() -> Reference:
    """Half a turn of a sphere about z, rest to rest, |u_i| ≤ 1 about each axis, in least time.

    Turning about z alone takes 2√π = 3.5449; the optimum nutates, with five switches.
    """
    a, b = 0.4454389949, 0.7306636488
    switches = tuple(accumulate((a, b, a, a, b)))

    def dynamics(x: ca.SX, u: ca.SX) -> list[ca.SX]:
        q0, q1, q2, q3, w1, w2, w3 = ca.vertsplit(x)
        return [
            0.5 * (-q1 * w1 - q2 * w2 - q3 * w3),
            0.5 * (q0 * w1 - q3 * w2 + q2 * w3),
            0.5 * (q3 * w1 + q0 * w2 - q1 * w3),
            0.5 * (-q2 * w1 + q1 * w2 + q0 * w3),
            u[0],
            u[1],
            u[2],
        ]

    problem = Problem(
        "reorientation",
        ["q0", "q1", "q2", "q3", "w1", "w2", "w3"],
        ["u1", "u2", "u3"],
        dynamics,
        horizon=Free(1.0, 8.0, 3.4),
        initial=[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        final=[0.0, 0.0, 0.0, (0.5, 1.5), 0.0, 0.0, 0.0],
        terminal_cost=lambda x, tf: tf,
        control_bounds=(-1.0, 1.0),
    )
    # Started in the order of signs that Bilimoria & Wie found, in six equal arcs.
    t = np.linspace(0.0, 3.4, 6)
    s = t / t[-1]
    states = np.zeros((6, 7))
    states[:, 0], states[:, 3] = np.cos(0.5 * np.pi * s), np.sin(0.5 * np.pi * s)
    states[:, 6] = 3.0 * np.minimum(s, 1 - s)
    source = (
        "computed: arcs whose lengths bring the body round; structure of Bilimoria & Wie, J."
        " Guidance, Control, and Dynamics 16 (1993) 446–452"
    )
    return Reference(
        problem,
        sum((a, b, a, a, b, a)),
        source,
        Trajectory(t, states, np.array(SIGNS, dtype=float)),
        kind=COMPUTED,
        digits=11,
        switches=switches,
        recipe=Recipe(Radau(24, 3), accuracy=1e-5, tolerance=1e-9),
    )
