"""Smooth problems with no bound active: regulators, and those whose optima are analytic.

Legend: x state, u control, t time, T horizon; A, B, Q, R of the linear–quadratic regulator; J cost.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from skyknot.bank.base import Array, Printed, Recipe, Reference, line
from skyknot.problem.costs import QuadraticTracking
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.transcription import Lobatto, Radau


def hager() -> Reference:
    """½∫(u² + 2x²), ẋ = x/2 + u: W. W. Hager, Numer. Math. 87 (2000) 247–282."""
    e3 = np.exp(3.0)

    def state(t: Array) -> Array:
        return np.asarray(((2 * np.exp(3 * t) + e3) / (np.exp(1.5 * t) * (2 + e3)))[:, None])

    def control(t: Array) -> Array:
        return np.asarray((2 * (np.exp(3 * t) - e3) / (np.exp(1.5 * t) * (2 + e3)))[:, None])

    problem = Problem(
        "hager",
        ["x"],
        ["u"],
        lambda x, u: [0.5 * x[0] + u[0]],
        horizon=1.0,
        initial=[1.0],
        running_cost=lambda x, u: 0.5 * (u[0] ** 2 + 2 * x[0] ** 2),
    )
    # The value function of this problem is ½ P(0) x(0)², and P(0) x(0) = λ(0) = −u(0).
    optimum = -0.5 * float(control(np.array([0.0]))[0, 0])
    source = "closed form: Hager 2000, first example; J = ½ λ(0) x(0)"
    return Reference(problem, optimum, source, None, state, control, lambda t: -control(t))


def garg() -> Reference:
    """Maximise y(2), ẏ = 5/2 (−y + y u − u²): Garg et al., Automatica 46 (2010) 1843–1851."""

    def state(t: Array) -> Array:
        return np.asarray((4 / (1 + 3 * np.exp(2.5 * t)))[:, None])

    def costate(t: Array) -> Array:
        grown = np.exp(2 * np.log(1 + 3 * np.exp(2.5 * t)) - 2.5 * t)
        return np.asarray((-grown / (np.exp(-5) + 6 + 9 * np.exp(5)))[:, None])

    problem = Problem(
        "garg",
        ["y"],
        ["u"],
        lambda y, u: [2.5 * (-y[0] + y[0] * u[0] - u[0] ** 2)],
        horizon=2.0,
        initial=[1.0],
        terminal_cost=lambda y, tf: -y[0],
    )
    optimum = -float(state(np.array([2.0]))[0, 0])
    source = "closed form: Garg et al. 2010, example 1"
    start = line(2.0, [1.0], [0.1], [0.5], [0.1])
    recipe = Recipe(Lobatto(4, 8))
    return Reference(
        problem, optimum, source, start, state, lambda t: state(t) / 2, costate, recipe=recipe
    )


def regulator(
    A: Array,
    B: Array,
    Q: Array,
    R: Array,
    x0: Array,
    T: float,
    Q_final: Array | None = None,
) -> Problem:
    """Return min ½∫(xᵀQx + uᵀRu) + ½ x(T)ᵀQ_f x(T), ẋ = Ax + Bu, x(0) = x0."""
    tracking = QuadraticTracking(
        np.zeros(len(A)), Q / 2, R / 2, None if Q_final is None else Q_final / 2
    ).callables()
    return Problem(
        "regulator",
        [f"x{i}" for i in range(len(A))],
        [f"u{i}" for i in range(B.shape[1])],
        lambda x, u: ca.DM(A) @ x + ca.DM(B) @ u,
        horizon=T,
        initial=list(x0),
        running_cost=tracking["running_cost"],
        terminal_cost=tracking.get("terminal_cost"),
    )


def scalar_regulator(T: float = 1.0) -> Reference:
    """½∫(x² + u²), ẋ = u, x(0) = 1: J = ½ tanh T."""
    one = np.eye(1)
    problem = regulator(0 * one, one, one, one, np.ones(1), T)
    source = "closed form: Ṗ = P² − 1, P(T) = 0, P = tanh(T − t)"
    return Reference(problem, float(0.5 * np.tanh(T)), source)


def coupled_regulator() -> Reference:
    """½∫(5/4 x² + xu + u²), ẋ = x/2 + u, x(0) = 1: with v = u + x/2 it is ½∫(x² + v²), ẋ = v."""
    problem = Problem(
        "coupled regulator",
        ["x"],
        ["u"],
        lambda x, u: [0.5 * x[0] + u[0]],
        horizon=1.0,
        initial=[1.0],
        running_cost=lambda x, u: 0.5 * (1.25 * x[0] ** 2 + x[0] * u[0] + u[0] ** 2),
    )
    source = "closed form: ½ tanh 1, that of the scalar regulator"
    return Reference(problem, float(0.5 * np.tanh(1.0)), source)


def double_regulator(T: float = 1.0, *, stationary: bool = False) -> Reference:
    """½∫(|x|² + u²) of a double integrator from (1, 0): J = ½ P11(0).

    P(0) from the flow exp(−HT) of the Hamiltonian matrix; ``stationary`` puts the P of the
    infinite horizon, [[√3, 1], [1, √3]], at the end, and then every horizon costs √3/2.
    """
    A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])
    endless = np.array([[np.sqrt(3), 1.0], [1.0, np.sqrt(3)]])
    P = endless if stationary else np.zeros((2, 2))
    H = np.block([[A, -B @ B.T], [-np.eye(2), -A.T]])
    flow = expm(-H * T) @ np.vstack([np.eye(2), P])
    optimum = 0.5 * float((flow[2:] @ np.linalg.inv(flow[:2]))[0, 0])
    problem = regulator(A, B, np.eye(2), np.eye(1), np.array([1.0, 0.0]), T, P)
    source = "closed form: Kalman, Boletín Soc. Mat. Mexicana 5 (1960); Bryson & Ho, section 5.2"
    return Reference(problem, optimum, source, recipe=Recipe(Lobatto(8, 5)))


def oscillator(T: float = 5.0) -> Reference:
    """∫u² that brings ẍ = −x + u from (1, 0) to rest: x0ᵀΦᵀ W⁻¹ Φx0, W the Gramian."""
    s, c = np.sin(T), np.cos(T)
    W = 0.5 * np.array([[T - s * c, s**2], [s**2, T + s * c]])
    drift = np.array([c, -s])
    problem = Problem(
        "oscillator",
        ["x", "v"],
        ["u"],
        lambda x, u: [x[1], u[0] - x[0]],
        horizon=T,
        initial=[1.0, 0.0],
        final=[0.0, 0.0],
        running_cost=lambda x, u: u[0] ** 2,
    )
    source = "closed form: the controllability Gramian (Kalman, Ho & Narendra 1963)"
    optimum = float(drift @ np.linalg.solve(W, drift))
    return Reference(problem, optimum, source, recipe=Recipe(Lobatto(8, 5)))


def cart() -> Reference:
    """Maximise x(1) − ½∫u², v̇ = u − v from rest: u = 1 − e^(t−1), J = −½∫u²."""
    problem = Problem(
        "cart",
        ["x", "v"],
        ["u"],
        lambda x, u: [x[1], u[0] - x[1]],
        horizon=1.0,
        initial=[0.0, 0.0],
        running_cost=lambda x, u: 0.5 * u[0] ** 2,
        terminal_cost=lambda x, tf: -x[0],
    )
    e = np.exp(-1.0)
    source = "closed form: Bryson, Dynamic Optimization, 1999: u is the costate of v"
    return Reference(problem, float(-0.5 * (1 - 2 * (1 - e) + 0.5 * (1 - e**2))), source)


def hypersensitive(first: float = 1.5, last: float = 1.0, T: float = 50.0) -> Reference:
    """½∫(x² + u²), ẋ = u − x³ from 1.5 to 1: a fast decay, a long rest, a fast rise.

    To e^(−T) the two ends are apart: u = x³ ∓ √(x⁶ + x²), and the cost is the sum of the integrals
    of the costate along the stable and the unstable manifold.
    """

    def part(x: float) -> float:
        return float(0.25 * (x**2 * np.sqrt(x**4 + 1) + np.arcsinh(x**2)))

    problem = Problem(
        "hypersensitive",
        ["x"],
        ["u"],
        lambda x, u: [u[0] - x[0] ** 3],
        horizon=T,
        initial=[first],
        final=[last],
        running_cost=lambda x, u: 0.5 * (x[0] ** 2 + u[0] ** 2),
    )
    optimum = part(first) - first**4 / 4 + part(last) + last**4 / 4
    source = "closed form: problem of Rao & Mease, Optimal Control Appl. Meth. 21 (2000) 1–19"
    wrong = "off by 1.9e-5: the discretisation of its authors"
    printed = (Printed("1.330826", "PSOPT, doc/SQP_ALL_EXAMPLES", wrong),)
    recipe = Recipe(Lobatto(20, 5), accuracy=1e-7)
    return Reference(
        problem, optimum, source, printed=printed if first == 1.5 else (), recipe=recipe
    )


def linear_hypersensitive(T: float = 10.0) -> Reference:
    """½∫(x² + u²), ẋ = u − x from 1.5 to 1: x″ = 2x, J = ½ [x ẋ + x²] between the ends."""
    k = np.sqrt(2.0)
    slopes = (
        k * (1 - 1.5 * np.cosh(k * T)) / np.sinh(k * T),
        k * (np.cosh(k * T) - 1.5) / np.sinh(k * T),
    )
    problem = Problem(
        "linear hypersensitive",
        ["x"],
        ["u"],
        lambda x, u: [u[0] - x[0]],
        horizon=T,
        initial=[1.5],
        final=[1.0],
        running_cost=lambda x, u: 0.5 * (x[0] ** 2 + u[0] ** 2),
    )
    optimum = float(0.5 * ((slopes[1] + 1.0) - (1.5 * slopes[0] + 1.5**2)))
    source = "closed form: Euler–Lagrange equation integrated by hand"
    # Not refined: errors grow by e^(√2 T) in open-loop flight, which no mesh can mend.
    return Reference(problem, optimum, source, recipe=Recipe(Lobatto(60, 9)))


def hanging_chain(L: float = 4.0, a: float = 1.0, b: float = 3.0) -> Reference:
    """Potential energy ∫x√(1 + ẋ²) of a chain of length L between heights a and b, 1 apart.

    The catenary x = c cosh((t − t0)/c) + k; c from L² − (b − a)² = 4c² sinh²(1/2c).
    """
    reach = np.sqrt(L**2 - (b - a) ** 2)
    c = brentq(lambda c: 2 * c * np.sinh(0.5 / c) - reach, 0.02, 10.0)
    t0 = 0.5 - c * np.arcsinh((b - a) / (2 * c * np.sinh(0.5 / c)))
    k = a - c * np.cosh(t0 / c)
    squared = 0.5 + 0.25 * c * (np.sinh(2 * (1 - t0) / c) + np.sinh(2 * t0 / c))
    problem = Problem(
        "hanging chain",
        ["height", "length"],
        ["slope"],
        lambda x, u: [u[0], ca.sqrt(1 + u[0] ** 2)],
        horizon=1.0,
        initial=[a, 0.0],
        final=[b, L],
        running_cost=lambda x, u: x[0] * ca.sqrt(1 + u[0] ** 2),
        state_bounds=([0.0, 0.0], [10.0, L]),
        control_bounds=(-10.0, 20.0),
    )
    source = "closed form: the catenary; problem of Dolan, Moré & Munson, COPS 3.0 (2004)"
    # The start of COPS: a parabola that hangs through, steepest at the higher end.
    t = np.linspace(0.0, 1.0, 41)
    height, slope = 4 * (b - a) * t * (0.5 * t - 0.25) + a, 4 * (b - a) * (t - 0.25)
    start = Trajectory(t, np.stack([height, L * t], axis=1), slope[:, None])
    printed = (Printed("5.068480", "PSOPT, doc/SQP_ALL_EXAMPLES"),)
    # Where nodes are points of two segments, a spike there is cheaper than it is: not Lobatto.
    recipe = Recipe(Radau(20, 6))
    optimum = float(k * L + c * squared)
    return Reference(problem, optimum, source, start, printed=printed, recipe=recipe)
