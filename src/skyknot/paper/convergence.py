"""Sections 5.4 and 6: how the errors fall from iteration to iteration.

Legend: e_i the larger of constraint violation and gradient of the Lagrangian at iteration i.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.paper.base import Claim, Finding, Measure, Scale, judged, slope
from skyknot.paper.transfers import SEGMENTS, report_flight, smooth_transfer, solved, transfer
from skyknot.solution import HISTORY, Solution

Array = NDArray[np.float64]

ROUNDING = 1e-10
"""Errors below this are those of rounding and of linear solves: no rate is read from them."""


def linear_then_superlinear(scale: Scale) -> Finding:
    """Judge "linear during the first iterations, superlinear near the optimum"."""
    solution = solved(transfer(), scale.pick(50, SEGMENTS), tolerance=1e-10)
    primal, dual = column(solution, "primal_infeasibility"), column(solution, "dual_infeasibility")
    error = np.maximum(primal, dual)
    half = len(error) // 2
    early = float((error[half] / error[0]) ** (1 / half))
    late = float((error[-1] / error[-4]) ** (1 / 3))
    last = float(error[-1] / error[-2])
    claim = Claim(
        claim="Rate of convergence",
        section="5.4, figure 11",
        said="Approximately linear at first, superlinear as the solution approaches the optimum.",
        measured=(
            Measure("mean factor per iteration, first half", early),
            Measure("mean factor, last three iterations", late),
            Measure("last factor", last),
            Measure("iterations", solution.iterations),
        ),
        how=(
            "Errors of every iteration of the report's transfer by the interior point (the larger"
            " of violation and gradient of the Lagrangian), tolerance 1e-10."
        ),
        verdict=judged(last < late < 0.2 * early, late < 0.5 * early),
        why=(
            "As long as the barrier falls by constant factors the errors follow it; near the end"
            " the steps are Newton's on nearly the true optimality conditions. This is the"
            " interior point's doing: no gradient method is superlinear."
        ),
    )
    data = {
        "iteration": column(solution, "iteration").tolist(),
        "defect": primal.tolist(),
        "optimality": dual.tolist(),
    }
    return Finding(claim, data)


def quadratic_near_solution(scale: Scale) -> Finding:
    """Judge (28), e_{i+1} ≤ κ e_i², near the solution."""
    N = scale.pick(25, SEGMENTS)
    solution = solved(smooth_transfer(), N, tolerance=1e-11)
    error = np.maximum(
        column(solution, "primal_infeasibility"), column(solution, "dual_infeasibility")
    )
    kept = error[error > ROUNDING]
    tail = kept[-4:]
    exponent = slope(list(tail[:-1]), tail[1:])
    bounded = report_flight(scale.pick(50, SEGMENTS))
    rough = np.maximum(
        column(bounded, "primal_infeasibility"), column(bounded, "dual_infeasibility")
    )[-4:]
    other = slope(list(rough[:-1]), rough[1:])
    claim = Claim(
        claim="Quadratic convergence near the solution",
        section="6, equation (28)",
        said="e_{i+1} ≤ κ e_i² for iterations close to the solution.",
        measured=(
            Measure("exponent, without active bounds", exponent),
            Measure("κ over the last pair", float(tail[-1] / tail[-2] ** 2)),
            Measure("exponent with active bounds (barrier)", other),
        ),
        how=(
            f"Slope of log e_{{i+1}} over log e_i in the last iterations above {ROUNDING:g}:"
            f" smooth transfer, N = {N}, and the report's transfer with its bounds."
        ),
        verdict=judged(exponent > 1.7 and other > 1.7, exponent > 1.4),
        why=(
            "Without bounds the steps are Newton's on the optimality conditions, hence quadratic;"
            " with active bounds the barrier must go to zero as well, and its schedule sets the"
            " rate. A gradient method converges linearly, whatever its step."
        ),
    )
    return Finding(claim, {"errors": kept.tolist()})


def column(solution: Solution, name: str) -> Array:
    """Return one column of a solution's history."""
    return np.maximum(solution.history[:, HISTORY.index(name)], 1e-300)
