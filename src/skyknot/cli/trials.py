"""Every price of a limit confirmed: the limit is moved a little, and the mission solved again."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from skyknot.problem.problem import Problem
from skyknot.report.binding import Binding, Confirmation, bindings_of
from skyknot.solution import Solution
from skyknot.solve import resolve_transcription, solve

TIGHT = 0.1
"""Share of the mission's tolerance to which a trial is solved: it measures a small difference."""


def tried(solution: Solution, settings: Mapping[str, Any]) -> list[tuple[Binding, Confirmation]]:
    """Return the limits that bind, each with what a trial found.

    A trial is solved on the mesh of the solution, from the solution.

    Parameters
    ----------
    solution : from ``solve``
    settings : arguments of ``skyknot.solve`` it was solved with, besides problem and guess
    """
    if solution.problem is None or solution.witness is None or not solution.success:
        return []
    nodes = (solution.times - solution.times[0]) / solution.trajectory.duration
    nodes[-1] = 1.0
    scheme = dataclasses.replace(resolve_transcription(settings["transcription"]), nodes=nodes)
    tolerance = TIGHT * settings.get("tolerance", solution.record.tolerance)
    choices = {"solver": settings["solver"]} if "solver" in settings else {}

    def solved(problem: Problem) -> Solution:
        return solve(problem, scheme, guess=solution, tolerance=tolerance, **choices)

    # As tight as the trials: what the mission's tolerance leaves would drown the difference.
    base = solved(solution.problem)
    base = base if base.success else solution
    pairs = []
    for binding in bindings_of(base):
        again = solved(moved(solution.problem, binding))
        saving, shorter = (
            base.objective - again.objective,
            base.trajectory.duration - again.trajectory.duration,
        )
        confirmation = Confirmation(saving, shorter, again.status.value, again.success)
        pairs.append((binding, confirmation))
    return pairs


def moved(problem: Problem, binding: Binding) -> Problem:
    """Return the problem with one limit moved outward by the trial step."""
    other = copy.copy(problem)
    side = "upper" if binding.upper else "lower"
    if binding.kind in ("state", "control"):
        names = getattr(problem, f"{binding.kind}_names")
        bounds = np.array(getattr(problem, f"{binding.kind}_{side}"))
        bounds[[names.index(name) for name in binding.names]] = binding.moved
        setattr(other, f"{binding.kind}_{side}", bounds)
    elif binding.kind == "constraint":
        change: dict[str, Any] = {side: binding.moved}
        other.path = tuple(
            dataclasses.replace(g, **change) if g.name in binding.names else g for g in problem.path
        )
        other.points = tuple(
            dataclasses.replace(g, **change) if g.name in binding.names else g
            for g in problem.points
        )
    else:
        horizon: Any = problem.horizon
        other.horizon = dataclasses.replace(horizon, **{side: binding.moved})
    return other
