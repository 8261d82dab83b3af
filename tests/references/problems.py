"""A bank of reference problems, each with its optimum and where that comes from.

Legend: d distance, T horizon, l bound on a state, u control, t time, θ an angle.

Every ``Reference`` holds a problem, the start used with it, the optimum of the continuous problem
and its source. "closed form" optima are evaluated here from the formula cited; the few "computed"
ones are multi-phase Radau and Gauss collocation (degrees 4–8, tolerance 1e-12) of the
project, printed to the digits on which both families agree.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.optimize import brentq

import skyknot as sk
from skyknot.models import Allocation, Vehicle


@dataclass(frozen=True)
class Reference:
    """A problem with its known optimum.

    Attributes
    ----------
    problem : what is asked
    optimum : least objective of the continuous problem
    source : where the optimum comes from
    guess : where to start; None for the guess ladder
    state, control, costate : closed forms (t (M,) → (M, n)), where there are any
    """

    problem: sk.Problem
    optimum: float
    source: str
    guess: sk.Trajectory | None = None
    state: Callable[[np.ndarray], np.ndarray] | None = None
    control: Callable[[np.ndarray], np.ndarray] | None = None
    costate: Callable[[np.ndarray], np.ndarray] | None = None


def line(T: float, first: list, last: list, first_control: list, last_control: list):
    """Return the start that runs straight from the first values to the last ones."""
    return sk.Trajectory([0.0, T], [first, last], [first_control, last_control])


# --- smooth problems with closed-form state, control and costate ----------------------------------


def hager() -> Reference:
    """½∫(u² + 2x²), ẋ = x/2 + u: W. W. Hager, Numer. Math. 87 (2000) 247–282."""
    e3 = np.exp(3.0)

    def state(t):
        return ((2 * np.exp(3 * t) + e3) / (np.exp(1.5 * t) * (2 + e3)))[:, None]

    def control(t):
        return (2 * (np.exp(3 * t) - e3) / (np.exp(1.5 * t) * (2 + e3)))[:, None]

    problem = sk.Problem(
        "hager",
        ["x"],
        ["u"],
        lambda x, u: [0.5 * x[0] + u[0]],
        horizon=1.0,
        initial=[1.0],
        running_cost=lambda x, u: 0.5 * (u[0] ** 2 + 2 * x[0] ** 2),
    )
    # The value function of this problem is ½ P(0) x(0)², and P(0) x(0) = λ(0) = −u(0).
    optimum = -0.5 * control(np.array([0.0]))[0, 0]
    source = "closed form: Hager 2000, first example; J = ½ λ(0) x(0)"
    return Reference(problem, optimum, source, None, state, control, lambda t: -control(t))


def garg() -> Reference:
    """Maximise y(2), ẏ = 5/2 (−y + y u − u²): Garg et al., Automatica 46 (2010) 1843–1851."""

    def state(t):
        return (4 / (1 + 3 * np.exp(2.5 * t)))[:, None]

    def costate(t):
        grown = np.exp(2 * np.log(1 + 3 * np.exp(2.5 * t)) - 2.5 * t)
        return (-grown / (np.exp(-5) + 6 + 9 * np.exp(5)))[:, None]

    problem = sk.Problem(
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
    return Reference(problem, optimum, source, start, state, lambda t: state(t) / 2, costate)


def minimum_energy(d: float = 1.0, T: float = 1.0) -> Reference:
    """½∫u² of a double integrator, rest to rest: u = 6d/T² (1 − 2t/T), x cubic."""

    def state(t):
        s = t / T
        return np.stack([d * s**2 * (3 - 2 * s), 6 * d / T * s * (1 - s)], axis=1)

    def control(t):
        return (6 * d / T**2 * (1 - 2 * t / T))[:, None]

    def costate(t):
        return np.stack([np.full_like(t, -12 * d / T**3), -control(t)[:, 0]], axis=1)

    problem = sk.Problem(
        "minimum energy",
        [sk.State("x", "m"), sk.State("v", "m/s")],
        [sk.Control("a", "m/s²")],
        lambda x, u: [x[1], u[0]],
        horizon=T,
        initial=[0.0, 0.0],
        final=[d, 0.0],
        running_cost=lambda x, u: 0.5 * u[0] ** 2,
    )
    source = "closed form: Bryson & Ho, Applied Optimal Control, section 3.3"
    return Reference(problem, 6 * d**2 / T**3, source, None, state, control, costate)


# --- quadratic regulators -------------------------------------------------------------------------


def regulator(
    A: np.ndarray,
    B: np.ndarray,
    Q: np.ndarray,
    R: np.ndarray,
    x0: np.ndarray,
    T: float,
    Q_final: np.ndarray | None = None,
) -> sk.Problem:
    """Return min ½∫(xᵀQx + uᵀRu) + ½ x(T)ᵀQ_f x(T), ẋ = Ax + Bu, x(0) = x0."""
    tracking = sk.QuadraticTracking(
        np.zeros(len(A)), Q / 2, R / 2, None if Q_final is None else Q_final / 2
    )
    return sk.Problem(
        "regulator",
        [f"x{i}" for i in range(len(A))],
        [f"u{i}" for i in range(B.shape[1])],
        lambda x, u: ca.DM(A) @ x + ca.DM(B) @ u,
        horizon=T,
        initial=list(x0),
        **tracking.callables(),
    )


def scalar_regulator(T: float = 1.0) -> Reference:
    """½∫(x² + u²), ẋ = u, x(0) = 1: J = ½ tanh T."""
    one = np.eye(1)
    problem = regulator(0 * one, one, one, one, np.ones(1), T)
    return Reference(
        problem, 0.5 * np.tanh(T), "closed form: Ṗ = P² − 1, P(T) = 0, P = tanh(T − t)"
    )


# --- state bounds ---------------------------------------------------------------------------------


def bryson_denham(l: float = 1 / 9) -> Reference:  # noqa: E741  (the letter of the source)
    """½∫u² from (0, 1) to (0, −1) with x ≤ l: Bryson & Ho, section 3.11."""
    touching = 2 + 6 * max(1 - 4 * l, 0) ** 2
    optimum = 4 / (9 * l) if l <= 1 / 6 else touching
    problem = sk.Problem(
        "bryson-denham",
        ["x", "v"],
        ["a"],
        lambda x, u: [x[1], u[0]],
        horizon=1.0,
        initial=[0.0, 1.0],
        final=[0.0, -1.0],
        running_cost=lambda x, u: 0.5 * u[0] ** 2,
        state_bounds=([None, None], [l, None]),
    )
    source = "closed form: Bryson, Denham & Dreyfus, AIAA J. 1 (1963) 2544–2550"
    return Reference(problem, optimum, source)


def van_der_pol(x1_lower: float | None = None, u_bound: float | None = None) -> Reference:
    """∫(x1² + x2² + u²) of a driven Van der Pol oscillator over 10 s from (0, 1)."""
    known = {(None, None): 2.87314385118, (-0.25, 1.0): 3.6151814, (None, 1.0): 2.8733043}
    problem = sk.Problem(
        "van der pol",
        ["x1", "x2"],
        ["u"],
        lambda x, u: [(1 - x[1] ** 2) * x[0] - x[1] + u[0], x[0]],
        horizon=10.0,
        initial=[0.0, 1.0],
        running_cost=lambda x, u: x[0] ** 2 + x[1] ** 2 + u[0] ** 2,
        state_bounds=([x1_lower, None], [None, None]),
        control_bounds=(None if u_bound is None else -u_bound, u_bound),
    )
    source = "computed; problem of Andersson et al., CasADi, Math. Prog. Comp. 11 (2019)"
    start = line(10.0, [0.0, 1.0], [0.0, 0.0], [0.0], [0.0])
    return Reference(problem, known[x1_lower, u_bound], source, start)


# --- minimum time ---------------------------------------------------------------------------------


def minimum_time(d: float = 10.0, most: float = 1.0, least: float = 2.0) -> Reference:
    """Rest to rest over d with −least ≤ u ≤ most: T = √(2d (1/most + 1/least))."""
    T = float(np.sqrt(2 * d * (1 / most + 1 / least)))
    problem = sk.Problem(
        "minimum time",
        ["x", "v"],
        ["a"],
        lambda x, u: [x[1], u[0]],
        horizon=sk.Free(0.2 * T, 5 * T, 0.8 * T),
        initial=[0.0, 0.0],
        final=[d, 0.0],
        running_cost=lambda x, u: 1.0,
        control_bounds=(-least, most),
    )
    return Reference(problem, T, "closed form: Bryson & Ho, section 3.9, bang-bang with one switch")


def brachistochrone(X: float = 10.0, Y: float = 5.0, g: float = 9.80665) -> Reference:
    """Descent of Y over X in least time: a cycloid, T = θ √(a/g)."""
    theta = brentq(lambda s: (s - np.sin(s)) / (1 - np.cos(s)) - X / Y, 1e-3, 2 * np.pi - 1e-3)
    T = float(theta * np.sqrt(Y / (1 - np.cos(theta)) / g))
    problem = sk.Problem(
        "brachistochrone",
        ["x", "y", "v"],
        ["angle"],
        lambda x, u: [x[2] * ca.sin(u[0]), -x[2] * ca.cos(u[0]), g * ca.cos(u[0])],
        horizon=sk.Free(0.1, 10.0, 2.0),
        initial=[0.0, Y, 0.0],
        final=[X, 0.0, None],
        terminal_cost=lambda x, tf: tf,
    )
    start = line(2.0, [0.0, Y, 0.0], [X, 0.0, np.sqrt(2 * g * Y)], [0.1], [1.7])
    return Reference(problem, T, "closed form: Johann Bernoulli 1696, the cycloid", start)


def steering() -> Reference:
    """Least time to rise 5 and reach speed 45 with an acceleration of 100 of free angle."""
    problem = sk.Problem(
        "steering",
        ["x", "y", "vx", "vy"],
        ["angle"],
        lambda x, u: [x[2], x[3], 100 * ca.cos(u[0]), 100 * ca.sin(u[0])],
        horizon=sk.Free(0.1, 5.0, 0.6),
        initial=[0.0, 0.0, 0.0, 0.0],
        final=[None, 5.0, 45.0, 0.0],
        terminal_cost=lambda x, tf: tf,
        control_bounds=(-np.pi / 2, np.pi / 2),
    )
    source = "computed; 'particle steering' of Dolan, Moré & Munson, COPS 3.0 (2004): 0.55457088"
    start = line(0.6, [0.0, 0.0, 0.0, 0.0], [10.0, 5.0, 45.0, 0.0], [0.8], [-0.8])
    return Reference(problem, 0.5545708783, source, start)


# --- mechanics ------------------------------------------------------------------------------------


def cart_pole() -> Reference:
    """Swing-up with least ∫u²: M. Kelly, SIAM Review 59 (2017) 849–904, section 6."""
    m1, m2, length, g = 1.0, 0.3, 0.5, 9.81

    def dynamics(x, u):
        s, c = ca.sin(x[1]), ca.cos(x[1])
        spin = length * m2 * s * x[3] ** 2
        share = m1 + m2 * s**2
        return [
            x[2],
            x[3],
            (spin + u[0] + m2 * g * c * s) / share,
            -(c * spin + u[0] * c + (m1 + m2) * g * s) / (length * share),
        ]

    problem = sk.Problem(
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
    source = "computed; problem of Kelly 2017 (dymos asserts 58.88 within 1e-3)"
    return Reference(problem, 58.8076674580, source)


def quadrotor_transfer() -> Reference:
    """3 m ahead, 2 m left, 1 m up, 45° of yaw left in 2 s, rest to rest, least ∫Σ(f_i − mg/4)²."""
    lever, kappa = 0.17, 0.016
    hubs = ((lever, -lever), (lever, lever), (-lever, lever), (-lever, -lever))
    allocation = Allocation(hubs, (1, -1, 1, -1), kappa)
    craft = Vehicle(
        name="q",
        title="12-state craft of the reference problems",
        kind="small",
        mass=1.0,
        inertia=(0.01, 0.011, 0.02),
        gravity=9.81,
        allocation=allocation,
        thrust_min=0.0,
        thrust_max=10.0,
    )
    model = craft.rotor_model()
    hover = 9.81 / 4
    first, last = np.zeros(12), np.array([3, -2, -1, 0, 0, 0, 0, 0, -np.pi / 4, 0, 0, 0])
    problem = sk.Problem(
        "quadrotor transfer",
        list(model.state_names),
        list(model.control_names),
        model.dynamics,
        horizon=2.0,
        initial=list(first),
        final=list(last),
        running_cost=lambda x, u: sum((u[i] - hover) ** 2 for i in range(4)),
    )
    start = line(2.0, first, last, [hover] * 4, [hover] * 4)
    return Reference(problem, 0.9649868217, "computed; no bound is active", start)
