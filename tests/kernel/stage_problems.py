"""Random problems that together use everything a Newton system can contain.

Legend: A, B dynamics, Q, R cost, G, g path rows; all drawn from the seed of the case.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from hypothesis import strategies as st

import skyknot as sk

CHOICES = [
    ("euler", "hold"),
    ("trapezoid", "linear"),
    ("trapezoid", "hold"),
    ("hermite-simpson", "quadratic"),
    ("hermite-simpson", "linear"),
    ("hermite-simpson", "hold"),
]


@dataclass(frozen=True)
class Case:
    """One random problem; ``spread`` is the number of decades of the weights around one."""

    nx: int
    nu: int
    N: int
    scheme: tuple[str, str]
    seed: int
    uneven: bool = False
    free_horizon: bool = False
    parameters: int = 0
    inequalities: int = 0
    equalities: int = 0
    repeated: bool = False
    final: int = 0
    final_twice: bool = False
    free_start: bool = False
    bounds: bool = True
    rates: bool = False
    bend: float = 0.0
    curvature: float = 1.0
    singular: bool = False
    regularisation: float = 0.0
    spread: float = 2.0


def cases(most_states: int = 8, **fixed):
    """Return a strategy of cases."""
    free = {
        "nx": st.integers(1, most_states),
        "nu": st.integers(1, 6),
        "N": st.integers(1, 12),
        "scheme": st.sampled_from(CHOICES),
        "seed": st.integers(0, 10**6),
        **dict.fromkeys(
            ("uneven", "free_horizon", "repeated", "final_twice", "free_start", "bounds"),
            st.booleans(),
        ),
        "rates": st.booleans(),
        "singular": st.booleans(),
        "parameters": st.integers(0, 2),
        "inequalities": st.integers(0, 2),
        "equalities": st.integers(0, 2),
        "final": st.integers(0, 2),
        "bend": st.sampled_from([0.0, 0.3]),
        "regularisation": st.sampled_from([0.0, 1e-4, 1.0]),
        "spread": st.sampled_from([0.0, 2.0, 5.0]),
    }
    return st.builds(Case, **(free | {name: st.just(value) for name, value in fixed.items()}))


def problem_of(case: Case) -> sk.Problem:
    """Return the case as a problem."""
    random = np.random.default_rng(case.seed)
    nx, nu = case.nx, case.nu
    A = random.normal(size=(nx, nx)) / np.sqrt(nx)
    B = random.normal(size=(nx, nu)) / np.sqrt(nu)
    half = random.normal(size=(nx + nu, nx + nu)) / np.sqrt(nx + nu)
    cost = (
        half @ half.T
        + 0.1 * np.eye(nx + nu)
        + (case.curvature - 1.0) * np.diag(random.uniform(0, 2, size=nx + nu))
    )
    if case.singular:
        empty = random.random(nx) < 0.5
        cost[:nx][empty] = cost[:, :nx][:, empty] = 0.0
    G = random.normal(size=(4, nx + nu))
    names = [f"p{i}" for i in range(case.parameters)]
    final = [0.1 * i if i < case.final else None for i in range(nx)]

    def dynamics(x, u, p):
        pushed = sum((0.2 * (i + 1) * p[name] for i, name in enumerate(names)), 0.0)
        return ca.mtimes(A, x) + ca.mtimes(B, u) + case.bend * ca.sin(x) * (1 + u[0]) + pushed

    def running_cost(x, u, p):
        w = ca.vertcat(x, u)
        return 0.5 * ca.dot(w, ca.mtimes(cost, w)) + sum((p[name] ** 2 for name in names), 0.0)

    def row(i):
        return lambda x, u: ca.dot(G[i], ca.vertcat(x, u)) + 0.1 * case.bend * u[0] ** 2

    path = [sk.PathConstraint(f"inside {i}", row(i), -2.0, 3.0) for i in range(case.inequalities)]
    path += [sk.PathConstraint(f"on {i}", row(2 + i), 0.0, 0.0) for i in range(case.equalities)]
    if case.repeated and case.equalities:
        path.append(sk.PathConstraint("on again", row(2), 0.0, 0.0))
    points = []
    if case.final_twice and case.final:
        points.append(sk.PointConstraint("end again", lambda x, u: x[0], 1.0, 0.0, 0.0))
    return sk.Problem(
        name="random",
        states=[sk.State(f"x{i}", scale=1.0 + 0.5 * (i % 3)) for i in range(nx)],
        controls=[sk.Control(f"u{i}", scale=2.0 if i % 2 else 1.0) for i in range(nu)],
        dynamics=dynamics,
        horizon=sk.Free(0.5, 3.0, 1.2) if case.free_horizon else 1.5,
        initial=None if case.free_start else [0.3] * nx,
        final=final,
        running_cost=running_cost,
        terminal_cost=lambda x, tf: 0.5 * ca.dot(x, x) + 0.3 * tf**2,
        state_bounds=([-5.0] * nx, [5.0] + [None] * (nx - 1)) if case.bounds else None,
        control_bounds=([-4.0] * nu, [4.0] * nu) if case.bounds else None,
        path=path,
        points=points,
        rates=[3.0] + [None] * (nu - 1) if case.rates else None,
        parameters={name: sk.Free(-1.0, 1.0, 0.2) for name in names},
    )


def program_of(case: Case):
    """Return the finite program of a case."""
    door = {"euler": sk.Euler, "trapezoid": sk.Trapezoid, "hermite-simpson": sk.HermiteSimpson}
    name, controls = case.scheme
    random = np.random.default_rng(case.seed + 1)
    lengths = random.uniform(0.2, 3.0, size=case.N)
    mesh = np.r_[0.0, np.cumsum(lengths) / lengths.sum()]
    mesh[-1] = 1.0
    place = {"mesh": mesh} if case.uneven else {"segments": case.N}
    choice = {} if name == "euler" else {"controls": controls}
    problem = problem_of(case)
    return door[name](**place, **choice).program(problem, sk.initial_guess(problem)[0])
