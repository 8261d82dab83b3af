"""The problem's callables as CasADi functions of one point, scaled by the duration.

Legend: T duration, L = T ℓ, F = T f, g path and point constraints, τ fraction of the horizon,
q globals: T when it is free, then the free parameters.
"""

from __future__ import annotations

import casadi as ca

from skyknot.problem.problem import Parameters, Problem


def global_names(problem: Problem) -> tuple[str, ...]:
    """Return the names of the globals q."""
    return (("horizon",) if problem.free_horizon else ()) + tuple(problem.free_parameters)


def point_function(problem: Problem) -> ca.Function:
    """Return (x, u, q, τ) → (L, F, g)."""
    x, u = ca.SX.sym("x", problem.nx), ca.SX.sym("u", problem.nu)
    q, tau = ca.SX.sym("q", len(global_names(problem))), ca.SX.sym("tau")
    T, p = _duration_and_parameters(problem, q)
    t = T * tau
    L = T * ca.SX(problem.running_cost_of(x, u, p, t))
    F = T * ca.SX(problem.rates_of(x, u, p, t))
    g = ca.SX(problem.constraints_of(x, u, p, t))
    return ca.Function("point", [x, u, q, tau], [L, ca.densify(F), ca.densify(g)])


def terminal_function(problem: Problem) -> ca.Function:
    """Return (x, q) → M."""
    x, q = ca.SX.sym("x", problem.nx), ca.SX.sym("q", len(global_names(problem)))
    T, p = _duration_and_parameters(problem, q)
    return ca.Function("terminal", [x, q], [ca.SX(problem.terminal_cost_of(x, p, T))])


def _duration_and_parameters(problem: Problem, q: ca.SX) -> tuple[ca.SX, Parameters]:
    T = q[0] if problem.free_horizon else ca.SX(problem.duration_guess)
    p = Parameters(problem.parameter_values())
    for i, name in enumerate(problem.free_parameters):
        p[name] = q[i + int(problem.free_horizon)]
    return T, p
