"""Ways of least time on which the direction is steered.

Legend: T least time, g gravity, X, Y extent, A acceleration, k slope of the steering law.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from scipy.optimize import brentq, fsolve

from skyknot.bank.base import Printed, Recipe, Reference, line
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.transcription import Lobatto, Radau


def brachistochrone(X: float = 10.0, Y: float = 5.0, g: float = 9.80665) -> Reference:
    """Descent of Y over X in least time: a cycloid, T = θ √(a/g)."""
    theta = brentq(lambda s: (s - np.sin(s)) / (1 - np.cos(s)) - X / Y, 1e-3, 2 * np.pi - 1e-3)
    T = float(theta * np.sqrt(Y / (1 - np.cos(theta)) / g))
    problem = Problem(
        "brachistochrone",
        ["x", "y", "v"],
        ["angle"],
        lambda x, u: [x[2] * ca.sin(u[0]), -x[2] * ca.cos(u[0]), g * ca.cos(u[0])],
        horizon=Free(0.1, 10.0, 2.0),
        initial=[0.0, Y, 0.0],
        final=[X, 0.0, None],
        terminal_cost=lambda x, tf: tf,
    )
    start = line(2.0, [0.0, Y, 0.0], [X, 0.0, np.sqrt(2 * g * Y)], [0.1], [1.7])
    known = {
        (10.0, 5.0, 9.80665): Printed("1.8016", "dymos, examples/brachistochrone"),
        (2.0, 2.0, 9.8): Printed("0.8247591", "PSOPT, doc/SQP_ALL_EXAMPLES"),
    }
    printed = tuple(number for key, number in known.items() if key == (X, Y, g))
    source = "closed form: Johann Bernoulli 1696, the cycloid"
    recipe = Recipe(Lobatto(2, 10))
    return Reference(problem, T, source, start, printed=printed, recipe=recipe)


def zermelo(x0: float = 3.66, y0: float = -1.86) -> Reference:
    """Least time to the origin at unit speed in a current of −y along x.

    tan of the heading grows with unit slope, s = s0 + t, through the second and third quadrant;
    the way is integrated by hand and the two ends give s0 and s_T.
    """

    def area(s: float) -> float:
        return float(0.5 * (s * np.sqrt(1 + s**2) + np.arcsinh(s)))

    def misses(ends: np.ndarray) -> list[float]:
        first, last = ends
        top = np.sqrt(1 + last**2)
        way = np.arcsinh(first) - np.arcsinh(last) - (last - first) * top + area(last) - area(first)
        return [float(way) + x0, float(top - np.sqrt(1 + first**2)) - y0]

    first, last = fsolve(misses, [-4.0, 2.0], xtol=1e-14)
    T = float(last - first)
    problem = Problem(
        "zermelo",
        ["x", "y"],
        ["heading"],
        lambda x, u: [ca.cos(u[0]) - x[1], ca.sin(u[0])],
        horizon=Free(1.0, 20.0, 5.0),
        initial=[x0, y0],
        final=[0.0, 0.0],
        terminal_cost=lambda x, tf: tf,
    )
    start = line(5.0, [x0, y0], [0.0, 0.0], [1.8], [4.2])
    source = "closed form: Bryson & Ho, chapter 2, Zermelo's problem with a linear current"
    return Reference(problem, T, source, start, recipe=Recipe(Lobatto(8, 7)))


def steering() -> Reference:
    """Least time to rise 5 and reach speed 45 with an acceleration of 100 of free angle."""
    problem = Problem(
        "steering",
        ["x", "y", "vx", "vy"],
        ["angle"],
        lambda x, u: [x[2], x[3], 100 * ca.cos(u[0]), 100 * ca.sin(u[0])],
        horizon=Free(0.1, 5.0, 0.6),
        initial=[0.0, 0.0, 0.0, 0.0],
        final=[None, 5.0, 45.0, 0.0],
        terminal_cost=lambda x, tf: tf,
        control_bounds=(-np.pi / 2, np.pi / 2),
    )
    source = (
        "closed form: linear-tangent law, Bryson & Ho, chapter 2; 'particle steering' of Dolan,"
        " Moré & Munson, COPS 3.0 (2004)"
    )
    printed = (Printed("0.55457088", "COPS, trapezoid on 12800 intervals"),)
    start = line(0.6, [0.0, 0.0, 0.0, 0.0], [10.0, 5.0, 45.0, 0.0], [0.8], [-0.8])
    recipe = Recipe(Radau(6, 8))
    return Reference(problem, _steering_time(), source, start, printed=printed, recipe=recipe)


def _steering_time(A: float = 100.0, rise: float = 5.0, speed: float = 45.0) -> float:
    """Return T of tan θ = k (1 − 2t/T): equal angles at both ends make v_y(T) = 0.

    v_x(T) = A T asinh(k)/k; y(T) = A T² I(k), from ∫∫ sin θ with s = tan θ.
    """

    def T_of(k: float) -> float:
        return float(speed * k / (A * np.arcsinh(k)))

    def miss(k: float) -> float:
        root = np.sqrt(1 + k**2)
        return float(A * T_of(k) ** 2 * (k * root - np.arcsinh(k)) / (4 * k**2) - rise)

    return T_of(brentq(miss, 1e-2, 1e2, xtol=1e-14))


def point_mass(A: float = 20.0, d: float = 5.0, g: float = 9.81) -> Reference:
    """Rest to rest over d at equal heights with a thrust acceleration of A or less, under gravity.

    tan of the thrust's elevation is k (1 − 2t/T) plus what holds the weight: asinh(k)/k = g/A for
    the tangent of the tilt; T = √(2d/(A I)). A lower bound for every thrust-vectored craft.
    """
    k = brentq(lambda s: np.arcsinh(s) / s - g / A, 1e-3, 1e3, xtol=1e-14)
    share = (k * np.sqrt(1 + k**2) - np.arcsinh(k)) / (2 * k**2)
    T = float(np.sqrt(2 * d / (A * share)))
    problem = Problem(
        "point mass",
        ["x", "z", "vx", "vz"],
        ["tilt"],
        lambda x, u: [x[2], x[3], A * ca.sin(u[0]), A * ca.cos(u[0]) - g],
        horizon=Free(0.2 * T, 5 * T, 1.2 * T),
        initial=[0.0] * 4,
        final=[d, 0.0, 0.0, 0.0],
        terminal_cost=lambda x, tf: tf,
    )
    start = line(T, [0.0] * 4, [d, 0.0, 0.0, 0.0], [1.2], [-1.2])
    source = "closed form: linear-tangent law, Bryson & Ho, chapter 2, with equal end heights"
    return Reference(problem, T, source, start, recipe=Recipe(Lobatto(12, 9)))
