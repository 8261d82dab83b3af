"""Many instances of one problem at once: solve_many(problem, …) -> list of Solution."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from skyknot.errors import UserError
from skyknot.problem.guess import initial_guess, ladders
from skyknot.problem.problem import Problem
from skyknot.solution import Solution
from skyknot.solve import (
    DEFAULT_SOLVER,
    Rungs,
    Task,
    answered,
    check_arguments,
    resolve_solver,
    resolve_transcription,
)
from skyknot.solvers.base import Solver
from skyknot.solvers.interior_point import InteriorPoint, reusing
from skyknot.trajectory import Trajectory
from skyknot.transcription import Transcription
from skyknot.transcription.family import Family

Guess = Trajectory | Solution | None
Instance = tuple[Problem, Guess]


def solve_many(
    problem: Problem,
    *,
    parameters: Sequence[Mapping[str, float]] | None = None,
    initials: ArrayLike | None = None,
    guesses: Sequence[Guess] | None = None,
    transcription: Transcription | Mapping[str, Any] | str = "hermite-simpson",
    solver: Solver | Mapping[str, Any] | str = DEFAULT_SOLVER,
    tolerance: float = 1e-6,
    threads: int | None = None,
) -> list[Solution]:
    """Solve instances of ``problem`` that differ in numbers only, on several threads.

    Instance i takes the i-th entry of every list given, and is solved as ``solve`` would, whatever
    the others do: neither order nor values of the answers depend on the number of threads. The
    problem is transcribed and its tapes are written once for all; unknowns are scaled by what
    ``problem`` itself says. A failure is a Solution with ``success=False``.

    Parameters
    ----------
    problem : what is asked, with the numbers that no list replaces
    parameters : M mappings, values by name of parameters that are not free
    initials : (M, nx) initial states, state units
    guesses : M guesses: a Trajectory, a Solution (its multipliers are used too when the mesh is
        the same), or None for the guess ladder
    transcription, solver, tolerance : as for ``solve``
    threads : how many instances are solved at a time, by the solver "interior-point"; as many as
        there are processors by default. Other solvers take one after the other

    Returns
    -------
    list of M Solution, in the order of the instances

    Raises
    ------
    UserError
        Before iterating, with the name of the offending argument and entry.
    """
    scheme, chosen = resolve_transcription(transcription), resolve_solver(solver)
    check_arguments(problem, None, tolerance)
    workers = _checked_threads(threads)
    instances = _instances(problem, parameters, initials, guesses, tolerance)
    first = scheme.program(problem, initial_guess(problem)[0])
    family = Family.of(scheme, first)
    solvers = [chosen]  # CasADi's build on functions that all of them share, without a lock
    if isinstance(chosen, InteriorPoint):
        solvers = reusing(chosen, first, workers)
    every = _ladders(instances)

    def answer(i: int, own: Solver) -> Solution:
        variant, guess = instances[i]
        return answered(Task(variant, family, own, tolerance), guess, every[i])

    return _shared_out(len(instances), answer, solvers)


def _shared_out(
    count: int, answer: Callable[[int, Solver], Solution], solvers: Sequence[Solver]
) -> list[Solution]:
    """Return the answers 0 … count − 1; every solver has a thread that takes the next in turn."""
    pending, found = iter(range(count)), dict[int, Solution]()

    def serve(own: Solver) -> None:
        try:
            for i in pending:
                found[i] = answer(i, own)
        finally:
            _drained(pending)

    if len(solvers) == 1:
        serve(solvers[0])
    else:
        with ThreadPoolExecutor(len(solvers)) as pool:
            try:
                for served in [pool.submit(serve, own) for own in solvers]:
                    served.result()
            finally:
                _drained(pending)
    return [found[i] for i in range(count)]


def _drained(pending: Iterator[int]) -> None:
    """Leave nothing pending: after an error or Ctrl-C no thread begins another instance."""
    deque(pending, maxlen=0)


def _ladders(instances: Sequence[Instance]) -> list[Rungs]:
    """Return the guess ladder of every instance; an empty one where it has a guess."""
    climbing = iter(ladders([variant for variant, guess in instances if guess is None]))
    return [next(climbing) if guess is None else () for _, guess in instances]


def _instances(
    problem: Problem,
    parameters: Sequence[Mapping[str, float]] | None,
    initials: ArrayLike | None,
    guesses: Sequence[Guess] | None,
    tolerance: float,
) -> list[Instance]:
    states = None if initials is None else _checked_initials(initials, problem)
    lists = {"parameters": parameters, "initials": states, "guesses": guesses}
    count = _common_length({name: len(each) for name, each in lists.items() if each is not None})
    found: list[Instance] = []
    for i in range(count):
        variant, guess = problem, None if guesses is None else guesses[i]
        if parameters is not None:
            with _told(f"parameters[{i}]"):
                variant = variant.varied(parameters=parameters[i])
        if states is not None:
            with _told(f"initials[{i}]"):
                variant = variant.varied(initial=states[i].tolist())
        if guess is not None:
            with _told(f"guesses[{i}]"):
                check_arguments(variant, guess, tolerance)
        found.append((variant, guess))
    return found


def _common_length(lengths: Mapping[str, int]) -> int:
    if len(set(lengths.values())) != 1:
        told = ", ".join(f"{count} {name}" for name, count in lengths.items())
        raise UserError(
            "The lists of instances do not say how many there are.",
            where="parameters, initials, guesses",
            found=told or "no list",
            expected="at least one of them, all of the same length",
            do="Give one entry for each instance in every list that is given.",
        )
    return next(iter(lengths.values()))


def _checked_initials(initials: ArrayLike, problem: Problem) -> np.ndarray[Any, np.dtype[Any]]:
    try:
        states = np.asarray(initials, dtype=float)
    except (TypeError, ValueError):
        states = np.empty(0)
    if states.ndim != 2 or states.shape[1] != problem.nx or not np.all(np.isfinite(states)):
        raise UserError(
            "The initial states are not a table of numbers.",
            where="initials",
            found=f"shape {states.shape}" if states.size else type(initials).__name__,
            expected=f"(M, {problem.nx}) finite numbers: {', '.join(problem.state_names)}",
            do="Give one row for each instance, with a number for every state.",
        )
    return states


def _checked_threads(threads: int | None) -> int:
    if threads is None:
        return os.cpu_count() or 1
    if not isinstance(threads, int) or threads < 1:
        raise UserError(
            "The number of threads must be 1 or more.",
            where="threads",
            found=threads,
            expected="a whole number, 1 or more",
            do="Leave it out for as many as there are processors.",
        )
    return threads


@contextmanager
def _told(entry: str) -> Iterator[None]:
    """Put the entry of a list before the place that a user error names."""
    try:
        yield
    except UserError as error:
        raise UserError(
            error.what,
            where=f"{entry}: {error.where}",
            found=error.found,
            expected=error.expected,
            do=error.do,
        ) from error
