"""Problems where a state meets a limit, or a way has to go round something.

Legend: l bound on a state, T horizon, u control, t time.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from skyknot.bank.base import COMPUTED, Printed, Recipe, Reference, line
from skyknot.problem.constraints import PathConstraint
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.transcription import HermiteSimpson, Lobatto, Radau


def bryson_denham(l: float = 1 / 9) -> Reference:  # noqa: E741  (the letter of the source)
    """½∫u² from (0, 1) to (0, −1) with x ≤ l: Bryson & Ho, section 3.11."""
    touching = 2 + 6 * max(1 - 4 * l, 0) ** 2
    optimum = 4 / (9 * l) if l <= 1 / 6 else touching
    problem = Problem(
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
    wrong = "off by 5e-6: the discretisation of its authors"
    printed = (Printed("4.444439", "PSOPT, doc/SQP_ALL_EXAMPLES ('Breakwell')", wrong),)
    recipe = Recipe(HermiteSimpson(20), accuracy=1e-8)
    return Reference(problem, optimum, source, printed=printed if l == 0.1 else (), recipe=recipe)


def van_der_pol(x1_lower: float | None = None, u_bound: float | None = None) -> Reference:
    """∫(x1² + x2² + u²) of a driven Van der Pol oscillator over 10 s from (0, 1)."""
    known = {
        (None, None): (2.87314385118, 12),
        (-0.25, 1.0): (3.6151814, 8),
        (None, 1.0): (2.8733043, 8),
    }
    optimum, digits = known[x1_lower, u_bound]
    problem = Problem(
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
    free = u_bound is None
    recipe = Recipe(Lobatto(24, 9)) if free else Recipe(Lobatto(40, 4), accuracy=1e-6)
    return Reference(problem, optimum, source, start, kind=COMPUTED, digits=digits, recipe=recipe)


def round_the_circle() -> Reference:
    """Shortest way from (−2, 0) to (2, 0) round the unit disc: two tangents and an arc.

    Unit speed, so that the time is the length: 2√3 + π/3.
    """
    problem = Problem(
        "round the circle",
        ["x", "y"],
        ["heading"],
        lambda x, u: [ca.cos(u[0]), ca.sin(u[0])],
        horizon=Free(1.0, 20.0, 5.0),
        initial=[-2.0, 0.0],
        final=[2.0, 0.0],
        terminal_cost=lambda x, tf: tf,
        path=[PathConstraint("disc", lambda x, u: x[0] ** 2 + x[1] ** 2, lower=1.0)],
    )
    s = np.linspace(0.0, np.pi, 21)
    start = Trajectory(
        5.0 * s / np.pi,
        np.stack([-2 * np.cos(s), 1.3 * np.sin(s)], axis=1),
        (0.7 - 1.4 * s / np.pi)[:, None],
    )
    source = "closed form: a taut string, tangents and arc; the mirrored way counts the same"
    recipe = Recipe(Radau(20, 3), accuracy=1e-6)
    return Reference(problem, float(2 * np.sqrt(3) + np.pi / 3), source, start, recipe=recipe)
