"""Solve a reference problem and say whether its optimum was reached.

Legend: T duration, t time.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from skyknot.bank.base import OF_THE_HORIZON, Array, Reference
from skyknot.problem.problem import Problem
from skyknot.solution import Solution
from skyknot.solve import solve
from skyknot.trajectory import Trajectory

ON_A_BOUND = 0.02
"""Share of the room between its bounds within which a control lies on a bound."""

A_JUMP = 0.02
"""Share of the horizon within which a control goes from one bound to the other in a jump."""

INSIDE = np.array([1e-6, *np.linspace(0.1, 0.9, 9), 1 - 1e-6])
"""Where a control is looked at, as shares of a segment."""


@dataclass(frozen=True)
class Judgement:
    """What came out for a reference problem.

    Attributes
    ----------
    name : in the catalogue
    reference : what was to be found
    found : objective
    switching : largest error of a switching time, of the horizon; NaN where none are known
    segments, seconds : of the last mesh; processor time of all
    complaint : why the reference counts as missed; empty when it was reached
    """

    name: str
    reference: Reference
    found: float
    switching: float
    segments: int
    seconds: float
    complaint: str

    @property
    def reached(self) -> bool:
        """Whether optimum, printed digits and switching times are all met."""
        return not self.complaint

    @property
    def relative(self) -> float:
        """Error of the objective, relative to the optimum, with its sign; of zero, absolute."""
        return (self.found - self.reference.optimum) / (abs(self.reference.optimum) or 1.0)

    @property
    def agreeing(self) -> int:
        """Significant digits on which found and known optimum agree."""
        return int(np.floor(-np.log10(max(abs(self.relative), 1e-15))))


def solved(reference: Reference) -> Solution:
    """Solve a reference problem by its recipe."""
    recipe = reference.recipe
    return solve(
        reference.problem,
        recipe.scheme,
        guess=reference.guess,
        tolerance=recipe.tolerance,
        accuracy=recipe.accuracy,
    )


def judged(name: str, reference: Reference) -> Judgement:
    """Return what came out for a reference problem.

    Parameters
    ----------
    name : in the catalogue
    reference : what is to be found
    """
    begun = time.process_time()
    solution = solved(reference)
    seconds = time.process_time() - begun
    switching = switching_error(reference, solution.trajectory)
    return Judgement(
        name=name,
        reference=reference,
        found=solution.objective,
        switching=switching,
        segments=solution.record.segments,
        seconds=seconds,
        complaint=_complaint(reference, solution, switching),
    )


def switching_error(reference: Reference, trajectory: Trajectory) -> float:
    """Return the largest error of the known switching times, of the horizon.

    NaN where none are known; infinite where the number of switches is another one.
    """
    known = np.array(reference.switches)
    if not len(known):
        return float("nan")
    found = switching_times(reference.problem, trajectory)
    if len(found) < len(known) or (reference.complete and len(found) != len(known)):
        return float("inf")
    apart = np.abs(known - found[: len(known)])
    return float(apart.max() / trajectory.duration)


def switching_times(problem: Problem, trajectory: Trajectory) -> Array:
    """Return the times, s, at which a control jumps between its bounds, or leaves or meets one.

    Read off the controls alone. Values between the bounds for less than ``A_JUMP`` of the horizon
    belong to the jump around them, whose time is that of half the way; longer ones are an arc of
    their own.
    """
    nodes = trajectory.times
    t = (nodes[:-1, None] + np.diff(nodes)[:, None] * INSIDE).ravel()
    U = trajectory.control(t)
    found: list[float] = []
    for i in range(problem.nu):
        lower, upper = problem.control_lower[i], problem.control_upper[i]
        if np.isfinite(lower) and np.isfinite(upper):
            share = (U[:, i] - lower) / (upper - lower)
            found += _changes(t, share, A_JUMP * trajectory.duration)
    return np.sort(np.array(found))


def _changes(t: Array, share: Array, shortest: float) -> list[float]:
    """Return the times of one control, given as shares of the room between its bounds."""
    kinds = np.where(share > 1 - ON_A_BOUND, 1, np.where(share < ON_A_BOUND, -1, 0))
    cuts = np.flatnonzero(np.diff(kinds)) + 1
    runs = [
        (int(kinds[first]), first, last - 1)
        for first, last in zip([0, *cuts], [*cuts, len(t)], strict=True)
    ]
    arcs = [run for run in runs if run[0] != 0 or t[run[2]] - t[run[1]] >= shortest]
    found = []
    for (kind, _, end), (next_kind, start, _) in pairwise(arcs):
        if kind == next_kind:
            continue
        window = slice(end, start + 1)
        if kind and next_kind:
            found.append(float(np.interp(0, kind * (0.5 - share[window]), t[window])))
        else:
            found.append(float(0.5 * (t[end] + t[start])))
    return found


def _complaint(reference: Reference, solution: Solution, switching: float) -> str:
    if not solution.success:
        return f"not solved: {solution.status}"
    error = abs(solution.objective - reference.optimum)
    if not error <= reference.limit:
        return f"optimum missed by {error:.1e}, {reference.limit:.1e} is allowed"
    for number in reference.printed:
        if not number.wrong and not number.agrees(solution.objective):
            return f"printed {number.text} by {number.by}"
    if np.isinf(switching):
        return "another number of switches"
    if switching > OF_THE_HORIZON:
        return f"switches off by {switching:.1e} of the horizon"
    return ""
