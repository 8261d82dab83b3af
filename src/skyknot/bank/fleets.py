"""Several copies of a problem at once: each must come out as if it were alone.

Legend: M number of copies.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from skyknot.bank.base import Array, Recipe, Reference
from skyknot.bank.smooth_optima import hager
from skyknot.problem.problem import Problem
from skyknot.problem.variables import Control, State
from skyknot.transcription import HermiteSimpson


def fleet(M: int = 3) -> Reference:
    """M copies of the first problem of Hager, in one: M times its optimum, and nothing else."""
    alone = hager()
    return Reference(
        copies(alone.problem, M),
        M * alone.optimum,
        f"closed form: {M} times that of hager; the copies share nothing",
        recipe=Recipe(HermiteSimpson(40)),
    )


def copies(problem: Problem, M: int) -> Problem:
    """Return M copies of a problem of fixed horizon, with costs that add up.

    Parameters
    ----------
    problem : with a running cost; without bounds, parameters or constraints
    M : number of copies; the states of copy i are those numbered i nx to (i + 1) nx
    """
    nx, nu = problem.nx, problem.nu
    cost = problem.running_cost
    assert cost is not None

    def parts(x: Any, u: Any) -> list[tuple[Any, Any]]:
        return [(x[i * nx : (i + 1) * nx], u[i * nu : (i + 1) * nu]) for i in range(M)]

    return Problem(
        f"{M} × {problem.name}",
        [State(f"{state.name}{i}", state.unit) for i in range(M) for state in problem.states],
        [Control(f"{each.name}{i}", each.unit) for i in range(M) for each in problem.controls],
        lambda x, u: ca.vertcat(*(row for pair in parts(x, u) for row in problem.dynamics(*pair))),
        horizon=problem.duration_guess,
        initial=_repeated(problem.initial_lower, M),
        running_cost=lambda x, u: sum(cost(*pair) for pair in parts(x, u)),
    )


def _repeated(values: Array, M: int) -> list[float]:
    return [float(value) for _ in range(M) for value in values]
