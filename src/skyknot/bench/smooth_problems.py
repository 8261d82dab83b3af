"""Smooth problems with closed forms, to measure orders and spectral decay on.

Legend: x state, u control, p costate with H = ℓ + pᵀf, T horizon; x = sinh y and u = sinh v curve
the first problem, whose optimum stays known while no scheme is linear in it any more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]
Form = Callable[[Array], Array]


@dataclass(frozen=True)
class SmoothProblem:
    """A problem with one state and one control, and its optimum as functions of time.

    Attributes
    ----------
    problem : what is asked
    guess : where to start
    state, control, costate : t (M,) → (M,)
    """

    problem: Problem
    guess: Trajectory
    state: Form
    control: Form
    costate: Form


def linear(T: float = 3.0) -> SmoothProblem:
    """Return ½∫(u² + 2x²), ẋ = x/2 + u, x(0) = 1, the first example of Hager over a horizon T.

    u = −p and ṗ = −2x − p/2 give x = c(2e^(3t/2 − 3T) + e^(−3t/2)), p = 2c(e^(−3t/2) −
    e^(3t/2 − 3T)) with c = 1/(1 + 2e^(−3T)): W. W. Hager, Numer. Math. 87 (2000) 247–282.
    """
    problem = Problem(
        "linear",
        ["x"],
        ["u"],
        lambda x, u: [0.5 * x[0] + u[0]],
        horizon=T,
        initial=[1.0],
        running_cost=lambda x, u: 0.5 * (u[0] ** 2 + 2 * x[0] ** 2),
    )
    state, costate = _hager(T)
    return SmoothProblem(
        problem, _line(T, (1.0, 0.0), (0.0, 0.0)), state, lambda t: -costate(t), costate
    )


def curved(T: float = 3.0) -> SmoothProblem:
    """Return the linear problem seen through x = sinh y, u = sinh v: p_y = p cosh y."""
    state, costate = _hager(T)
    problem = Problem(
        "curved",
        ["y"],
        ["v"],
        lambda y, v: [(0.5 * ca.sinh(y[0]) + ca.sinh(v[0])) / ca.cosh(y[0])],
        horizon=T,
        initial=[float(np.arcsinh(1.0))],
        running_cost=lambda y, v: 0.5 * (ca.sinh(v[0]) ** 2 + 2 * ca.sinh(y[0]) ** 2),
    )
    return SmoothProblem(
        problem,
        _line(T, (float(np.arcsinh(1.0)), 0.0), (0.0, 0.0)),
        lambda t: np.arcsinh(state(t)),
        lambda t: -np.arcsinh(costate(t)),
        lambda t: costate(t) * np.sqrt(1 + state(t) ** 2),
    )


def mayer() -> SmoothProblem:
    """Return: maximise y(2), ẏ = 5/2 (−y + y u − u²), y(0) = 1, whose control ignores the costate.

    y = 4/(1 + 3e^(5t/2)), u = y/2: Garg et al., Automatica 46 (2010) 1843–1851, example 1. The
    poles of y nearest to [0, 2] are at t = (−ln 3 ± iπ)/2.5.
    """
    problem = Problem(
        "mayer",
        ["y"],
        ["u"],
        lambda y, u: [2.5 * (-y[0] + y[0] * u[0] - u[0] ** 2)],
        horizon=2.0,
        initial=[1.0],
        terminal_cost=lambda y, _: -y[0],
    )

    def state(t: Array) -> Array:
        return np.asarray(4 / (1 + 3 * np.exp(2.5 * t)))

    def costate(t: Array) -> Array:
        grown = (1 + 3 * np.exp(2.5 * t)) ** 2 * np.exp(-2.5 * t)
        return np.asarray(-grown / (np.exp(-5) + 6 + 9 * np.exp(5)))

    return SmoothProblem(
        problem,
        _line(2.0, (1.0, 0.1), (0.5, 0.1)),
        state,
        lambda t: 0.5 * state(t),
        costate,
    )


def _hager(T: float) -> tuple[Form, Form]:
    c = 1 / (1 + 2 * np.exp(-3 * T))

    def state(t: Array) -> Array:
        return np.asarray(c * (2 * np.exp(1.5 * t - 3 * T) + np.exp(-1.5 * t)))

    def costate(t: Array) -> Array:
        return np.asarray(2 * c * (np.exp(-1.5 * t) - np.exp(1.5 * t - 3 * T)))

    return state, costate


def _line(T: float, states: tuple[float, float], controls: tuple[float, float]) -> Trajectory:
    x, u = (np.array(values)[:, None] for values in (states, controls))
    return Trajectory(np.array([0.0, T]), x, u)
