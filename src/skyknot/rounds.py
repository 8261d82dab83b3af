"""Solve, measure, refine the mesh, solve again: until the answer is as accurate as asked for."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.program import Program
from skyknot.problem.problem import Problem
from skyknot.solution import MeshRound, Solution
from skyknot.status import Status
from skyknot.transcription import Transcription
from skyknot.transcription.pointwise import PointFunctions
from skyknot.transcription.refinement import (
    CONSTRAINT_SHARE,
    SWITCH_SHARE,
    Refinement,
    refined,
    segments_needed,
    split,
)
from skyknot.transcription.segment_error import SegmentError, segment_error
from skyknot.transcription.switches import switches

Array = NDArray[np.float64]

RELAID, FAR = 2, 30.0
"""Rounds that lay the mesh anew, and times the accuracy beyond which later ones do so too; else
segments are only split."""

BEYOND = 4.0
"""Times the limit of segments: where so many are needed, by two meshes, no more is tried."""

FINER = 2.5
"""Times the segments of a first mesh that does not solve, for another try: it may be too coarse."""

NEAR = 10.0
"""Times the accuracy: a flight estimated farther off is not worth flying in earnest."""


TOO_COARSE = (Status.INFEASIBLE, Status.STALLED, Status.ITERATION_LIMIT)
"""How solves end on meshes that have too few places to act at."""


@dataclass(frozen=True)
class Answer:
    """A mesh, its program, and the solution on it."""

    scheme: Transcription
    program: Program
    solution: Solution


Solve = Callable[[Transcription, Answer, bool], Answer]
"""Solves on a new mesh from an answer on another; with its multipliers, or from its trajectory."""


@dataclass(frozen=True)
class _Measured:
    answer: Answer
    error: SegmentError
    worst: float


def in_rounds(
    problem: Problem,
    first: Callable[[Transcription], Answer],
    scheme: Transcription,
    again: Solve,
    functions: PointFunctions,
    wanted: Refinement,
) -> Solution:
    """Return the solution on the first mesh that is accurate enough, else the most accurate one.

    Parameters
    ----------
    first : solves on a mesh without an earlier answer
    scheme : on the mesh to begin with; one that does not solve is tried once more, finer
    again : solves on another mesh from an earlier answer
    functions : the problem's functions, for the error estimate
    wanted : accuracy and limits

    Returns
    -------
    Solution that carries all rounds; its status is ``INACCURATE``, with the reason as ``detail``,
    when no mesh was good enough
    """
    begun = time.perf_counter()
    log = _Log(begun)
    answer, best = first(scheme), None
    if answer.solution.status in TOO_COARSE:
        log.failed(answer.solution)
        answer = first(replace(scheme, nodes=_finer(scheme.nodes)))
    while answer.solution.success:
        found = _measured(problem, answer, functions, wanted)
        best = found if best is None or found.worst <= best.worst else best
        met = found.worst <= wanted.accuracy
        reason = "" if met else _limit(log, found, wanted, begun)
        if met or reason:
            log.measured(found)
            return log.ended(best, wanted, reason)
        anew = len(log.rounds) < RELAID or found.worst > FAR * wanted.accuracy
        lay = refined if anew else split
        mesh = _better_mesh(problem, found, functions, wanted, lay)
        log.measured(found)
        answer = again(mesh, found.answer, True)
        if _failed(answer):
            log.failed(answer.solution)
            answer = again(mesh, best.answer, False)
        if _failed(answer):
            log.failed(answer.solution)
            answer = again(_better_mesh(problem, best, functions, wanted, split), best.answer, True)
    log.failed(answer.solution)
    return log.ended_early(answer.solution, best, wanted)


def _finer(nodes: Array) -> Array:
    """Return ``FINER`` times the segments, denser where the nodes are denser."""
    count = int(np.ceil(FINER * (len(nodes) - 1)))
    places = np.linspace(0.0, 1.0, count + 1)
    return np.interp(places, np.linspace(0.0, 1.0, len(nodes)), nodes)


def _failed(answer: Answer) -> bool:
    """Whether to try again: neither solved nor stopped by the user."""
    return not answer.solution.success and answer.solution.status is not Status.INTERRUPTED


def _measured(
    problem: Problem, answer: Answer, functions: PointFunctions, wanted: Refinement
) -> _Measured:
    solution = answer.solution
    error = segment_error(
        problem,
        solution.trajectory,
        solution.record.parameters,
        functions,
        NEAR * wanted.accuracy,
    )
    return _Measured(answer, error, wanted.worst(error))


def _better_mesh(
    problem: Problem,
    found: _Measured,
    functions: PointFunctions,
    wanted: Refinement,
    lay: Callable[..., Array],
) -> Transcription:
    """Return a mesh for the next round, from all nodes anew or from the old ones split."""
    solution, scheme = found.answer.solution, found.answer.scheme
    trajectory, parameters = solution.trajectory, solution.record.parameters
    places = switches(problem, trajectory, solution.costates, parameters, functions)
    nodes = np.concatenate([[0.0], np.cumsum(found.answer.program.fractions)])
    nodes[-1] = 1.0
    kept = [entry.at for entry in problem.points]
    return replace(scheme, nodes=lay(nodes, found.error, wanted, scheme.table, places, kept))


def _limit(log: _Log, found: _Measured, wanted: Refinement, begun: float) -> str:
    """Return why no further mesh may be tried; empty when one may."""
    segments = found.answer.program.segments
    if len(log.rounds) + 1 >= wanted.rounds:
        return f"the limit of {wanted.rounds} meshes"
    if segments >= wanted.segments:
        return f"the limit of {wanted.segments} segments"
    if time.perf_counter() - begun >= wanted.seconds:
        return f"the limit of {wanted.seconds:g} s"
    needed = segments_needed(found.error, wanted, found.answer.scheme.table)
    if log.rounds and needed > BEYOND * wanted.segments:
        return (
            f"the limit of {wanted.segments} segments, since this scheme needs about {needed:.1g}"
        )
    return ""


class _Log:
    """What happened in all rounds, to be told with the last."""

    def __init__(self, begun: float) -> None:
        self.rounds: list[MeshRound] = []
        self.solutions: list[Solution] = []
        self._last = begun

    def measured(self, found: _Measured) -> None:
        """Write a round down."""
        error = found.error
        measures = (error.dynamics, error.flight, error.constraints, error.switching)
        self._add(found.answer.solution, (*measures, found.worst))

    def failed(self, solution: Solution) -> None:
        """Write a round down that has nothing to measure."""
        self._add(solution, (np.inf,) * 5)

    def _add(self, solution: Solution, measures: tuple[float, ...]) -> None:
        now = time.perf_counter()
        effort = (solution.record.segments, solution.iterations, now - self._last)
        self.rounds.append(MeshRound(*effort, solution.status.value, *measures))
        self.solutions.append(solution)
        self._last = now

    def ended_early(self, failed: Solution, best: _Measured | None, wanted: Refinement) -> Solution:
        """Return the answer when a solve did not succeed: the best one so far, if there is one."""
        if best is None:
            return self._told(failed, wanted)
        if failed.status is Status.INTERRUPTED:
            interrupted = replace(best.answer.solution, status=Status.INTERRUPTED)
            return self._told(interrupted, wanted)
        reason = f"{failed.record.segments} segments, where the solve ended as '{failed.status}'"
        return self.ended(best, wanted, reason)

    def ended(self, best: _Measured, wanted: Refinement, reason: str) -> Solution:
        """Return the best answer; with a reason, it is not accurate enough."""
        solution = best.answer.solution
        if reason:
            detail = (
                f"Refinement ended at {reason}: the error is {best.worst:.2g} of the states' sizes"
                f" on {solution.record.segments} segments, {wanted.accuracy:g} was asked for;"
                f" {_culprit(best)}."
            )
            record = replace(solution.record, detail=detail)
            solution = replace(solution, status=Status.INACCURATE, record=record)
        return self._told(solution, wanted)

    def _told(self, solution: Solution, wanted: Refinement) -> Solution:
        """Return a solution with the effort of all rounds."""
        sums: dict[str, dict[str, float]] = {"timings": {}, "work": {}}
        for each in self.solutions:
            for name, total in sums.items():
                for key, value in getattr(each.record, name).items():
                    total[key] = total.get(key, 0) + value
        spent = sum(entry.seconds for entry in self.rounds)
        sums["timings"]["refinement"] = spent - sum(sums["timings"].values())
        history = np.concatenate([each.history for each in self.solutions])
        if len(history):
            history[:, 0] = np.arange(len(history))
        record = replace(
            solution.record,
            accuracy=wanted.accuracy,
            rounds=tuple(self.rounds),
            timings=sums["timings"],
            work={name: int(value) for name, value in sums["work"].items()},
        )
        return replace(
            solution,
            iterations=sum(each.iterations for each in self.solutions),
            solve_time=sum(each.solve_time for each in self.solutions),
            history=history,
            record=record,
        )


def _culprit(found: _Measured) -> str:
    """Return which measure is worst, of which state, and when."""
    error, times = found.error, found.answer.solution.times
    names = found.answer.program.state_names
    if max(error.dynamics, error.flight) < found.worst:
        passed = error.constraints / CONSTRAINT_SHARE >= error.switching / SWITCH_SHARE
        k = int(np.argmax(error.passed if passed else error.smeared))
        what = "a limit is passed" if passed else "a control jumps"
        return f"{what} between {times[k]:.4g} s and {times[k + 1]:.4g} s"
    values = error.apart if error.flight >= error.dynamics else np.fmax(error.between, error.missed)
    values = np.where(np.isfinite(values), np.abs(values), np.inf)
    k, i = divmod(int(np.argmax(values)), values.shape[1])
    if error.flight >= error.dynamics:
        return f"flown open loop, '{names[i]}' is farthest off at {times[k]:.4g} s"
    return f"'{names[i]}' obeys the dynamics least after {times[k]:.4g} s"
