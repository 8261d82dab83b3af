"""Sections 5.4 and 6: how the errors fall from iteration to iteration.

Legend: e_i the larger of constraint violation and gradient of the Lagrangian at iteration i.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.paper.base import Claim, Finding, Measure, Scale, judged, slope
from skyknot.paper.transfers import SEGMENTS, report_flight, smooth_transfer, solved, transfer
from skyknot.problem.problem import Problem
from skyknot.solution import HISTORY, Solution

TIGHT = 1e-6
"""Optimality tolerance of the projected gradient where its rate is read."""

Array = NDArray[np.float64]

ROUNDING = 1e-10
"""Errors below this are those of rounding and of linear solves: no rate is read from them."""


def linear_then_superlinear(scale: Scale) -> Finding:
    """Judge "linear during the first iterations, superlinear near the optimum"."""
    solution = solved(transfer(), scale.pick(50, SEGMENTS), tolerance=1e-10)
    error = errors_of(solution)
    half = len(error) // 2
    early = float((error[half] / error[0]) ** (1 / half))
    late = float((error[-1] / error[-4]) ** (1 / 3))
    last = float(error[-1] / error[-2])
    descent = descended(transfer(), scale.pick(50, SEGMENTS))
    third = len(descent) // 3
    ends = [float((descent[i + third] / descent[i]) ** (1 / third)) for i in (third, 2 * third - 1)]
    claim = Claim(
        claim="Rate of convergence",
        section="5.4, figure 11",
        said="Approximately linear at first, superlinear as the solution approaches the optimum.",
        measured=(
            Measure("interior point: mean factor per iteration, first half", early),
            Measure("interior point: mean factor, last three iterations", late),
            Measure("interior point: last factor", last),
            Measure("interior point: iterations", solution.iterations),
            Measure("projected gradient: mean factor, middle third", ends[0]),
            Measure("projected gradient: mean factor, last third", ends[1]),
            Measure("projected gradient: iterations", len(descent) - 1),
        ),
        how=(
            "Errors of every iteration of the report's transfer (the larger of violation and"
            " gradient of the Lagrangian): the interior point to a tolerance of 1e-10; the"
            f" projected gradient, structured, to {TIGHT:g}, where the least error so far counts."
        ),
        verdict=judged(ends[1] < 0.2 * ends[0], last < late < 0.5 * early),
        why=(
            "True of the interior point: as long as the barrier falls by constant factors the"
            " errors follow it; near the end the steps are Newton's on nearly the true optimality"
            " conditions. The projected gradient converges linearly all the way, as a gradient"
            " method does in a fixed metric."
        ),
    )
    return Finding(claim, {"errors": error.tolist(), "descent": descent.tolist()})


def quadratic_near_solution(scale: Scale) -> Finding:
    """Judge (28), e_{i+1} ≤ κ e_i², near the solution."""
    N = scale.pick(25, SEGMENTS)
    solution = solved(smooth_transfer(), N, tolerance=1e-11)
    error = errors_of(solution)
    kept = error[error > ROUNDING]
    tail = kept[-4:]
    exponent = slope(list(tail[:-1]), tail[1:])
    bounded = report_flight(scale.pick(50, SEGMENTS))
    rough = errors_of(bounded)[-4:]
    other = slope(list(rough[:-1]), rough[1:])
    descent = descended(smooth_transfer(), N)
    linear = slope(list(descent[:-1]), descent[1:])
    claim = Claim(
        claim="Quadratic convergence near the solution",
        section="6, equation (28)",
        said="e_{i+1} ≤ κ e_i² for iterations close to the solution.",
        measured=(
            Measure("interior point: exponent, without active bounds", exponent),
            Measure("interior point: κ over the last pair", float(tail[-1] / tail[-2] ** 2)),
            Measure("interior point: exponent with active bounds (barrier)", other),
            Measure("projected gradient: exponent, without active bounds", linear),
        ),
        how=(
            f"Slope of log e_{{i+1}} over log e_i in the last iterations above {ROUNDING:g}:"
            f" smooth transfer, N = {N}, and the report's transfer with its bounds. For the"
            " projected gradient, the least error so far."
        ),
        verdict=judged(linear > 1.7, exponent > 1.7),
        why=(
            "Without bounds the interior point's steps are Newton's on the optimality conditions,"
            " hence quadratic; with active bounds the barrier must go to zero as well, and its"
            " schedule sets the rate. The projected gradient has an exponent of one: it converges"
            " linearly."
        ),
    )
    return Finding(claim, {"errors": kept.tolist()})


def descended(problem: Problem, segments: int) -> Array:
    """Return the least error so far of the projected gradient, iteration by iteration."""
    solver = {"name": "projected-gradient", "optimality_tolerance": TIGHT}
    return np.minimum.accumulate(errors_of(solved(problem, segments, solver=solver)))


def errors_of(solution: Solution) -> Array:
    """Return the larger of violation and gradient of the Lagrangian, iteration by iteration."""
    return np.maximum(
        column(solution, "primal_infeasibility"), column(solution, "dual_infeasibility")
    )


def column(solution: Solution, name: str) -> Array:
    """Return one column of a solution's history."""
    return np.maximum(solution.history[:, HISTORY.index(name)], 1e-300)
