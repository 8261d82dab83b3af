"""The problem's callables as CasADi functions of one point, scaled by the duration.

Legend: T duration, L = T ℓ, F = T f, g path and point constraints, τ fraction of the horizon,
q globals: T when it is free, then the free parameters; p the fixed parameters, inputs as well, so
that one function serves all their values.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.problem.problem import Parameters, Problem

Array = NDArray[np.float64]


def global_names(problem: Problem) -> tuple[str, ...]:
    """Return the names of the globals q."""
    return (("horizon",) if problem.free_horizon else ()) + tuple(problem.free_parameters)


def parameter_names(problem: Problem) -> tuple[str, ...]:
    """Return the names of the fixed parameters p."""
    return tuple(name for name in problem.parameters if name not in problem.free_parameters)


def parameter_values(problem: Problem) -> Array:
    """Return the values of the fixed parameters p, (np,)."""
    values = problem.parameter_values()
    return np.array([values[name] for name in parameter_names(problem)], dtype=float)


@dataclass(frozen=True)
class PointFunctions:
    """The two functions of a program; no mesh in them, so that all meshes can share them.

    Attributes
    ----------
    point : (x, u, q, τ, p) → (L, F, g)
    terminal : (x, q, p) → M
    """

    point: ca.Function
    terminal: ca.Function

    @classmethod
    def of(cls, problem: Problem) -> PointFunctions:
        """Return the functions of a problem."""
        return cls(point_function(problem), terminal_function(problem))


def point_function(problem: Problem) -> ca.Function:
    """Return (x, u, q, τ, p) → (L, F, g)."""
    x, u = ca.SX.sym("x", problem.nx), ca.SX.sym("u", problem.nu)
    q, tau, p = _global_symbols(problem), ca.SX.sym("tau"), _parameter_symbols(problem)
    T, named = _duration_and_parameters(problem, q, p)
    t = T * tau
    L = T * ca.SX(problem.running_cost_of(x, u, named, t))
    F = T * ca.SX(problem.rates_of(x, u, named, t))
    g = ca.SX(problem.constraints_of(x, u, named, t))
    return ca.Function("point", [x, u, q, tau, p], [L, ca.densify(F), ca.densify(g)])


def terminal_function(problem: Problem) -> ca.Function:
    """Return (x, q, p) → M."""
    x, q, p = ca.SX.sym("x", problem.nx), _global_symbols(problem), _parameter_symbols(problem)
    T, named = _duration_and_parameters(problem, q, p)
    return ca.Function("terminal", [x, q, p], [ca.SX(problem.terminal_cost_of(x, named, T))])


def _global_symbols(problem: Problem) -> ca.SX:
    return ca.SX.sym("q", len(global_names(problem)))


def _parameter_symbols(problem: Problem) -> ca.SX:
    return ca.SX.sym("p", len(parameter_names(problem)))


def _duration_and_parameters(problem: Problem, q: ca.SX, p: ca.SX) -> tuple[ca.SX, Parameters]:
    T = q[0] if problem.free_horizon else ca.SX(problem.duration_guess)
    places = {name: p[i] for i, name in enumerate(parameter_names(problem))}
    for i, name in enumerate(problem.free_parameters):
        places[name] = q[i + int(problem.free_horizon)]
    return T, Parameters({name: places[name] for name in problem.parameters})
