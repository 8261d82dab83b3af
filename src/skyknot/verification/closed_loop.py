"""The answer flown as vehicles are flown: its controls corrected by its own feedback gains.

Legend: x* and u* the answer, K gains, nx states, nu controls, S starts flown side by side, N
segments of length h; s = 2 (t − a)/h − 1 in the segment that starts at a.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853

from skyknot.problem.problem import Parameters, Problem
from skyknot.trajectory import Trajectory
from skyknot.verification.equations import clenshaw

Array = NDArray[np.float64]

TOLERANCE = 1e-7
"""Relative and absolute tolerance of the integrator; feedback forgives more than it adds."""

TIME_TO_GO = 0.03
"""Share of the horizon over which the gains are held at the end: those of a fixed end grow without
bound, and guidance laws keep a floor under the time to go."""

STARTS = 4
"""Perturbed starts, drawn with a fixed seed."""

PERTURBATION = 0.005
"""Every state starts off by this share of the range it passes through, up or down by chance."""

MOST_STEPS = 20_000
"""Steps after which a flight is given up."""


@dataclass(frozen=True)
class Tracked:
    """What is tracked, segment by segment.

    Attributes
    ----------
    times : (N+1,) nodes, s
    states : (N, d, nx) Chebyshev coefficients of x*
    controls : (N, m, nu) Chebyshev coefficients of u*
    gains : (N, 2, nu, nx) K at both ends of every segment, linear in between
    """

    times: Array
    states: Array
    controls: Array
    gains: Array


def reference(trajectory: Trajectory, states: Array, controls: Array, gains: Array) -> Tracked:
    """Return what is tracked, with the gains held over the last part of the horizon.

    Parameters
    ----------
    states, controls : (N, d, nx), (N, m, nu) Chebyshev coefficients
    gains : (N+1, nu, nx) at the nodes, or (N, nu, nx) of held controls
    """
    times = trajectory.times
    K = gains.copy()
    frozen = times[-1] - TIME_TO_GO * trajectory.duration
    last = max(int(np.searchsorted(times, frozen)) - 1, 0)
    K[last:] = K[last]
    held = len(K) == len(times) - 1
    ends = np.stack([K, K] if held else [K[:-1], K[1:]], axis=1)
    return Tracked(times, states, controls, ends)


def starts(states: Array) -> Array:
    """Return (1 + STARTS, nx): the first state, then perturbed ones."""
    random = np.random.default_rng(20_240_501)
    size = PERTURBATION * np.ptp(states, axis=0)
    signs = np.where(random.random((STARTS, states.shape[1])) < 0.5, -1.0, 1.0)
    return np.concatenate([states[:1], states[0] + size * signs])


def track(problem: Problem, parameters: Parameters, tracked: Tracked, begin: Array) -> Array:
    """Return (S, N+1, nx) states flown from (S, nx); NaN from where a flight was given up.

    u = u*(t) − K(t)(x − x*(t)), clipped to the control bounds; DOP853, restarted at every node.
    """
    S, nx = begin.shape
    times = tracked.times
    right_side, set_segment = _right_side(problem, parameters, tracked, S)
    flown = np.full((S, len(times), nx), np.nan)
    flown[:, 0] = begin
    y, steps = begin.ravel().copy(), 0
    for k, h in enumerate(np.diff(times)):
        set_segment(k)
        with np.errstate(all="ignore"):
            solver = DOP853(
                right_side, times[k], y, times[k + 1], first_step=h, rtol=TOLERANCE, atol=TOLERANCE
            )
            while solver.status == "running" and steps < MOST_STEPS:
                solver.step()
                steps += 1
        if solver.status != "finished" or not np.all(np.isfinite(solver.y)):
            break
        y = solver.y
        flown[:, k + 1] = y.reshape(S, nx)
    return flown


def _right_side(
    problem: Problem, parameters: Parameters, tracked: Tracked, S: int
) -> tuple[Callable[[float, Array], Array], Callable[[int], None]]:
    """Return f(t, y) of S flights side by side, and what sets the segment."""
    nx, nu = problem.nx, problem.nu
    d, m = tracked.states.shape[1], tracked.controls.shape[1]
    x, t, segment = ca.SX.sym("x", nx), ca.SX.sym("t"), ca.SX.sym("segment", 2)
    X, U = ca.SX.sym("X", nx, d), ca.SX.sym("U", nu, m)
    K0, K1 = ca.SX.sym("K0", nu, nx), ca.SX.sym("K1", nu, nx)
    share = (t - segment[0]) / segment[1]
    s = 2 * share - 1
    K = (1 - share) * K0 + share * K1
    u = clenshaw(U, s) - K @ (x - clenshaw(X, s))
    u = ca.fmin(ca.fmax(u, problem.control_lower), problem.control_upper)
    rates = problem.rates_of(x, u, parameters, t)
    one = ca.Function("tracked", [x, t, segment, X, U, K0, K1], [ca.densify(rates)])
    many: Any = one.map("tracked", "serial", S, [1, 2, 3, 4, 5, 6], [])
    buffer, evaluate = many.buffer()
    state, time, result = np.zeros(S * nx), np.zeros(1), np.zeros(S * nx)
    # CasADi reads matrices by columns: the arrays hold their transposes, row by row.
    fixed = [np.zeros(shape) for shape in ((2,), (d, nx), (m, nu), (nx, nu), (nx, nu))]
    for i, array in enumerate((state, time, *fixed)):
        buffer.set_arg(i, memoryview(array.reshape(-1)))  # type: ignore[arg-type]
    buffer.set_res(0, memoryview(result))  # type: ignore[arg-type]

    def right_side(t: float, y: Array) -> Array:
        state[:] = y
        time[0] = t
        evaluate()
        return result.copy()

    def set_segment(k: int) -> None:
        a, b = tracked.times[k : k + 2]
        first, last = tracked.gains[k]
        values = ((a, b - a), tracked.states[k], tracked.controls[k], first.T, last.T)
        for array, value in zip(fixed, values, strict=True):
            array[...] = value

    right_side.keeps_alive = (many, buffer)  # type: ignore[attr-defined]
    return right_side, set_segment
