"""Small problems that together use every feature of a program, and schemes to pose them with."""

from __future__ import annotations

import casadi as ca
import numpy as np

import skyknot as sk


def oscillator(**extras):
    """Return a driven pendulum with a running and a terminal cost, changed by ``extras``."""
    asked = {
        "name": "pendulum",
        "states": [sk.State("angle", "rad"), sk.State("spin", "rad/s")],
        "controls": [sk.Control("torque", "N m"), sk.Control("brake", "N m")],
        "dynamics": lambda x, u: [x[1], -ca.sin(x[0]) + u[0] - 0.3 * u[1] * x[1]],
        "horizon": 2.0,
        "initial": [0.4, 0.0],
        "final": [None, 0.5],
        "running_cost": lambda x, u: 0.2 * x[0] ** 2 + u[0] ** 2 + 0.1 * u[0] * u[1] + u[1] ** 2,
        "terminal_cost": lambda x, tf: (x[0] - 1.0) ** 2,
        "control_bounds": ([-1.0, -0.5], [1.0, 0.5]),
    }
    return sk.Problem(**(asked | extras))


def free_time_cost(x, u):
    """Return a running cost that makes the free horizon pay for waiting."""
    return 0.3 + u[0] ** 2 + u[1] ** 2


PROBLEMS = {
    "plain": oscillator(),
    "state bounds": oscillator(state_bounds=([None, -0.4], [0.95, 0.62])),
    "rates": oscillator(rates=[0.6, 0.2]),
    "uneven rates": oscillator(rates=([-0.4, None], [0.6, 0.1])),
    "free horizon": oscillator(horizon=sk.Free(0.5, 6.0, 2.0), running_cost=free_time_cost),
    "free horizon, rates": oscillator(
        horizon=sk.Free(0.5, 6.0, 2.0), running_cost=free_time_cost, rates=[0.7, None]
    ),
    "path": oscillator(
        path=[
            sk.PathConstraint("energy", lambda x, u: x[0] ** 2 + x[1] ** 2, upper=0.8),
            sk.PathConstraint("power", lambda x, u: u[0] * x[1], lower=-0.2, upper=0.3),
        ]
    ),
    "timed path": oscillator(
        path=[sk.PathConstraint("ramp", lambda x, u, t: x[0] - 0.2 * t, upper=0.45)]
    ),
    "point": oscillator(
        points=[
            sk.PointConstraint("gate", lambda x, u: x[0], at=0.37, lower=0.3, upper=0.35),
            sk.PointConstraint("end", lambda x, u: x[0] + x[1], at=1.0, lower=1.3, upper=1.3),
        ]
    ),
    "parameters": oscillator(
        dynamics=lambda x, u, p: [x[1], -p.stiffness * ca.sin(x[0]) + u[0] - p["drag"] * x[1]],
        terminal_cost=lambda x, tf, p: (x[0] - 1.0) ** 2 + 0.05 * p["stiffness"] ** 2,
        parameters={"stiffness": sk.Free(0.2, 2.0), "drag": 0.1},
    ),
    "everything": oscillator(
        horizon=sk.Free(0.5, 6.0, 2.0),
        running_cost=lambda x, u, p: free_time_cost(x, u) + 0.1 * p["stiffness"] * x[0] ** 2,
        dynamics=lambda x, u, p, t: [x[1], -p["stiffness"] * ca.sin(x[0] + 0.1 * t) + u[0] + u[1]],
        parameters={"stiffness": sk.Free(0.2, 2.0)},
        state_bounds=([None, -0.4], [1.2, 0.62]),
        rates=([-0.4, None], [0.6, 0.3]),
        path=[sk.PathConstraint("energy", lambda x, u: x[0] ** 2 + x[1] ** 2, upper=1.2)],
        points=[sk.PointConstraint("gate", lambda x, u: x[0], at=0.37, lower=0.5)],
    ),
}

UNEVEN = np.array([0.0, 0.05, 0.2, 0.3, 0.55, 0.6, 0.8, 0.9, 1.0])

SCHEMES = {
    "euler": sk.Euler(12),
    "trapezoid": sk.Trapezoid(12),
    "trapezoid, hold": sk.Trapezoid(12, controls="hold"),
    "hermite-simpson": sk.HermiteSimpson(8),
    "hermite-simpson, linear": sk.HermiteSimpson(8, controls="linear"),
    "hermite-simpson, hold": sk.HermiteSimpson(8, controls="hold"),
    "hermite-simpson, uneven": sk.HermiteSimpson(mesh=UNEVEN),
    "hermite-simpson, nodes": sk.HermiteSimpson(8, enforce="nodes"),
    "compressed": sk.HermiteSimpson(8, form="compressed"),
    "compressed, linear": sk.HermiteSimpson(8, form="compressed", controls="linear"),
    "lobatto": sk.Lobatto(4, points=4),
    "lobatto, one segment": sk.Lobatto(1, points=9),
    "lobatto, hold": sk.Lobatto(6, points=4, controls="hold"),
    "radau, linear": sk.Radau(5, points=3, controls="linear"),
    "radau, one point": sk.Radau(12, points=1),
    "chebyshev, uneven": sk.Chebyshev(points=5, mesh=UNEVEN[::2]),
    "compressed, hold, uneven": sk.HermiteSimpson(form="compressed", controls="hold", mesh=UNEVEN),
}


# Polynomials of their own in every segment have no rate to bound at the nodes.
JUMPING = {
    "lobatto, discontinuous": sk.Lobatto(4, points=4, controls="discontinuous"),
    "radau": sk.Radau(4, points=3),
    "radau, one segment": sk.Radau(1, points=8),
    "radau, nodes": sk.Radau(4, points=2, enforce="nodes"),
}
CASES = [(problem, scheme) for problem in PROBLEMS for scheme in SCHEMES] + [
    (name, scheme)
    for name, problem in PROBLEMS.items()
    if not np.any(np.isfinite([problem.rate_lower, problem.rate_upper]))
    for scheme in JUMPING
]
ALL_SCHEMES = SCHEMES | JUMPING


def program_of(problem, scheme):
    """Return the finite program from the guess ladder's start."""
    return scheme.program(problem, sk.initial_guess(problem)[0])


def random_point(program, seed):
    """Return a decision vector near the start, and multipliers, all drawn at random."""
    random = np.random.default_rng(seed)
    z = program.start + 0.3 * random.normal(size=program.start.shape)
    if program.duration is None:
        z[program.layout.globals] = 1.7
    multipliers = program.empty_multipliers()
    for name in ("defects", "path", "rates", "bounds"):
        array = getattr(multipliers, name)
        array[...] = random.normal(size=array.shape)
    bounded = np.isfinite(program.path_lower) | np.isfinite(program.path_upper)
    multipliers.path[~bounded] = 0.0
    return z, multipliers
