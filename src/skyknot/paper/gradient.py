"""Sections 5.3 and 5.4: the projected gradient, its iterations, its step lengths, its errors.

Algorithm 1 is run in three forms: as printed (the gradient of J alone), with multipliers (17), and
structured (each step projected on the linearised defects and the bounds, in a Riccati-factored
Gauss–Newton metric).

Legend: N segments, α step length, J objective (10), errors (19) and (20) in the user's units.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from skyknot.paper.base import Claim, Finding, Measure, Scale, judged
from skyknot.paper.transfers import (
    GOAL,
    SEGMENTS,
    Goal,
    scheme,
    seeded_goals,
    solved,
    transfer,
    tried,
)
from skyknot.problem.guess import straight_line
from skyknot.solution import HISTORY, Solution

SAID_ITERATIONS = (250, 300)
SAID_SAVING, SAID_OPTIMALITY = 0.32, 1e-3
"""What the source report says in sections 5.3 and 5.4."""

DEFECT, OPTIMALITY = 1e-6, 1e-5
"""Tolerances of errors (19) and (20)."""

FORMS = ("structured", "printed", "multipliers")

SAME = 1e-4
"""Objectives apart by less, relatively, are those of one optimum."""

NEAR = 0.1
"""A share saved counts as the one said when it is this near to it."""

FIXED = (0.3, 0.5, 0.7, 1.0)
"""Fixed step lengths compared with; 1 is the whole step, in the metric of the form."""


def iterations_and_time(scale: Scale) -> Finding:
    """Judge "250–300 iterations of 65–78 ms, 16–23 s in all"."""
    N, most = scale.pick(25, SEGMENTS), scale.pick(100, SAID_ITERATIONS[1])
    runs = {form: descent(N, form=form, max_iterations=most) for form in FORMS}
    own, printed, middle = (runs[form] for form in FORMS)
    long = descent(N, form="multipliers", max_iterations=scale.pick(2, 30) * most)
    needed = own.iterations
    each = 1e3 * own.solve_time / needed
    claim = Claim(
        claim="Iterations and time of the projected gradient",
        section="5.3",
        said="Convergence in 250–300 iterations of 65–78 ms each, 16–23 s in all.",
        measured=(
            Measure("iterations, structured", needed),
            Measure("time per iteration, structured", each, "ms"),
            Measure("whole solve, structured", own.solve_time, "s"),
            Measure("J, structured", own.objective),
            Measure("iterations, as printed", printed.iterations),
            Measure("J as printed", printed.objective),
            Measure("x(0) as printed, off the one given", _start_error(printed), "m"),
            Measure("iterations, with multipliers", middle.iterations),
            Measure("defect (19) then, with multipliers", middle.max_defect, "SI"),
            Measure("iterations, with multipliers, long run", long.iterations),
            Measure("defect (19) then, long run", long.max_defect, "SI"),
            Measure("J then off the optimum, long run", 100 * _apart(long, own), "%"),
        ),
        how=(
            f"Report's transfer, N = {N}, from a straight line at hover, Barzilai–Borwein steps, at"
            f" most {most} iterations: as printed, with multipliers (17), for the long run more,"
            " and structured. A run"
            f" ends when defects (19) are below {DEFECT:g} and optimality (20) below"
            f" {OPTIMALITY:g}."
        ),
        verdict=judged(
            printed.success and printed.iterations <= SAID_ITERATIONS[1],
            own.success and needed <= SAID_ITERATIONS[1],
        ),
        why=(
            f"As printed, the algorithm ends '{printed.status.value}' at J ="
            f" {printed.objective:.2g}: it hovers at the goal from the first instant, for the"
            " gradient of J knows neither defects nor the given start. With multipliers it ends"
            f" '{middle.status.value}'. Projected on the linearised defects it takes {needed}"
            f" iterations and {own.solve_time:.2g} s on this machine."
        ),
    )
    return Finding(claim, {form: _history(run) for form, run in runs.items()})


def barzilai_borwein_saving(scale: Scale) -> Finding:
    """Judge "Barzilai–Borwein steps reduce the iterations by 32 %"."""
    N, count, most = scale.pick((20, 3, 100), (50, 20, 400))
    goals = seeded_goals(count)
    steps: list[float | None] = [None, *scale.pick(FIXED[1:3], FIXED)]
    runs = [
        [descent(N, goal, step_length=step, max_iterations=most) for step in steps]
        for goal in goals
    ]
    needed = np.array([[run.iterations for run in row] for row in runs], dtype=float)
    met = np.array([[run.success for run in row] for row in runs], dtype=float).mean(axis=0)
    saved = 1 - needed[:, :1] / needed[:, 1:]
    best = int(np.argmin(needed[:, 1:].mean(axis=0)))
    median = float(np.median(saved[:, best]))
    compared = {float(step): saved[:, i] for i, step in enumerate(steps[1:]) if step is not None}
    chosen, middle = list(compared)[best], [float(np.median(s)) for s in compared.values()]
    claim = Claim(
        claim="Barzilai–Borwein step lengths",
        section="5.3, equation (18)",
        said="They reduce the iterations by about 32 % compared to a fixed step size.",
        measured=(
            *(
                Measure.of_many(f"iterations saved against α = {step:g}", 100 * share, "%")
                for step, share in compared.items()
            ),
            Measure.of_many("iterations, Barzilai–Borwein", needed[:, 0]),
            *(
                Measure.of_many(f"iterations, α = {step:g}", needed[:, 1 + i])
                for i, step in enumerate(compared)
            ),
            Measure("transfers solved, Barzilai–Borwein", 100 * float(met[0]), "%"),
            Measure(f"transfers solved, α = {list(compared)[-1]:g}", 100 * float(met[-1]), "%"),
        ),
        how=(
            f"{count} transfers to seeded goals, N = {N}, structured form, from a straight line;"
            f" fixed α of {', '.join(f'{step:g}' for step in compared)}, judged by the best of them"
            f" in hindsight, {chosen:g}; at most {most} iterations, which a run that needs more"
            " counts as."
        ),
        verdict=judged(abs(median - SAID_SAVING) < NEAR, median > 0),
        why=(
            "The saving depends on the fixed step it is compared with: in the median"
            f" {100 * min(middle):.0f} to {100 * max(middle):.0f} % here. What is gained for"
            " certain is that nobody has to find α: too long a step does not converge."
        ),
    )
    data = {"saved": {f"{step:g}": share.tolist() for step, share in compared.items()}}
    return Finding(claim, data)


def optimality_after_iterations(scale: Scale) -> Finding:
    """Judge "optimality error 1e-3 to 1e-4 after 300 iterations"."""
    N, most = scale.pick(25, SEGMENTS), scale.pick(100, SAID_ITERATIONS[1])
    own = descent(N, max_iterations=most)
    middle = descent(N, form="multipliers", max_iterations=most)
    other = solved(transfer(), N, solver="ipopt", tolerance=1e-9)
    apart = _apart(own, other)
    error = _history(own)["optimality"][-1]
    claim = Claim(
        claim="Optimality error of the projected gradient",
        section="5.4, equation (20)",
        said="The optimality error reaches 1e-3 to 1e-4 after 300 iterations.",
        measured=(
            Measure("optimality error (20), structured", error),
            Measure("largest defect (19), structured", own.max_defect, "SI"),
            Measure("iterations, structured", own.iterations),
            Measure("objective off that of Ipopt, relative", apart),
            Measure("optimality error (20), with multipliers", _history(middle)["optimality"][-1]),
            Measure("iterations, with multipliers", middle.iterations),
        ),
        how=(
            f"Report's transfer, N = {N}, Barzilai–Borwein steps, at most {most} iterations; Ipopt"
            " on the identical program to 1e-9."
        ),
        verdict=judged(False, error <= SAID_OPTIMALITY and apart < SAME),
        why=(
            f"Reached by the structured form, after {own.iterations} iterations. The plain gradient"
            " of the augmented Lagrangian does not come near: torques act on position through four"
            " integrations, and the problem is as ill-conditioned as that."
        ),
    )
    return Finding(claim, {})


def descent(segments: int, goal: Goal = GOAL, **settings: Any) -> Solution:
    """Return what the projected gradient makes of a transfer, solved or not.

    From a straight line at hover, where all forms and step lengths begin.
    """
    problem, solver = (
        transfer(goal),
        {"name": "projected-gradient", "optimality_tolerance": OPTIMALITY, **settings},
    )
    guess = straight_line(problem)
    return tried(problem, scheme(segments), solver=solver, guess=guess, tolerance=DEFECT)


def _history(run: Solution) -> dict[str, list[float]]:
    """Return defect, optimality and objective of every iteration."""
    names = {
        "defect": "primal_infeasibility",
        "optimality": "dual_infeasibility",
        "objective": "objective",
    }
    return {name: run.history[:, HISTORY.index(own)].tolist() for name, own in names.items()}


def _apart(run: Solution, other: Solution) -> float:
    return abs(run.objective - other.objective) / other.objective


def _start_error(run: Solution) -> float:
    return float(np.abs(run.states[0]).max())
