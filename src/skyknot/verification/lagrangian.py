"""The Lagrangian's point terms, differentiated anew from the problem's own callables.

Legend: y = (x, u, q) with q the globals (T when the horizon is free, then the free parameters);
ℓ running cost, f dynamics, g path and point constraints, M end cost; t = T τ. With w the weight of
the running cost, ν the multipliers that act on f and μ those on g, one point contributes
    φ = T (w ℓ + νᵀ f) + μᵀ g.
Derivatives are CasADi's, of the problem's expressions; no code of the transcription takes part.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.problem.problem import Parameters, Problem

Array = NDArray[np.float64]


class Lagrangian:
    """Point terms of a problem at given parameter values.

    Parameters
    ----------
    problem : what was asked
    parameters : values by name; the problem's own where left out
    duration : T, s
    """

    def __init__(self, problem: Problem, parameters: Mapping[str, float], duration: float) -> None:
        self.problem = problem
        values = problem.parameter_values()
        values |= {name: parameters[name] for name in values if name in parameters}
        self.names = (("horizon",) if problem.free_horizon else ()) + tuple(problem.free_parameters)
        found = values | {"horizon": duration}
        self.q = np.array([found[name] for name in self.names])
        self._x, self._u = ca.SX.sym("x", problem.nx), ca.SX.sym("u", problem.nu)
        self._q, self._tau = ca.SX.sym("q", len(self.names)), ca.SX.sym("tau")
        places = {name: self._q[i] for i, name in enumerate(self.names)}
        self._T = places.get("horizon", ca.SX(duration))
        self._p = Parameters(
            {name: places.get(name, ca.SX(value)) for name, value in values.items()}
        )
        self._y = ca.vertcat(self._x, self._u, self._q)
        self._compile()

    def _compile(self) -> None:
        p, x, u, t = self.problem, self._x, self._u, self._T * self._tau
        cost = ca.SX(p.running_cost_of(x, u, self._p, t))
        rates = ca.densify(ca.SX(p.rates_of(x, u, self._p, t)))
        rows = ca.densify(ca.SX(p.constraints_of(x, u, self._p, t)))
        w, nu, mu = ca.SX.sym("w"), ca.SX.sym("nu", p.nx), ca.SX.sym("mu", rows.numel())
        motion, room = self._T * (w * cost + ca.dot(nu, rates)), ca.dot(mu, rows)
        inputs = [x, u, self._q, self._tau, w, nu, mu]
        parts = [ca.gradient(motion, self._y), ca.gradient(room, self._y)]
        first = [cost, rates, rows, *map(ca.densify, parts)]
        second = [
            ca.densify(ca.hessian(motion + room, self._y)[0]),
            ca.densify(ca.jacobian(self._T * rates, self._y)),
            ca.densify(ca.jacobian(rows, self._y)),
        ]
        self._first = ca.Function("first", inputs, ca.cse(first))
        self._second_inputs, self._second_outputs = inputs, second
        self._second: ca.Function | None = None
        self._compile_controls(cost, rates, inputs[:6])
        timed = [ca.depends_on(ca.SX(e), self._tau) for e in (cost, rates, rows[: len(p.path)])]
        self.autonomous = not any(timed)
        z = ca.vertcat(x, self._q)
        M = ca.SX(p.terminal_cost_of(x, self._p, self._T))
        hessian, gradient = ca.hessian(M, z)
        self._end = ca.Function("end", [x, self._q], [M, ca.densify(gradient), ca.densify(hessian)])

    def _compile_controls(self, cost: ca.SX, rates: ca.SX, inputs: list[ca.SX]) -> None:
        H = inputs[4] * cost + ca.dot(inputs[5], rates)
        R, b = ca.hessian(H, self._u)
        self.quadratic_in_controls = not ca.depends_on(R, self._u)
        self._controls = ca.Function("controls", inputs, ca.cse([ca.densify(b), ca.densify(R)]))

    def control_form(
        self, X: Array, U: Array, tau: Array, w: Array, p: Array
    ) -> tuple[Array, Array]:
        """Return ∂H/∂u (P, nu) and ∂²H/∂u² (P, nu, nu) of H = wℓ + pᵀf at P points."""
        P, n = U.shape
        b, R = self._at(self._controls, X, U, tau, w, p)
        return b.T, R.reshape(n, P, n).transpose(1, 0, 2)

    def first(
        self, X: Array, U: Array, tau: Array, w: Array, nu: Array, mu: Array
    ) -> tuple[Array, Array, Array, Array, Array]:
        """Return ℓ (P,), f (P, nx), g (P, ng), ∂(T(wℓ+νᵀf))/∂y and ∂(μᵀg)/∂y (P, ny)."""
        found = self._at(self._first, X, U, tau, w, nu, mu)
        cost, rates, rows, motion, room = (each.T for each in found)
        return cost[:, 0], rates, rows, motion, room

    def second(
        self, X: Array, U: Array, tau: Array, w: Array, nu: Array, mu: Array
    ) -> tuple[Array, Array, Array]:
        """Return ∂²φ/∂y² (P, ny, ny), ∂(T f)/∂y (P, nx, ny) and ∂g/∂y (P, ng, ny)."""
        if self._second is None:
            outputs = ca.cse(self._second_outputs)
            self._second = ca.Function("second", self._second_inputs, outputs)
        P, ny = len(X), self._y.numel()
        found = self._at(self._second, X, U, tau, w, nu, mu)
        hessian, rates, rows = (
            each.reshape(each.shape[0], P, ny).transpose(1, 0, 2) for each in found
        )
        return hessian, rates, rows

    def end(self, x: Array) -> tuple[float, Array, Array]:
        """Return M, its gradient (nx + nq,) and Hessian over (x, q) at the last state."""
        M, gradient, hessian = self._end(x, self.q)
        return float(M), np.array(gradient.full()[:, 0]), np.array(hessian.full())

    def _at(
        self, function: ca.Function, X: Array, U: Array, tau: Array, *more: Array
    ) -> list[Array]:
        P = len(X)
        q = np.repeat(self.q[:, None], P, axis=1)
        columns = [each.T if each.ndim == 2 else each[None, :] for each in more]
        found = function.map(P)(X.T, U.T, q, tau[None, :], *columns)
        return [np.asarray(each.full(), dtype=float) for each in found]
