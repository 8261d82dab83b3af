"""Chains of integrators: least time, energy and fuel, with and without limits.

Legend: d distance, T horizon, n length of the chain, u control, t time.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import factorial
from typing import Any

import numpy as np

from skyknot.bank.base import Array, Recipe, Reference, line
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.problem.variables import Control, State
from skyknot.transcription import HermiteSimpson, Lobatto, Radau

# Controls that may jump at nodes, which refinement lays on the switches.
JUMPING = Recipe(Radau(12, 3), accuracy=1e-6)


def minimum_energy(d: float = 1.0, T: float = 1.0) -> Reference:
    """½∫u² of a double integrator, rest to rest: u = 6d/T² (1 − 2t/T), x cubic."""

    def state(t: Array) -> Array:
        s = t / T
        return np.stack([d * s**2 * (3 - 2 * s), 6 * d / T * s * (1 - s)], axis=1)

    def control(t: Array) -> Array:
        return np.asarray((6 * d / T**2 * (1 - 2 * t / T))[:, None])

    def costate(t: Array) -> Array:
        return np.stack([np.full_like(t, -12 * d / T**3), -control(t)[:, 0]], axis=1)

    problem = Problem(
        "minimum energy",
        [State("x", "m"), State("v", "m/s")],
        [Control("a", "m/s²")],
        lambda x, u: [x[1], u[0]],
        horizon=T,
        initial=[0.0, 0.0],
        final=[d, 0.0],
        running_cost=lambda x, u: 0.5 * u[0] ** 2,
    )
    source = "closed form: Bryson & Ho, Applied Optimal Control, section 3.3"
    recipe = Recipe(HermiteSimpson(10))
    return Reference(problem, 6 * d**2 / T**3, source, None, state, control, costate, recipe=recipe)


def least_derivative(n: int = 3, d: float = 1.0, T: float = 1.0) -> Reference:
    """∫u² of n integrators, rest to rest over d: (2n − 1) ((2n − 2)! / (n − 1)!)² d² / T^(2n−1)."""
    cost = (2 * n - 1) * (factorial(2 * n - 2) / factorial(n - 1)) ** 2
    problem = Problem(
        f"least derivative {n}",
        [f"x{i}" for i in range(n)],
        ["u"],
        lambda x, u: [*(x[i] for i in range(1, n)), u[0]],
        horizon=T,
        initial=[0.0] * n,
        final=[d, *[0.0] * (n - 1)],
        running_cost=lambda x, u: u[0] ** 2,
    )
    source = (
        "closed form: the polynomial of degree 2n − 1 (Flash & Hogan, J. Neuroscience 5, 1985;"
        " Mellinger & Kumar, ICRA 2011)"
    )
    return Reference(
        problem, cost * d**2 / T ** (2 * n - 1), source, recipe=Recipe(Lobatto(4, n + 2))
    )


def minimum_time(d: float = 10.0, most: float = 1.0, least: float = 2.0) -> Reference:
    """Rest to rest over d with −least ≤ u ≤ most: T = √(2d (1/most + 1/least))."""
    T = float(np.sqrt(2 * d * (1 / most + 1 / least)))
    problem = Problem(
        "minimum time",
        ["x", "v"],
        ["a"],
        lambda x, u: [x[1], u[0]],
        horizon=Free(0.2 * T, 5 * T, 0.8 * T),
        initial=[0.0, 0.0],
        final=[d, 0.0],
        running_cost=lambda x, u: 1.0,
        control_bounds=(-least, most),
    )
    source = "closed form: Bryson & Ho, section 3.9, bang-bang with one switch"
    switch = T * least / (least + most)
    return Reference(problem, T, source, switches=(switch,), recipe=JUMPING)


def to_the_origin(x: float = 1.0, v: float = 1.0) -> Reference:
    """From (x, v) above the switching curve to rest at the origin with |u| ≤ 1, in least time."""
    half = np.sqrt(x + v**2 / 2)
    T = float(v + 2 * half)
    problem = Problem(
        "to the origin",
        ["x", "v"],
        ["a"],
        lambda x, u: [x[1], u[0]],
        horizon=Free(0.2 * T, 5 * T, 0.8 * T),
        initial=[x, v],
        final=[0.0, 0.0],
        terminal_cost=lambda x, tf: tf,
        control_bounds=(-1.0, 1.0),
    )
    source = "closed form: Bryson & Ho, section 3.9, the parabolas of the double integrator"
    # The straight line's way and speed contradict each other; this start overshoots a little.
    start = line(T, [x, 0.0], [0.0, 0.0], [-1.0], [1.0])
    return Reference(problem, T, source, start, switches=(float(v + half),), recipe=JUMPING)


def speed_limited(d: float = 1.0, most: float = 1.0, v_max: float = 0.5) -> Reference:
    """Rest to rest over d in least time with |u| ≤ most and |v| ≤ v_max: T = d/v_max + v_max/most.

    The trapezoid of every servo drive; a constraint of first order on a state.
    """
    T = d / v_max + v_max / most
    problem = Problem(
        "speed-limited",
        ["x", "v"],
        ["a"],
        lambda x, u: [x[1], u[0]],
        horizon=Free(0.2 * T, 5 * T, 0.9 * T),
        initial=[0.0, 0.0],
        final=[d, 0.0],
        terminal_cost=lambda x, tf: tf,
        state_bounds=([None, -v_max], [None, v_max]),
        control_bounds=(-most, most),
    )
    ramp = v_max / most
    source = "closed form: the trapezoidal profile; area under it is d"
    return Reference(problem, T, source, switches=(ramp, T - ramp), recipe=JUMPING)


def chain_minimum_time(n: int = 3, d: float = 1.0) -> Reference:
    """N integrators, |u| ≤ 1, rest to rest over d: switches at T/2 (1 − cos kπ/n).

    With u = ±1 in turn, d = T^n Σ_k ±[(1 − s_k)^n − (1 − s_{k+1})^n]/n! gives T.
    """
    s = 0.5 * (1 - np.cos(np.arange(n + 1) * np.pi / n))
    share = sum(
        (-1) ** k * ((1 - a) ** n - (1 - b) ** n) / factorial(n)
        for k, (a, b) in enumerate(pairwise(s))
    )
    T = float((d / share) ** (1 / n))
    problem = Problem(
        f"chain of {n}, minimum time",
        [f"x{i}" for i in range(n)],
        ["u"],
        lambda x, u: [*(x[i] for i in range(1, n)), u[0]],
        horizon=Free(0.2 * T, 5 * T, 1.2 * T),
        initial=[0.0] * n,
        final=[d, *[0.0] * (n - 1)],
        terminal_cost=lambda x, tf: tf,
        control_bounds=(-1.0, 1.0),
    )
    source = (
        "closed form: moments of ±1 vanish at the extrema of Chebyshev's polynomials of the second"
        " kind (Karlin & Studden, Tchebycheff Systems, 1966)"
    )
    switches = tuple(float(T * each) for each in s[1:-1])
    return Reference(problem, T, source, switches=switches, recipe=JUMPING)


def minimum_fuel(d: float = 1.0, T: float = 4.0) -> Reference:
    """∫|u| of a double integrator with |u| ≤ 1, rest to rest over d in T: full, coast, full.

    |u| is u⁺ + u⁻ with u = u⁺ − u⁻, both in [0, 1].
    """
    burn = 0.5 * (T - np.sqrt(T**2 - 4 * d))
    problem = Problem(
        "minimum fuel",
        ["x", "v"],
        ["push", "pull"],
        lambda x, u: [x[1], u[0] - u[1]],
        horizon=T,
        initial=[0.0, 0.0],
        final=[d, 0.0],
        running_cost=lambda x, u: u[0] + u[1],
        control_bounds=(0.0, 1.0),
    )
    source = "closed form: Athans & Falb, Optimal Control, 1966: bang-off-bang"
    switches = (float(burn), float(T - burn))
    return Reference(problem, float(2 * burn), source, switches=switches, recipe=JUMPING)


def soft_landing(h: float = 10.0, v: float = -2.0, gravity: float = 1.5) -> Reference:
    """Fall from height h, land at rest with least ∫u, 0 ≤ u ≤ 2 gravity: coast, then full thrust.

    Coasting for s: (v − g s)² / 2g = h + v s − g s²/2 at the switch.
    """
    g = gravity
    s = float((v + np.sqrt(v**2 / 2 + g * h)) / g)
    burn = (g * s - v) / g
    problem = Problem(
        "soft landing",
        ["h", "v"],
        ["u"],
        lambda x, u: [x[1], u[0] - g],
        horizon=Free(1.0, 20.0, 5.0),
        initial=[h, v],
        final=[0.0, 0.0],
        running_cost=lambda x, u: u[0],
        control_bounds=(0.0, 2 * g),
    )
    source = "closed form: Meditch, IEEE Trans. Automatic Control 9 (1964) 477–484: one switch"
    return Reference(problem, 2 * g * burn, source, switches=(s,), recipe=JUMPING)


def fuller() -> Reference:
    """∫x² of a double integrator, |u| ≤ 1, from (1, 0): infinitely many switches in finite time.

    Switches lie on x = −z v|v| with z = √((√33 − 1)/24); the arcs between them shrink
    geometrically and are summed until they vanish.
    """
    z = np.sqrt((np.sqrt(33) - 1) / 24)
    x, v, u, t, cost = 1.0, 0.0, -1.0, 0.0, 0.0
    switches = []
    for _ in range(40):
        # x + v s + u s²/2 = −u z (v + u s)², with s the length of the arc
        roots = np.roots([u / 2 + u * z, v + 2 * z * v, x + u * z * v**2])
        s = float(max(roots.real))
        x_of_s = np.polynomial.Polynomial([x, v, u / 2])
        cost += float((x_of_s**2).integ()(s))
        x, v, t, u = float(x_of_s(s)), v + u * s, t + s, -u
        switches.append(t)
    problem = Problem(
        "fuller",
        ["x", "v"],
        ["u"],
        lambda x, u: [x[1], u[0]],
        horizon=3.0,
        initial=[1.0, 0.0],
        final=[0.0, 0.0],
        running_cost=lambda x, u: x[0] ** 2,
        control_bounds=(-1.0, 1.0),
    )
    source = (
        "closed form: Fuller, Proc. 1st IFAC Congress, 1960; Zelikin & Borisov, Theory of"
        " Chattering Control, 1994; at rest from the last switch on"
    )
    return Reference(
        problem, cost, source, switches=tuple(switches[:3]), complete=False, recipe=JUMPING
    )


def quadratic_drag(d: float = 10.0, most: float = 1.0, c: float = 0.1) -> Reference:
    """Rest to rest over d in least time with dv/dt = u − c v|v|: tanh up, tan down.

    Speeds are never negative on the way, so that v|v| = v².
    """
    q = np.sqrt(np.tanh(c * d))
    switch = float(np.arctanh(q) / np.sqrt(most * c))
    T = switch + float(np.arctan(q) / np.sqrt(most * c))
    source = "closed form: both arcs integrated by hand; speed at the switch q √(most/c)"
    return Reference(
        _dragged("quadratic drag", d, most, T, lambda v: c * v**2),
        T,
        source,
        switches=(switch,),
        recipe=JUMPING,
    )


def linear_drag(d: float = 10.0, most: float = 1.0, k: float = 0.1) -> Reference:
    """Rest to rest over d in least time with dv/dt = u − k v."""
    V = most / k * np.sqrt(1 - np.exp(-(k**2) * d / most))
    switch = float(-np.log(1 - k * V / most) / k)
    T = switch + float(np.log(1 + k * V / most) / k)
    source = "closed form: both arcs integrated by hand; V is the speed at the switch"
    return Reference(
        _dragged("linear drag", d, most, T, lambda v: k * v),
        T,
        source,
        switches=(switch,),
        recipe=JUMPING,
    )


def _dragged(name: str, d: float, most: float, T: float, drag: Callable[[Any], Any]) -> Problem:
    return Problem(
        name,
        ["x", "v"],
        ["u"],
        lambda x, u: [x[1], u[0] - drag(x[1])],
        horizon=Free(0.2 * T, 5 * T, 0.9 * T),
        initial=[0.0, 0.0],
        final=[d, 0.0],
        terminal_cost=lambda x, tf: tf,
        control_bounds=(-most, most),
    )
