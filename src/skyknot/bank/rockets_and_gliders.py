"""Flight of rockets, gliders and carts: nonlinear mechanics in the plane.

Legend: m mass, g gravity, r radius, D, L drag and lift; s, c sine and cosine of an angle.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from skyknot.bank.base import COMPUTED, Printed, Recipe, Reference, line
from skyknot.problem.constraints import PointConstraint
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.transcription import Lobatto


def cart_pole() -> Reference:
    """Swing-up with least ∫u²: M. Kelly, SIAM Review 59 (2017) 849–904, section 6."""
    m1, m2, length, g = 1.0, 0.3, 0.5, 9.81

    def dynamics(x: ca.SX, u: ca.SX) -> list[ca.SX]:
        s, c = ca.sin(x[1]), ca.cos(x[1])
        spin = length * m2 * s * x[3] ** 2
        share = m1 + m2 * s**2
        return [
            x[2],
            x[3],
            (spin + u[0] + m2 * g * c * s) / share,
            -(c * spin + u[0] * c + (m1 + m2) * g * s) / (length * share),
        ]

    problem = Problem(
        "cart-pole",
        ["x", "angle", "v", "spin"],
        ["force"],
        dynamics,
        horizon=2.0,
        initial=[0.0, 0.0, 0.0, 0.0],
        final=[1.0, np.pi, 0.0, 0.0],
        running_cost=lambda x, u: u[0] ** 2,
        state_bounds=([-2.0, None, None, None], [2.0, None, None, None]),
        control_bounds=(-20.0, 20.0),
    )
    source = "computed; problem of Kelly 2017; a local optimum"
    wrong = "asserted to a relative 1e-3 only"
    return Reference(
        problem,
        58.8076674580,
        source,
        kind=COMPUTED,
        digits=12,
        printed=(Printed("58.88", "dymos, examples/cart_pole", wrong),),
        recipe=Recipe(Lobatto(20, 9)),
    )


def hang_glider() -> Reference:
    """Farthest glide of Bulirsch, Nerz, Pesch & von Stryk through an updraft, 100 m down."""
    lift_of_air, reach, m, g, area, density = 2.5, 100.0, 100.0, 9.81, 14.0, 1.13

    def dynamics(x: ca.SX, u: ca.SX) -> list[ca.SX]:
        near = (x[0] / reach - 2.5) ** 2
        sink = x[3] - lift_of_air * (1 - near) * ca.exp(-near)
        airspeed = ca.sqrt(x[2] ** 2 + sink**2)
        s, c = sink / airspeed, x[2] / airspeed
        pressure = 0.5 * density * area * airspeed**2
        D, L = pressure * (0.034 + 0.069662 * u[0] ** 2), pressure * u[0]
        return [x[2], x[3], (-L * s - D * c) / m, (L * c - D * s) / m - g]

    ends = [13.23, -1.288]
    problem = Problem(
        "hang glider",
        ["x", "y", "vx", "vy"],
        ["lift"],
        dynamics,
        horizon=Free(10.0, 200.0, 100.0),
        initial=[0.0, 1000.0, *ends],
        final=[None, 900.0, *ends],
        terminal_cost=lambda x, tf: -x[0],
        state_bounds=([0.0, None, 0.0, None], None),
        control_bounds=(0.0, 1.4),
    )
    source = (
        "computed; problem of Bulirsch et al. 1993 in the form of Dolan, Moré & Munson, COPS 3.0"
        " (2004)"
    )
    start = line(100.0, [0.0, 1000.0, *ends], [1248.0, 900.0, *ends], [0.7], [0.7])
    return Reference(
        problem,
        -1247.9876,
        source,
        start,
        kind=COMPUTED,
        digits=8,
        recipe=Recipe(Lobatto(60, 5), accuracy=1e-6, tolerance=1e-8),
    )


def orbit_raising() -> Reference:
    """Largest circular orbit after 3.32 units of low thrust from a circular one.

    r radius, radial and tangential speed, in units of the first orbit; mass 1 − 0.0749 t.
    """

    def dynamics(x: ca.SX, u: ca.SX, t: ca.SX) -> list[ca.SX]:
        r, radial, tangential = x[0], x[1], x[2]
        push = 0.1405 / (1 - 0.0749 * t)
        return [
            radial,
            tangential**2 / r - 1 / r**2 + push * ca.sin(u[0]),
            -radial * tangential / r + push * ca.cos(u[0]),
        ]

    problem = Problem(
        "orbit raising",
        ["r", "radial", "tangential"],
        ["angle"],
        dynamics,
        horizon=3.32,
        initial=[1.0, 0.0, 1.0],
        final=[None, 0.0, None],
        terminal_cost=lambda x, tf: -x[0],
        state_bounds=([0.5, None, None], None),
        points=[
            PointConstraint("circular", lambda x, u: x[0] * x[2] ** 2, at=1.0, lower=1.0, upper=1.0)
        ],
    )
    source = "computed; problem of Bryson & Ho, section 2.5 (Moyer & Pinkham 1964): 1.525"
    start = line(3.32, [1.0, 0.0, 1.0], [1.5, 0.0, 0.8], [0.4], [5.5])
    return Reference(
        problem,
        -1.5252777006,
        source,
        start,
        kind=COMPUTED,
        digits=11,
        recipe=Recipe(Lobatto(24, 9)),
    )
