"""Programs that differ in numbers only, made from one."""

from __future__ import annotations

from dataclasses import dataclass, fields

from skyknot.kernel.program import Program
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.transcription.base import Array, Transcription


@dataclass(frozen=True)
class Family(Transcription):
    """A transcription that has seen its problem: ``program`` writes only the numbers anew.

    Attributes
    ----------
    first : program of the first problem; functions, bookkeeping and scales of all are its own
    """

    first: Program | None = None

    @classmethod
    def of(cls, scheme: Transcription, first: Program) -> Family:
        """Return the family of a scheme's program, with all that is made once for it."""
        settings = {entry.name: getattr(scheme, entry.name) for entry in fields(Transcription)}
        return cls(**settings, first=first.with_numbers())

    def program(self, problem: Problem, guess: Trajectory) -> Program:
        """Return the program of a problem of the family; see ``Transcription.again``."""
        assert self.first is not None
        return self.again(self.first, problem, guess)

    def taken_at(self, problem: Problem) -> tuple[Array, Array]:
        """Return where in the horizon values stand, which is the same for all of the family."""
        if "_taken_at" not in self.__dict__:
            self.__dict__["_taken_at"] = super().taken_at(problem)
        places: tuple[Array, Array] = self.__dict__["_taken_at"]
        return places
