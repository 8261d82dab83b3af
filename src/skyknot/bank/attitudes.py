"""Turning and tumbling of rigid bodies in least time, without angles that fail.

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

# The racing craft: kg, m/s², m, m, kg m², and the thrust of a rotor at rest, N.
MASS, GRAVITY, LEVER, KAPPA, INERTIA = 0.85, 9.81, 0.15, 0.05, (1e-3, 1e-3, 1.7e-3)
HOVER = MASS * GRAVITY / 4


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


def _racing_dynamics(x: ca.SX, f: ca.SX) -> list[ca.SX]:
    """Return the rates of position, velocity, quaternion (body to world) and body rates."""
    q0, q1, q2, q3, w1, w2, w3 = ca.vertsplit(x[6:])
    lift = (f[0] + f[1] + f[2] + f[3]) / MASS
    torque = (
        LEVER * (f[0] - f[1] - f[2] + f[3]),
        LEVER * (-f[0] - f[1] + f[2] + f[3]),
        KAPPA * (f[0] - f[1] + f[2] - f[3]),
    )
    return [
        x[3],
        x[4],
        x[5],
        2 * (q1 * q3 + q0 * q2) * lift,
        2 * (q2 * q3 - q0 * q1) * lift,
        (1 - 2 * (q1**2 + q2**2)) * lift - GRAVITY,
        0.5 * (-q1 * w1 - q2 * w2 - q3 * w3),
        0.5 * (q0 * w1 - q3 * w2 + q2 * w3),
        0.5 * (q3 * w1 + q0 * w2 - q1 * w3),
        0.5 * (-q2 * w1 + q1 * w2 + q0 * w3),
        (torque[0] - (INERTIA[2] - INERTIA[1]) * w2 * w3) / INERTIA[0],
        (torque[1] - (INERTIA[0] - INERTIA[2]) * w1 * w3) / INERTIA[1],
        (torque[2] - (INERTIA[1] - INERTIA[0]) * w1 * w2) / INERTIA[2],
    ]


def racing_quadrotor(d: float = 10.0) -> Reference:
    """Least time over d, hover to hover, of the racing craft of Foehn, Romero & Scaramuzza.

    0.85 kg, rotors from 0 to 3.3 times the weight in all, |w_x|, |w_y| ≤ 15 rad/s, |w_z| ≤ 0.3.
    """
    optimum, digits = {10.0: (1.208, 4), 5.0: (0.881, 3)}[d]
    rest = [0.0] * 6 + [1.0] + [0.0] * 6
    rates = [*[None] * 10, 15.0, 15.0, 0.3]
    problem = Problem(
        f"racing quadrotor, {d:g} m",
        [*"xyz", "vx", "vy", "vz", "q0", "q1", "q2", "q3", "w1", "w2", "w3"],
        ["f1", "f2", "f3", "f4"],
        _racing_dynamics,
        horizon=Free(0.5, 4.0, 1.5),
        initial=rest,
        final=[d, *rest[1:6], (0.5, 1.5), *rest[7:]],
        terminal_cost=lambda x, tf: tf,
        state_bounds=([None if each is None else -each for each in rates], rates),
        control_bounds=(0.0, 3.3 * HOVER),
    )
    # Lean forward, then back, as every craft does.
    t = np.linspace(0.0, 1.5, 31)
    s = t / t[-1]
    lean = 1.2 * np.sin(2 * np.pi * s)
    states = np.zeros((31, 13))
    states[:, 0] = d * s**2 * (3 - 2 * s)
    states[:, 3] = 6 * d * s * (1 - s) / t[-1]
    states[:, 6], states[:, 8] = np.cos(0.5 * lean), np.sin(0.5 * lean)
    states[:, 11] = np.gradient(lean, t)
    controls = np.full((31, 4), 2 * HOVER)
    source = (
        "computed; a local optimum; craft of Foehn, Romero & Scaramuzza, Science Robotics 6 (2021),"
        " as in their program rpg_time_optimal"
    )
    return Reference(
        problem,
        optimum,
        source,
        Trajectory(t, states, controls),
        kind=COMPUTED,
        digits=digits,
        recipe=Recipe(Radau(40, 3), accuracy=1e-4, tolerance=1e-7),
    )
