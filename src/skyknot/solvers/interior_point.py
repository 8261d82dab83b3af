"""The kernel's interior point behind the solver contract."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.evaluation import complete_fixed
from skyknot.kernel.program import Multipliers, Program
from skyknot.kernel.rows import Rows, native_solver, tapes
from skyknot.solvers.base import Callback, IterationRecord, Solver, SolverResult
from skyknot.solvers.blame import undefined_value, worst_violation
from skyknot.status import Status

Array = NDArray[np.float64]

_OUTCOMES = (
    Status.SOLVED,
    Status.ACCEPTABLE,
    Status.INFEASIBLE,
    Status.ITERATION_LIMIT,
    Status.TIME_LIMIT,
    Status.EVALUATION_ERROR,
    Status.STALLED,
    Status.INTERRUPTED,
    Status.UNBOUNDED,
)


@dataclass(frozen=True)
class InteriorPoint:
    """Settings of the structure-exploiting interior point.

    Parameters
    ----------
    max_iterations : stop after this many iterations
    max_seconds : stop after this much time, s
    barrier_start : first barrier parameter, in the scaled objective
    refinements : most refinement steps of a linear solve
    push : how far inside its bounds the start is moved, relative
    warm_barrier, warm_push : the same when multipliers are given
    """

    max_iterations: int = 1000
    max_seconds: float = 600.0
    barrier_start: float = 0.1
    refinements: int = 3
    push: float = 1e-2
    warm_barrier: float = 1e-6
    warm_push: float = 1e-8
    name: str = "interior-point"

    def for_inherited(self) -> InteriorPoint:
        """Return settings for multipliers of another mesh: near the optimum, not on it.

        Measured over the missions of the library: fewest iterations with a barrier of 1e-4.
        """
        return replace(self, warm_barrier=1e-4, warm_push=1e-3)

    def solve(
        self,
        program: Program,
        tolerance: float,
        multipliers: Multipliers | None = None,
        callback: Callback | None = None,
    ) -> SolverResult:
        """Solve the program to ``tolerance``; see Solver."""
        return Prepared(program).solve(self, program.start, tolerance, multipliers, callback)


class Prepared:
    """A program made ready: tapes, sparsity and workspace, to be solved many times."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.rows = Rows(program)
        self._tapes = tapes(program, self.rows.path_scale)
        self._structure = self.rows.structure(self._tapes.patterns)
        self.native = native_solver(self._structure, self._tapes)

    def at(self, program: Program) -> Prepared:
        """Return the same workspace for a program that differs in numbers only.

        That is in bounds, start and parameters: functions, scheme, sizes and scales are the same.
        """
        other = copy.copy(self)
        other.program, other.rows = program, self.rows.at(program)
        return other

    def another(self) -> Prepared:
        """Return a second workspace on the same tapes, for another thread."""
        other = copy.copy(self)
        other.native = native_solver(self._structure, self._tapes)
        return other

    def solve(
        self,
        settings: InteriorPoint,
        z: Array,
        tolerance: float,
        multipliers: Multipliers | None = None,
        callback: Callback | None = None,
        *,
        interruptible: bool = True,
    ) -> SolverResult:
        """Solve from z; ``interruptible`` looks for Ctrl-C each iteration, which needs the lock."""
        data = self.rows.data(z)
        options: dict[str, Any] = {
            "tolerance": tolerance,
            "max_iterations": settings.max_iterations,
            "max_seconds": settings.max_seconds,
            "barrier_start": settings.barrier_start,
            "push": settings.push,
            "refinements": settings.refinements,
            "acceptable_factor": 100.0,
            "warm": multipliers is not None,
            "interruptible": interruptible,
        }
        if multipliers is not None:
            data |= self.rows.warm(multipliers)
            options |= {"barrier_start": settings.warm_barrier, "push": settings.warm_push}
        raw = self.native.solve(data, options, _watch(callback))
        return self._result(raw)

    def _result(self, raw: dict[str, Any]) -> SolverResult:
        status = _OUTCOMES[raw["outcome"]]
        z = self.rows.unknowns(raw)
        multipliers = self.rows.multipliers(raw)
        if not status.success or self.rows.limits.fixed_globals:
            complete_fixed(self.program, z, multipliers)
        if not status.success and undefined_value(self.program, z):
            status = Status.EVALUATION_ERROR
        counts = ("factorisations", "solves", "value_runs", "full_runs", "restorations")
        return SolverResult(
            z=z,
            multipliers=multipliers,
            status=status,
            iterations=int(raw["iterations"]),
            history=tuple(IterationRecord(i, *row) for i, row in enumerate(raw["history"])),
            work={name: int(raw[name]) for name in counts},
            detail="" if status.success else worst_violation(self.program, z),
            gains=self.rows.gains(raw["gains"]),
            barrier=float(raw["barrier"]),
        )


def reusing(settings: InteriorPoint, program: Program, count: int) -> list[Solver]:
    """Return solvers with workspaces of their own, for programs that differ in numbers only.

    Each serves one thread at a time, and does not look for Ctrl-C.
    """
    prepared = Prepared(program)
    others = [prepared.another() for _ in range(count - 1)]
    return [_Reusing(settings, each) for each in (prepared, *others)]


@dataclass(frozen=True)
class _Reusing:
    settings: InteriorPoint
    prepared: Prepared
    name: str = InteriorPoint.name

    def solve(
        self,
        program: Program,
        tolerance: float,
        multipliers: Multipliers | None = None,
        callback: Callback | None = None,
    ) -> SolverResult:
        """Solve a program like the one prepared; see Solver."""
        prepared = self.prepared.at(program)
        return prepared.solve(
            self.settings, program.start, tolerance, multipliers, callback, interruptible=False
        )


def _watch(callback: Callback | None) -> Any:
    if callback is None:
        return None

    def report(iteration: int, *numbers: float) -> bool:
        try:
            return bool(callback(IterationRecord(iteration, *numbers)))
        except KeyboardInterrupt:
            return True

    return report
