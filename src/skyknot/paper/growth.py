"""Section 5.3: time per iteration against N.

Processor times are read at the solver's own callbacks, so that building and starting do not
count; verdicts rest on ratios and slopes within one run only.

Legend: N segments, nx = 12, nu = 4, t time per iteration.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from skyknot.paper.base import Claim, Finding, Measure, Scale, judged, listed, slope
from skyknot.paper.transfers import scheme, smooth_transfer, solved, transfer, tried
from skyknot.problem.problem import Problem
from skyknot.solution import Solution

RUNS = 2
"""Runs of which the least time counts."""

STRAIGHT = 0.4
"""A fitted exponent counts as the integer it is this near to."""


def linear_in_segments(scale: Scale) -> Finding:
    """Judge (16): time per iteration linear in N."""
    meshes = scale.pick((25, 50, 100), (50, 100, 200, 400, 800, 1600))
    starts = {N: solved(transfer(), N, solver="projected-gradient") for N in meshes}
    steps, whole = gradient_times(starts, rounds=scale.pick(1, 6))
    own = [iteration_time(transfer(), N, "interior-point") for N in meshes]
    exponent = slope(meshes, steps)
    claim = Claim(
        claim="Growth of an iteration with N",
        section="5.3, equation (16)",
        said="O(N (nx + nu)²) per iteration: linear in N.",
        measured=(
            Measure("exponent of N, gradient steps", exponent),
            Measure("exponent of N, factorisations included", slope(meshes, whole)),
            Measure("exponent of N, interior point", slope(meshes, own)),
            *(
                Measure(f"gradient step, N = {N}", 1e3 * t, "ms")
                for N, t in zip(meshes, steps, strict=True)
            ),
        ),
        how=(
            "Projected gradient on the report's transfer, structured: processor time between"
            " iterations, the metric factored (solve resumed at its solution and taken to 1e-9,"
            " least of several turns), and the mean over the solve from a cold start; the interior"
            f" point's least. N from {meshes[0]} to {meshes[-1]}, slopes in logarithms."
        ),
        verdict=judged(exponent < 1 + STRAIGHT, exponent < 2 - STRAIGHT),
        why=(
            "A step on factors at hand visits every segment once, with (nx + nu)² operations."
            " Finding the first active bounds takes factorisations, O(N (nx + nu)³) each, and the"
            " finer the mesh the more of them; beyond the caches of the processor memory slows all"
            " of it."
        ),
    )
    data = {"meshes": list(meshes), "steps": steps, "whole": whole, "own": own}
    return Finding(claim, data)


def interior_point_growth(scale: Scale) -> Finding:
    """Judge "standard interior point methods: O(N³ (nx + nu)³) per iteration"."""
    meshes = scale.pick((20, 40), (50, 100, 200, 400))
    own = [iteration_time(transfer(), N, "interior-point") for N in meshes]
    ipopt = [iteration_time(transfer(), N, _ipopt(scale)) for N in meshes]
    claim = Claim(
        claim="Growth of interior point methods",
        section="5.3",
        said="Standard interior point methods need O(N³ (nx + nu)³) per iteration.",
        measured=(
            Measure("exponent of N, Ipopt with MUMPS", slope(meshes, ipopt)),
            Measure("exponent of N, own interior point", slope(meshes, own)),
            Measure(f"Ipopt, N = {meshes[-1]}", 1e3 * ipopt[-1], "ms per iteration"),
            Measure(f"own, N = {meshes[-1]}", 1e3 * own[-1], "ms per iteration"),
        ),
        how=(
            "Least processor time between iterations on the identical program,"
            f" N = {listed(meshes)}."
        ),
        verdict=judged(slope(meshes, ipopt) > 3 - STRAIGHT),
        why=(
            "N³ is the cost of a dense factorisation. Every interior point code in use factors"
            " the sparse matrix, banded in time: linear in N."
        ),
    )
    return Finding(claim, {"meshes": list(meshes), "own": own, "ipopt": ipopt})


def quadratic_programming_growth(scale: Scale) -> Finding:
    """Judge "SQP methods: O(N² (nx + nu)²) per iteration"."""
    meshes = scale.pick((20, 40), (50, 100, 200, 400))
    problem = smooth_transfer()
    own = [iteration_time(problem, N, "interior-point") for N in meshes]
    ipopt = [iteration_time(problem, N, _ipopt(scale)) for N in meshes]
    claim = Claim(
        claim="Growth of SQP methods",
        section="5.3",
        said="SQP methods scale as O(N² (nx + nu)²) per iteration.",
        measured=(
            Measure("exponent of N, sparse Newton–Lagrange steps by Ipopt", slope(meshes, ipopt)),
            Measure("exponent of N, structured steps", slope(meshes, own)),
        ),
        how=(
            "Smooth transfer without inequalities, where an SQP step is Newton's step on the"
            " optimality conditions (Nocedal & Wright, Numerical Optimization, section 18.1):"
            f" least processor time between iterations, N = {listed(meshes)}."
        ),
        verdict=judged(slope(meshes, ipopt) > 2 - STRAIGHT),
        why=(
            "The quadratic program of a step is banded in time as well; solved with sparse or"
            " structured factors it is linear in N. Only condensing, dense in the controls, is"
            " not."
        ),
    )
    return Finding(claim, {"meshes": list(meshes), "own": own, "ipopt": ipopt})


def gradient_times(starts: dict[int, Solution], rounds: int) -> tuple[list[float], list[float]]:
    """Return times per iteration by mesh, s: gradient steps alone, and the mean of a cold solve.

    Meshes take turns, so that a busy moment of the machine does not fall on one of them alone.
    """
    steps, whole = ({N: np.inf for N in starts} for _ in range(2))
    for _ in range(rounds):
        for N, start in starts.items():
            settled = ticks(transfer(), N, "projected-gradient", guess=start, tolerance=1e-9)
            steps[N] = min(steps[N], float(np.min(np.diff(settled))))
    for N in starts:
        cold = [ticks(transfer(), N, "projected-gradient") for _ in range(RUNS)]
        whole[N] = min((told[-1] - told[0]) / (len(told) - 1) for told in cold)
    return list(steps.values()), list(whole.values())


def iteration_time(problem: Problem, segments: int, solver: Any) -> float:
    """Return the processor time between iterations, s: least of all iterations of a few runs.

    Processor time and the least of it, because other work on the machine only ever adds.
    """
    return min(float(np.min(np.diff(ticks(problem, segments, solver)))) for _ in range(RUNS))


def ticks(problem: Problem, segments: int, solver: Any, **choices: Any) -> list[float]:
    """Return the processor times, s, at which a solve told its iterations."""
    told: list[float] = []

    def tick(_record: object) -> None:
        told.append(time.process_time())

    tried(problem, scheme(segments), solver=solver, callback=tick, **choices)
    return told


def _ipopt(scale: Scale) -> dict[str, Any]:
    return {"name": "ipopt", "max_iterations": scale.pick(5, 20)}
