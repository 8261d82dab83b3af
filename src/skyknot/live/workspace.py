"""A mesh made ready to be solved on again and again, each time from the last answer."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.program import Multipliers, Program
from skyknot.problem.problem import Problem
from skyknot.solution import Solution
from skyknot.solvers.base import SolverResult
from skyknot.solvers.interior_point import InteriorPoint, Prepared
from skyknot.trajectory import Trajectory
from skyknot.transcription import Transcription
from skyknot.transcription.family import Family
from skyknot.transcription.pointwise import PointFunctions
from skyknot.transcription.recover import Recovered, multipliers_from, recover

Array = NDArray[np.float64]

NEARBY = InteriorPoint(max_iterations=60, max_seconds=1.0)
"""From the last answer with its multipliers: what a drag needs, in few iterations."""

AFAR = InteriorPoint(max_iterations=150, max_seconds=1.0)
"""From the last path alone, when its multipliers mislead."""

NUDGE = 0.5
"""Smallest move of an end, in the state's unit, that takes the way in between along. Measured on
the city mission: below, moving the end alone needs fewer iterations (7 against 9 at 0.2 m); above,
many more (157 against 22 at 2 m)."""


@dataclass
class Workspace:
    """A mesh with tapes and memory of its own, and the last answer on it.

    Attributes
    ----------
    family : the scheme on its mesh, which writes programs as numbers only
    prepared : tapes and memory of the solver
    path : the answer the mesh was made for
    z, multipliers : the last answer that was solved
    """

    family: Family
    prepared: Prepared
    path: Trajectory
    z: Array
    multipliers: Multipliers | None

    @classmethod
    def of(
        cls,
        scheme: Transcription,
        functions: PointFunctions,
        problem: Problem,
        solution: Solution,
    ) -> Workspace:
        """Return the workspace on a solution's mesh, begun from it."""
        nodes = (solution.times - solution.times[0]) / solution.trajectory.duration
        own = replace(scheme, nodes=nodes)
        program = own.program_of(functions, problem, solution.trajectory)
        same = solution.decision.shape == program.start.shape
        multipliers = multipliers_from(program, solution.multipliers) if same else None
        return cls(
            Family.of(own, program),
            Prepared(program),
            solution.trajectory,
            solution.decision if same else program.start,
            multipliers,
        )

    def solve(self, problem: Problem, tolerance: float) -> tuple[Program, SolverResult]:
        """Solve a problem that differs in numbers only; an answer is kept as the next start."""
        program = self.family.program(problem, self.path)
        program = program.starting_at(self._displaced(program))
        prepared = self.prepared.at(program)
        result = prepared.solve(
            NEARBY, program.start, tolerance, self.multipliers, interruptible=False
        )
        if not result.status.success:
            again = prepared.solve(AFAR, program.start, tolerance, interruptible=False)
            spent = result.iterations + again.iterations
            result = replace(again, iterations=spent)
        if result.status.success:
            self.z, self.multipliers = result.z, result.multipliers
        return program, result

    def _displaced(self, program: Program) -> Array:
        """Return the last answer with both ends moved to their bounds, and the way in between.

        A state's move fades from one end of the horizon to the other, linearly in time.
        """
        layout, z = program.layout, self.z.copy()
        places = layout.states_at(layout.state)
        ends = places[0, 0], places[-1, -1]
        first, last = (np.clip(z[e], program.lower[e], program.upper[e]) - z[e] for e in ends)
        if max(np.abs(first).max(), np.abs(last).max()) < NUDGE:
            return np.clip(z, program.lower, program.upper)
        begins = np.cumsum(program.fractions) - program.fractions
        tau = (begins[:, None] + program.fractions[:, None] * self.family.table.points)[..., None]
        # a place shared by two segments takes its move once
        z[places] = self.z[places] + (1 - tau) * first + tau * last
        return np.clip(z, program.lower, program.upper)

    def recovered(self, program: Program, result: SolverResult) -> Recovered:
        """Return what an answer means, in the user's units."""
        points = self.family.table.points
        return recover(program, points, result.z)
