"""Programs that differ in numbers only, made from one."""

from __future__ import annotations

from dataclasses import dataclass, fields

from skyknot.kernel.program import Program
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.transcription.base import Transcription


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
        """Return the family of a scheme's program."""
        settings = {entry.name: getattr(scheme, entry.name) for entry in fields(Transcription)}
        return cls(**settings, first=first)

    def program(self, problem: Problem, guess: Trajectory) -> Program:
        """Return the program of a problem of the family; see ``Transcription.again``."""
        assert self.first is not None
        return self.again(self.first, problem, guess)
