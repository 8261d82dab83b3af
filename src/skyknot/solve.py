"""The front door: solve(problem, transcription, solver, guess) -> Solution."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.kernel.functions import Functions
from skyknot.kernel.program import Multipliers, Program
from skyknot.problem.guess import ladder
from skyknot.problem.problem import Problem
from skyknot.rounds import Answer, in_rounds
from skyknot.solution import HISTORY, Record, Solution
from skyknot.solvers import SOLVERS
from skyknot.solvers.base import Callback, Solver, SolverResult
from skyknot.solvers.interior_point import InteriorPoint
from skyknot.status import Status
from skyknot.trajectory import Trajectory
from skyknot.transcription import DOORS, Transcription
from skyknot.transcription.inheritance import inherited
from skyknot.transcription.pointwise import PointFunctions
from skyknot.transcription.recover import (
    feedback_gains,
    multipliers_from,
    optimality,
    recover,
    same_unknowns,
)
from skyknot.transcription.refinement import Refinement
from skyknot.transcription.testimony import testimony
from skyknot.version import __version__

Array = NDArray[np.float64]

DEFAULT_SOLVER = "interior-point"


def solve(
    problem: Problem,
    transcription: Transcription | Mapping[str, Any] | str = "hermite-simpson",
    solver: Solver | Mapping[str, Any] | str = DEFAULT_SOLVER,
    guess: Trajectory | Solution | None = None,
    tolerance: float = 1e-6,
    callback: Callback | None = None,
    accuracy: float | Refinement | None = None,
) -> Solution:
    """Solve ``problem``; a failure is a Solution with ``success=False``, never an exception.

    Parameters
    ----------
    problem : what is asked
    transcription : how it becomes finite: an object such as ``HermiteSimpson(segments=100)``, a
        scheme's name, or a mapping such as ``{"scheme": "trapezoid", "segments": 50}``
    solver : a name, an object with settings such as ``Ipopt(max_iterations=50)``, or a mapping
        such as ``{"name": "ipopt", "max_iterations": 50}``
    guess : a Trajectory, a Solution (its multipliers are used too when the mesh is the same), or
        None for the guess ladder, whose next rung is tried when a start fails
    tolerance : on the optimality conditions, in the user's units
    callback : called with an IterationRecord each iteration; returning True stops the solve
    accuracy : largest error between the nodes and in open-loop flight, as a share of the size of
        each state (its scale where given, else 1 + its largest magnitude): the mesh is refined
        until it is reached, from the mesh of ``transcription``, with a tolerance of at most a
        hundredth of it; a Refinement sets limits as well. None solves on that one mesh

    Raises
    ------
    UserError
        Before iterating, with the name of the offending argument.
    """
    scheme = resolve_transcription(transcription)
    chosen = resolve_solver(solver)
    check_arguments(problem, guess, tolerance)
    if accuracy is None:
        return answered(Task(problem, scheme, chosen, tolerance, callback), guess)
    wanted = accuracy if isinstance(accuracy, Refinement) else Refinement(accuracy)
    functions = PointFunctions.of(problem)
    task = Task(problem, scheme, chosen, wanted.tolerance(tolerance), callback, functions)
    return in_rounds(
        problem,
        lambda mesh: _first(replace(task, scheme=mesh), guess),
        scheme,
        lambda mesh, last, warm: _on_mesh(replace(task, scheme=mesh), last, warm=warm),
        functions,
        wanted,
    )


@dataclass(frozen=True)
class Task:
    """What is asked and how it is to be answered, without where to start."""

    problem: Problem
    scheme: Transcription
    solver: Solver
    tolerance: float
    callback: Callback | None = None
    functions: PointFunctions | None = None

    def program(self, guess: Trajectory) -> Program:
        """Return the finite program, started from a guess."""
        if self.functions is None:
            return self.scheme.program(self.problem, guess)
        return self.scheme.program_of(self.functions, self.problem, guess)


Rungs = Iterable[tuple[Trajectory, str]]


def answered(
    task: Task, guess: Trajectory | Solution | None, rungs: Rungs | None = None
) -> Solution:
    """Solve a task from a guess, or from the rungs of the guess ladder until one serves.

    Parameters
    ----------
    rungs : the ladder of the task's problem, where it is at hand
    """
    if guess is not None:
        return _attempt(task, guess, "solution" if isinstance(guess, Solution) else "user")
    failed: list[Solution] = []
    for start, rung in ladder(task.problem) if rungs is None else rungs:
        solution = _attempt(task, start, rung)
        if solution.status not in _WORTH_ANOTHER_START:
            return solution
        failed.append(solution)
    return _least_violated(failed)


_WORTH_ANOTHER_START = (
    Status.INFEASIBLE,
    Status.STALLED,
    Status.ITERATION_LIMIT,
    Status.EVALUATION_ERROR,
)


def _least_violated(failed: list[Solution]) -> Solution:
    """Return the failed solution nearest to feasible; it says how many starts were tried."""
    best = min(failed, key=lambda solution: np.nan_to_num(solution.max_defect, nan=np.inf))
    if len(failed) == 1:
        return best
    tried = f"{len(failed)} starts of the guess ladder were tried."
    return replace(best, record=replace(best.record, detail=f"{best.record.detail} {tried}"))


def _attempt(task: Task, guess: Trajectory | Solution, rung: str) -> Solution:
    """Solve from one guess."""
    watch = _Stopwatch()
    program = task.program(guess.trajectory if isinstance(guess, Solution) else guess)
    multipliers = None
    if isinstance(guess, Solution) and _is_of(program, guess):
        multipliers = multipliers_from(program, guess.multipliers)
        program = program.starting_at(np.clip(guess.decision, program.lower, program.upper))
    watch.lap("transcription")
    return _solved(task, program, multipliers, rung, watch)


def _first(task: Task, guess: Trajectory | Solution | None) -> Answer:
    """Return the answer on the mesh that refinement begins with."""
    solution = answered(task, guess)
    return Answer(task.scheme, task.program(solution.trajectory), solution)


def _on_mesh(task: Task, last: Answer, *, warm: bool) -> Answer:
    """Return the answer on a new mesh, from that on another; ``warm`` with its multipliers."""
    watch = _Stopwatch()
    program = task.program(last.solution.trajectory)
    multipliers = None
    if warm:
        known = Multipliers(**last.solution.multipliers)
        multipliers = inherited(last.program, known, program, task.scheme.table.points)
        if isinstance(task.solver, InteriorPoint):
            task = replace(task, solver=task.solver.for_inherited())
    watch.lap("transcription")
    rung = last.solution.record.guess
    return Answer(task.scheme, program, _solved(task, program, multipliers, rung, watch))


def _solved(
    task: Task, program: Program, multipliers: Multipliers | None, rung: str, watch: _Stopwatch
) -> Solution:
    """Solve a program and tell everything about the answer."""
    problem, scheme, chosen = task.problem, task.scheme, task.solver
    result = chosen.solve(program, task.tolerance, multipliers, task.callback)
    watch.lap("solver")
    recovered = recover(program, scheme.table.points, result.z)
    watch.lap("recovery")
    return Solution.deferred(
        _told_later(program, scheme, result),
        status=result.status,
        objective=recovered.objective,
        iterations=result.iterations,
        solve_time=watch.laps["solver"],
        history=_history(result),
        trajectory=recovered.trajectory,
        multipliers={
            name: getattr(result.multipliers, name)
            for name in ("defects", "path", "rates", "bounds")
        },
        decision=result.z,
        record=Record.deferred(
            _hashed_later(program),
            problem=problem.name,
            transcription=f"{scheme.table.name}, {scheme.controls} control",
            solver=chosen.name,
            segments=program.segments,
            tolerance=task.tolerance,
            frame=problem.frame,
            state_units=tuple(state.unit for state in problem.states),
            control_units=tuple(control.unit for control in problem.controls),
            parameters=problem.parameter_values() | recovered.globals,
            guess=rung,
            versions=_versions().copy(),
            detail=result.detail,
            timings=watch.laps,
            work=result.work,
            accuracy=None,
            rounds=(),
        ),
        problem=problem,
        gains=feedback_gains(program, result.gains),
    )


def _told_later(
    program: Program, scheme: Transcription, result: SolverResult
) -> Callable[[], dict[str, Any]]:
    """Return what tells the fields of a solution that few read; it holds no solver.

    It has numbers of its own, which whoever writes into the solution's arrays does not change.
    """
    z, points, given = result.z.copy(), scheme.table.points, result.multipliers
    copies = (given.defects, given.path, given.rates, given.bounds)
    multipliers = Multipliers(*(array.copy() for array in copies))

    def rest() -> dict[str, Any]:
        told = optimality(program, z, multipliers)
        return {
            "costates": told.costates,
            "kkt_residual": told.kkt_residual,
            "max_defect": told.max_defect,
            "witness": testimony(program, points, multipliers),
        }

    return rest


def _hashed_later(program: Program) -> Callable[[], dict[str, Any]]:
    """Return what tells the hash of a program, whose functions it reads at once.

    CasADi writes them out: not later, when another thread may use them.
    """
    functions = program.functions
    return lambda: {"inputs_hash": _inputs_hash(program, functions)}


def resolve_transcription(choice: Transcription | Mapping[str, Any] | str) -> Transcription:
    """Return the transcription that a name, a mapping or an object stands for."""
    if isinstance(choice, Transcription):
        return choice
    if not isinstance(choice, str | Mapping):
        raise _wrong_type("transcription", choice, "HermiteSimpson(segments=100)")
    settings = {"scheme": choice} if isinstance(choice, str) else dict(choice)
    name = settings.pop("scheme", "hermite-simpson")
    if name not in DOORS:
        raise _unknown("scheme", name, DOORS)
    try:
        return DOORS[name](**settings)
    except TypeError as error:
        raise UserError(
            "The transcription has a setting that its scheme does not know.",
            where="transcription",
            found=str(error),
            expected="segments, mesh, points, controls, form, enforce or objective",
            do="Check the spelling, or leave the setting out.",
        ) from error


def resolve_solver(choice: Solver | Mapping[str, Any] | str) -> Solver:
    """Return the solver that a name, a mapping or an object stands for."""
    if not isinstance(choice, str | Mapping):
        if not callable(getattr(choice, "solve", None)):
            raise _wrong_type("solver", choice, "Ipopt(max_iterations=50)")
        return choice
    settings = {"name": choice} if isinstance(choice, str) else dict(choice)
    name = settings.pop("name", DEFAULT_SOLVER)
    if name not in SOLVERS:
        raise _unknown("solver", name, SOLVERS)
    return SOLVERS[name](**settings)


def _unknown(kind: str, name: object, known: Mapping[str, Any]) -> UserError:
    return UserError(
        f"There is no {kind} of this name.",
        where=kind,
        found=repr(name),
        expected=" or ".join(repr(key) for key in known),
        do=f"Choose one of the {kind}s above.",
    )


def _wrong_type(field: str, found: object, example: str) -> UserError:
    return UserError(
        f"The {field} has the wrong type.",
        where=field,
        found=type(found).__name__,
        expected=f"a name, or an object such as {example}",
        do="Leave it out for the default.",
    )


def check_arguments(problem: Problem, guess: object, tolerance: float) -> None:
    """Raise a UserError when problem, guess and tolerance cannot be what they should be."""
    if not isinstance(problem, Problem):
        raise UserError(
            "The first argument of solve is not a Problem.",
            where="problem",
            found=type(problem).__name__,
            expected="a skyknot Problem",
            do="Build one with sk.Problem(...), or load a mission and pass mission.problem.",
        )
    if not isinstance(tolerance, int | float) or not 0 < tolerance < np.inf:
        raise UserError(
            "The tolerance must be positive.",
            where="tolerance",
            found=tolerance,
            expected="a small positive number, e.g. 1e-6",
            do="Leave it out for the default.",
        )
    if isinstance(guess, Trajectory | Solution):
        found = (guess.states.shape[1], guess.controls.shape[1])
        if found != (problem.nx, problem.nu):
            raise UserError(
                "The guess does not fit the problem.",
                where="guess",
                found=f"{found[0]} states and {found[1]} controls",
                expected=f"{problem.nx} states and {problem.nu} controls",
                do="Give columns in the order of the problem's names.",
            )
    elif guess is not None:
        raise UserError(
            "The guess has the wrong type.",
            where="guess",
            found=type(guess).__name__,
            expected="a Trajectory, a Solution or None",
            do="Wrap arrays as sk.Trajectory(times, states, controls).",
        )


def _is_of(program: Any, guess: Solution) -> bool:
    nodes = (guess.times - guess.times[0]) / guess.trajectory.duration
    return same_unknowns(program, nodes, guess.decision, guess.multipliers)


def _history(result: SolverResult) -> Array:
    return np.array(result.history, dtype=float).reshape(-1, len(HISTORY))


@lru_cache(maxsize=1)
def _versions() -> dict[str, str]:
    return {
        "skyknot": __version__,
        "casadi": str(ca.CasadiMeta.version()),
        "numpy": np.__version__,
        "python": platform.python_version(),
    }


def _inputs_hash(program: Program, functions: Functions) -> str:
    digest = functions.read.copy()
    p, rates = program, program.rates
    for array in (
        *(p.parameters, p.C, p.A, p.fractions, p.start),
        *(p.lower, p.upper, p.path_lower, p.path_upper),
        *(p.segment_cost, rates.positions, rates.lower, rates.upper),
    ):
        digest.update(np.ascontiguousarray(array))
    return str(digest.hexdigest())


class _Stopwatch:
    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, name: str) -> None:
        now = time.perf_counter()
        self.laps[name] = now - self._last
        self._last = now
