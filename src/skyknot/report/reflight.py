"""The controls flown again: what the figures are drawn over.

The problem's own equations are integrated by the classical Runge–Kutta method of order 4 in steps
far shorter than a segment; of the trajectory, only the first state and the controls are used. The
certificate flies with another integrator; the tests compare the two.

Legend: M dense times, nx states; ka … kd the four rates of a step of length h.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]

BLOWN_UP = 1e6
"""A flight beyond this many of its units is over."""


def refly(problem: Any, parameters: dict[str, float], plan: Trajectory, times: Array) -> Array:
    """Return (M, nx) states of the open-loop flight at ``times``; NaN from where it blows up.

    Parameters
    ----------
    problem : whose dynamics are flown
    parameters : values of parameters by name; the problem's own where left out
    plan : its first state and its controls are flown
    times : (M,) increasing, s, from the first node on; a step is made from each to the next, so
        that controls which jump at a node need a time just before it
    """
    steps = np.diff(times)
    controls = [plan.control(t) for t in (times[:-1], times[:-1] + 0.5 * steps, times[1:])]
    fly = _step(problem, parameters).mapaccum(len(steps))
    inputs = [column.T for column in controls]
    flown = fly(plan.states[0], *inputs, times[:-1], steps).full().T
    result: Array = np.concatenate([plan.states[:1], flown])
    lost = ~np.all(np.abs(result) < BLOWN_UP, axis=1)  # true of NaN as well
    result[np.maximum.accumulate(lost)] = np.nan
    return result


def _step(problem: Any, parameters: dict[str, float]) -> Any:
    """Return (x, u at the start, in the middle, at the end, t, h) → x after one step."""
    x, t, h = ca.SX.sym("x", problem.nx), ca.SX.sym("t"), ca.SX.sym("h")
    first, middle, last = (ca.SX.sym(name, problem.nu) for name in ("first", "middle", "last"))
    rates = equations(problem, parameters)
    ka = rates(x, first, t)
    kb = rates(x + h / 2 * ka, middle, t + h / 2)
    kc = rates(x + h / 2 * kb, middle, t + h / 2)
    kd = rates(x + h * kc, last, t + h)
    following = x + h / 6 * (ka + 2 * kb + 2 * kc + kd)
    return ca.Function("step", [x, first, middle, last, t, h], [following])


def equations(problem: Any, parameters: dict[str, float]) -> Any:
    """Return the CasADi function (x, u, t) → dx/dt of a problem at its parameters."""
    x, u, t = ca.SX.sym("x", problem.nx), ca.SX.sym("u", problem.nu), ca.SX.sym("t")
    values = problem.parameter_values() | parameters
    p = {name: values[name] for name in problem.parameters}
    return ca.Function("rates", [x, u, t], [problem.rates_of(x, u, p, t)])
