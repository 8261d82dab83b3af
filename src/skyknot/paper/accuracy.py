"""Section 5.1 and equation (21): the order of accuracy, global and local, and the defects.

Legend: h length of a segment, N = T/h segments, x states, R(z) stability function.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from skyknot.paper.base import Claim, Finding, Measure, Scale, judged, listed, slope
from skyknot.paper.transfers import VEHICLE, report_flight, scheme, smooth_transfer, solved
from skyknot.solution import Solution
from skyknot.solve import resolve_transcription

Array = NDArray[np.float64]

NEAR = 0.35
"""A fitted order counts as the integer it is this near to."""

REPETITIONS = 60
"""Repetitions of the rows of one segment: the contraction is at least 1/2 each time."""


def global_order(scale: Scale) -> Finding:
    """Judge "global error O(h³)": states of a smooth flight of the 12-state craft."""
    meshes, finest = scale.pick(((20, 40, 80), 320), ((20, 40, 80, 160), 640))
    problem = smooth_transfer()
    reference = solved(problem, finest, tolerance=1e-11).trajectory
    errors = [
        float(np.abs(s.states - reference.state(s.times)).max())
        for s in (solved(problem, N, tolerance=1e-11) for N in meshes)
    ]
    bounded, best = scale.pick(((50, 100), 200), ((100, 200, 400), 800))
    exact = report_flight(best).trajectory
    rough = [
        float(np.abs(report_flight(N).states - exact.state(report_flight(N).times)).max())
        for N in bounded
    ]
    order = -slope(meshes, errors)
    claim = Claim(
        claim="Global order of accuracy",
        section="5.1, figure 10",
        said="Third-order accuracy: the global error is O(h³).",
        measured=(
            Measure("order of the states, smooth transfer", order),
            Measure(f"error at N = {meshes[-1]}", errors[-1], "SI"),
            Measure("order with active control bounds", -slope(bounded, rough)),
        ),
        how=(
            "Least-effort transfer of the 12-state craft without active bounds, N ="
            f" {listed(meshes)}, largest error of a state at the nodes against N = {finest}; the"
            f" report's transfer with its bounds, N = {listed(bounded)} against N = {best}."
        ),
        verdict=judged(abs(order - 3) < NEAR, order > 3),
        why=(
            "Hermite–Simpson is the 3-stage Lobatto IIIA method, of order 4; its order 3 is that"
            " of the stages and of the interpolant between nodes. Where bounds switch on and off"
            " the order drops until the mesh follows the switches."
        ),
    )
    duration = problem.duration_guess
    return Finding(claim, {"h": [duration / N for N in meshes], "errors": errors})


def local_order(scale: Scale) -> Finding:
    """Judge "local error O(h⁴)": one segment of the 12-state craft under constant torque."""
    lengths = scale.pick((0.4, 0.2, 0.1), (0.4, 0.2, 0.1, 0.05))
    f = _rates()
    start = np.array([0, 0, 0, 1, -1, 0.5, 0.3, -0.2, 0.4, 0.8, -0.6, 0.5])
    control = VEHICLE.hover + np.array([1.5, 0.004, -0.003, 0.002])

    def right_side(x: Array) -> Array:
        return np.asarray(f(x, control).full(), dtype=float).ravel()

    errors = [float(np.abs(_step(right_side, start, h)).max()) for h in lengths]
    order = slope(lengths, errors)
    claim = Claim(
        claim="Local truncation error",
        section="5.1, equations (13)–(14)",
        said="The local truncation error is O(h⁴).",
        measured=(
            Measure("order of one segment", order),
            Measure(f"error of one segment of {lengths[0]:g} s", errors[0], "SI"),
        ),
        how=(
            "Equations (11)–(12) solved over one segment of h = "
            + ", ".join(f"{h:g}" for h in lengths)
            + " s for the tumbling 12-state craft, against DOP853 at tolerance 1e-13."
        ),
        verdict=judged(abs(order - 4) < NEAR, order > 4),
        why=(
            "Simpson's rule is exact for cubics, so the error of one step is one order higher than"
            " the matching of the third-order term suggests: e^z − R(z) = z⁵/720 + O(z⁶)."
        ),
    )
    return Finding(claim, {"h": list(lengths), "errors": errors})


def defects_by_mesh(scale: Scale) -> Finding:
    """Judge (21), "e_defect ≈ C h³" over N = 50, 100, 200."""
    meshes = (50, 100, 200)
    smooth = [solved(smooth_transfer(), N, tolerance=1e-9) for N in meshes]
    defects = [report_flight(N).max_defect for N in meshes]
    gaps = [_flown_gap(solution, scale.pick(8, 24)) for solution in smooth]
    order = -slope(meshes, gaps)
    claim = Claim(
        claim="Defects under mesh refinement",
        section="6, equation (21)",
        said="With N = 50, 100, 200 the dynamics defect falls as C h³.",
        measured=(
            *(Measure(f"defect (19) at N = {N}", d) for N, d in zip(meshes, defects, strict=True)),
            Measure("order of the gap to a finer integration of one segment", order),
        ),
        how=(
            "Defect (19) of the report's transfer as solved; and, on the smooth transfer, each"
            " segment flown from its own node by fine Runge–Kutta steps under the solved control:"
            " the largest gap at its end, against h."
        ),
        verdict=judged(
            abs(order - 3) < NEAR and abs(-slope(meshes, defects) - 3) < NEAR, order > 3
        ),
        why=(
            "The defect (19) is a constraint: it is as small as the solver makes it, whatever h,"
            " and says nothing of accuracy. What falls with h is the gap to a finer integration,"
            f" here as h^{order:.1f}."
        ),
    )
    duration = smooth_transfer().duration_guess
    data = {"h": [duration / N for N in meshes], "gaps": gaps, "defects": defects}
    return Finding(claim, data)


def defect_at_report_size(scale: Scale) -> Finding:
    """Judge "defect 1e-6 for Δt = 0.1 s with 100 intervals"."""
    solution = report_flight(scale.pick(50, 100))
    h = float(np.diff(solution.times)[0])
    claim = Claim(
        claim="Defect at the report's size",
        section="5.4",
        said="The dynamics defect falls to about 1e-6 at Δt = 0.1 s with 100 intervals.",
        measured=(
            Measure("largest defect", solution.max_defect, "SI"),
            Measure("Δt", h, "s"),
            Measure("iterations", solution.iterations),
        ),
        how=f"The report's transfer at N = {len(solution.times) - 1}, tolerance 1e-6.",
        verdict=judged(solution.max_defect <= 1e-6),
        why="The defects are the constraints of the program, met to the tolerance asked for.",
    )
    return Finding(claim, {})


def _step(f: Callable[[Array], Array], start: Array, h: float) -> Array:
    """Return the error of one segment: equations (11)–(12) against a fine integration.

    The rows are contractions in the later points for short h, so that repeating them solves them.
    """
    table = resolve_transcription(scheme(1)).table
    fine = solve_ivp(lambda _t, x: f(x), (0, h), start, method="DOP853", rtol=1e-13, atol=1e-14).y[
        :, -1
    ]
    X = np.stack([start, 0.5 * (start + fine), fine])
    for _ in range(REPETITIONS):
        residual = table.C @ X + h * table.A @ np.array([f(x) for x in X])
        # each row's own point enters with coefficient −1 (table.C), so the residual is its step
        X = X + np.vstack([np.zeros(len(start)), residual])
    result: Array = X[-1] - fine
    return result


def _rates() -> ca.Function:
    x: Any = ca.SX.sym("x", 12)
    u: Any = ca.SX.sym("u", 4)
    return ca.Function("rates", [x, u], [ca.vertcat(*VEHICLE.dynamics(x, u))])


def _flown_gap(solution: Solution, steps: int) -> float:
    """Return the largest gap at the end of a segment flown alone, by RK4 in ``steps`` steps."""
    times, h = solution.times, np.diff(solution.times)
    f = _rates().map(len(h))
    X, part = solution.states[:-1], h / steps

    def rates(states: Array, shift: float) -> Array:
        # a hair inside the segment, so that its own control polynomial is read
        at = times[:-1] + np.clip(shift, 1e-12, steps - 1e-12) * part
        return np.asarray(f(states.T, solution.control(at).T).full(), dtype=float).T

    for i in range(steps):
        k1 = rates(X, i)
        k2 = rates(X + part[:, None] / 2 * k1, i + 0.5)
        k3 = rates(X + part[:, None] / 2 * k2, i + 0.5)
        k4 = rates(X + part[:, None] * k3, i + 1)
        X = X + part[:, None] / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return float(np.abs(X - solution.states[1:]).max())
