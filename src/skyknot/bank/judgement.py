"""Solve a reference problem and say whether its optimum was reached.

Legend: T duration, t time.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from skyknot.bank.arcs import phased, switching_times
from skyknot.bank.base import OF_THE_HORIZON, Array, Reference
from skyknot.solution import Solution
from skyknot.solve import solve
from skyknot.transcription import Radau


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


@dataclass(frozen=True)
class Answer:
    """A solution, and the switching times that it shows, s."""

    solution: Solution
    switches: Array
    duration: float


def answered(reference: Reference) -> Answer:
    """Solve a reference problem by its recipe."""
    recipe = reference.recipe
    solution = solve(
        reference.problem,
        recipe.scheme,
        guess=reference.guess,
        tolerance=recipe.tolerance,
        accuracy=recipe.accuracy,
    )
    found = switching_times(reference.problem, solution.trajectory)
    first = Answer(solution, found, solution.trajectory.duration)
    if recipe.phases is None or not solution.success:
        return first
    each, points = recipe.phases
    stated = phased(reference.problem, solution.trajectory)
    scheme = Radau(each * stated.phases, points, controls="linear")
    polished = solve(stated.problem, scheme, guess=stated.guess, tolerance=recipe.tolerance)
    ends = np.cumsum(list(polished.record.parameters.values()))
    return Answer(polished, ends[:-1], float(ends[-1]))


def judged(name: str, reference: Reference) -> Judgement:
    """Return what came out for a reference problem.

    Parameters
    ----------
    name : in the catalogue
    reference : what is to be found
    """
    begun = time.process_time()
    answer = answered(reference)
    seconds = time.process_time() - begun
    switching = switching_error(reference, answer.switches, answer.duration)
    return Judgement(
        name=name,
        reference=reference,
        found=answer.solution.objective,
        switching=switching,
        segments=answer.solution.record.segments,
        seconds=seconds,
        complaint=_complaint(reference, answer.solution, switching),
    )


def switching_error(reference: Reference, found: Array, duration: float) -> float:
    """Return the largest error of the known switching times, of the horizon.

    NaN where none are known; infinite where the number of switches is another one.

    Parameters
    ----------
    found : switching times that the answer shows, s, in order
    duration : s
    """
    known = np.array(reference.switches)
    if not len(known):
        return float("nan")
    if len(found) < len(known) or (reference.complete and len(found) != len(known)):
        return float("inf")
    return float(np.abs(known - found[: len(known)]).max() / duration)


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
