"""Controls that appear linearly and rest on no bound: the Hamiltonian does not tell them.

Legend: y, x states, u control, t time, J cost.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from skyknot.bank.base import COMPUTED, Array, Recipe, Reference, line
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.problem.variables import State
from skyknot.transcription import Lobatto, Radau


def neuenhofen_kerrigan() -> Reference:
    """∫(y² + u cos t) over a quarter turn, ẏ = y²/2 + u, y(0) = 0, −3/2 ≤ u ≤ 1.

    y = −sin t/(2 − cos t), u = ½ − (3/2)/(2 − cos t)², costate −cos t.
    """
    T = 0.5 * np.pi

    def state(t: Array) -> Array:
        return np.asarray((-np.sin(t) / (2 - np.cos(t)))[:, None])

    def control(t: Array) -> Array:
        return np.asarray((0.5 - 1.5 / (2 - np.cos(t)) ** 2)[:, None])

    problem = Problem(
        "neuenhofen-kerrigan",
        ["y"],
        ["u"],
        lambda y, u: [0.5 * y[0] ** 2 + u[0]],
        horizon=T,
        initial=[0.0],
        running_cost=lambda y, u, t: y[0] ** 2 + u[0] * ca.cos(t),
        control_bounds=(-1.5, 1.0),
    )
    # ∫(y² + u cos t) by Gauss–Legendre quadrature: the integrand is analytic, 40 points are exact
    points, weights = np.polynomial.legendre.leggauss(40)
    t = 0.5 * T * (points + 1)
    integrand = state(t)[:, 0] ** 2 + control(t)[:, 0] * np.cos(t)
    source = "closed form: Neuenhofen & Kerrigan, arXiv 1810.04059; PSOPT, examples/x1"
    return Reference(
        problem,
        float(0.5 * T * weights @ integrand),
        source,
        None,
        state,
        control,
        lambda t: np.asarray(-np.cos(t)[:, None]),
        recipe=Recipe(Radau(4, 8, controls="polynomial"), tolerance=1e-9),
    )


def aly_chan() -> Reference:
    """½∫(x2² − x1²) over a quarter turn, ẋ1 = x2, ẋ2 = u, |u| ≤ 1, from (0, 1): u = −sin t."""
    problem = Problem(
        "aly-chan",
        ["x1", "x2"],
        ["u"],
        lambda x, u: [x[1], u[0]],
        horizon=0.5 * np.pi,
        initial=[0.0, 1.0],
        running_cost=lambda x, u: 0.5 * (x[1] ** 2 - x[0] ** 2),
        control_bounds=(-1.0, 1.0),
    )
    source = "closed form: Aly & Chan, Int. J. Control 17 (1973) 809–815: singular throughout"
    return Reference(problem, 0.0, source, recipe=Recipe(Lobatto(4, 8), tolerance=1e-9))


def goddard() -> Reference:
    """Highest flight of a sounding rocket: full thrust, a singular arc, coasting.

    Units of the planet's radius, its gravity and the mass at the start, but the height z above
    ground in hundredths: drag 310 v² e^(−5 z), gravity 1/(1 + z/100)².
    """

    def dynamics(x: ca.SX, u: ca.SX) -> list[ca.SX]:
        z, v, m = x[0], x[1], x[2]
        drag = 310 * v**2 * ca.exp(-5 * z)
        return [100 * v, (u[0] - drag) / m - 1 / (1 + z / 100) ** 2, -u[0] / 0.5]

    problem = Problem(
        "goddard",
        ["z", State("v", scale=0.1), "m"],
        ["thrust"],
        dynamics,
        horizon=Free(0.05, 0.6, 0.2),
        initial=[0.0, 0.0, 1.0],
        final=[None, None, 0.6],
        terminal_cost=lambda x, tf: -x[0],
        state_bounds=([0.0, 0.0, 0.6], [None, None, 1.0]),
        control_bounds=(0.0, 3.5),
    )
    source = (
        "computed by flying the three arcs, D (1 + v/c) = m g on the singular one (Bryson & Ho,"
        " chapter 8); problem of Dolan, Moré & Munson, COPS 3.0 (2004), whose height is 1 + z/100"
    )
    start = line(0.2, [0.0, 0.05, 1.0], [1.0, 0.0, 0.6], [3.5], [0.0])
    return Reference(
        problem,
        -1.28369183,
        source,
        start,
        kind=COMPUTED,
        digits=9,
        switches=(0.023509684, 0.072670743),
        recipe=Recipe(
            Radau(60, 3, controls="linear"), accuracy=1e-6, tolerance=1e-7, phases=(10, 5)
        ),
    )
