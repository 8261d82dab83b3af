"""The problem's own callables, compiled for checking: dynamics, path and point constraints.

Legend: M points, nx states, nu controls, ng constraints, m Chebyshev coefficients of the control
polynomial in a segment of length h that starts at a; s = 2 (t − a)/h − 1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.problem.problem import Parameters, Problem, call, scalar

Array = NDArray[np.float64]


class Equations:
    """Numerical evaluation of a problem at given parameter values.

    Parameters
    ----------
    problem : what was asked
    parameters : values by name; those left out take the problem's own

    Attributes
    ----------
    parameters : their values, for the problem's callables
    path_uses_controls : (ng,) whether each path constraint depends on a control
    """

    def __init__(self, problem: Problem, parameters: Mapping[str, float]) -> None:
        self.problem = problem
        values = problem.parameter_values()
        values |= {name: parameters[name] for name in values if name in parameters}
        self.parameters = Parameters({name: ca.SX(value) for name, value in values.items()})
        x, u, t = ca.SX.sym("x", problem.nx), ca.SX.sym("u", problem.nu), ca.SX.sym("t")
        path = [scalar(call(g.function, x, u, p=self.parameters, t=t)) for g in problem.path]
        points = [scalar(call(g.function, x, u, p=self.parameters, t=t)) for g in problem.points]
        self._rates = ca.Function("rates", [x, u, t], [problem.rates_of(x, u, self.parameters, t)])
        self._path = ca.Function("path", [x, u, t], [ca.SX(ca.vertcat(*path))])
        self._points = ca.Function("points", [x, u, t], [ca.SX(ca.vertcat(*points))])
        self.path_uses_controls: NDArray[np.bool_] = np.array(
            [any(ca.which_depends(ca.SX(value), u, 1)) for value in path], dtype=bool
        )

    def rates(self, X: Array, U: Array, t: Array) -> Array:
        """Return (M, nx) dx/dt at M states (M, nx), controls (M, nu) and times (M,) [s]."""
        return self._at(self._rates, X, U, t)

    def path(self, X: Array, U: Array, t: Array) -> Array:
        """Return (M, ng) values of the path constraints."""
        return self._at(self._path, X, U, t)

    def points(self, X: Array, U: Array, t: Array) -> Array:
        """Return (M, ng) values of the point constraints."""
        return self._at(self._points, X, U, t)

    def path_expression(self, index: int) -> tuple[Any, Any, Any]:
        """Return x, t and the value of one path constraint that depends on states alone."""
        p = self.problem
        x, u, t = ca.SX.sym("x", p.nx), ca.SX.zeros(p.nu), ca.SX.sym("t")
        function = p.path[index].function
        return x, t, ca.SX(scalar(call(function, x, u, p=self.parameters, t=t)))

    def rates_expression(self) -> tuple[Any, Any, Any, Any]:
        """Return x, u, t and dx/dt as expressions."""
        p = self.problem
        x, u, t = ca.SX.sym("x", p.nx), ca.SX.sym("u", p.nu), ca.SX.sym("t")
        return x, u, t, ca.densify(ca.SX(p.rates_of(x, u, self.parameters, t)))

    def state_jacobians(self, X: Array, U: Array, t: Array) -> Array:
        """Return (M, nx, nx) ∂f/∂x at M states, controls and times."""
        p, M = self.problem, len(t)
        x, u, time = ca.SX.sym("x", p.nx), ca.SX.sym("u", p.nu), ca.SX.sym("t")
        J = ca.jacobian(p.rates_of(x, u, self.parameters, time), x)
        function = ca.Function("jacobian", [x, u, time], [ca.cse(ca.densify(J))])
        found = np.asarray(function.map(M)(X.T, U.T, t[None, :]).full(), dtype=float)
        return found.reshape(p.nx, M, p.nx).transpose(1, 0, 2)

    def flight(self, terms: int) -> tuple[Callable[[float, Array], Array], Array, Array]:
        """Return f(t, x) under a polynomial control, with the buffers that set the segment.

        Returns
        -------
        right_side : f(t, x) → (nx,), valid until the next call
        coefficients : (terms, nu) of the Chebyshev polynomials in s; write to it
        segment : (2,) start a and length h; write to it
        """
        nx, nu = self.problem.nx, self.problem.nu
        x, t = ca.SX.sym("x", nx), ca.SX.sym("t")
        C, segment = ca.SX.sym("C", nu, terms), ca.SX.sym("segment", 2)
        control = clenshaw(C, 2 * (t - segment[0]) / segment[1] - 1)
        rates = self.problem.rates_of(x, control, self.parameters, t)
        function = ca.Function("flight", [x, t, C, segment], [rates])
        return _buffered(function, nx, nu, terms)

    @staticmethod
    def _at(function: Any, X: Array, U: Array, t: Array) -> Array:
        result = function.map(len(t))(X.T, U.T, t[None, :])
        return np.asarray(result.full(), dtype=float).T


def clenshaw(C: Any, s: Any) -> Any:
    """Return Σ_j C[:, j] T_j(s) by Clenshaw's recurrence."""
    last = before = ca.SX.zeros(C.shape[0])
    for j in reversed(range(1, C.shape[1])):
        last, before = C[:, j] + 2 * s * last - before, last
    return C[:, 0] + s * last - before


def _buffered(
    function: Any, nx: int, nu: int, terms: int
) -> tuple[Callable[[float, Array], Array], Array, Array]:
    """Return f(t, x) through CasADi's buffers: no conversion, a microsecond a call."""
    buffer, evaluate = function.buffer()
    state, time, result = np.zeros(nx), np.zeros(1), np.zeros(nx)
    # CasADi reads the coefficients (nu, terms) by columns: rows of an array (terms, nu).
    coefficients, segment = np.zeros((terms, nu)), np.zeros(2)
    for i, array in enumerate((state, time, coefficients, segment)):
        buffer.set_arg(i, memoryview(array.reshape(-1)))  # type: ignore[arg-type]
    buffer.set_res(0, memoryview(result))  # type: ignore[arg-type]

    def right_side(t: float, x: Array) -> Array:
        state[:] = x
        time[0] = t
        evaluate()
        return result.copy()

    right_side.keeps_alive = (function, buffer)  # type: ignore[attr-defined]
    return right_side, coefficients, segment
