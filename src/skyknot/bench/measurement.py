"""Turn by turn: every contestant solves once a round, so that a busy moment hits all alike."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass, field

from skyknot import missions
from skyknot.bench.peers import Answer, Contestant, Pose, built
from skyknot.errors import UserError
from skyknot.problem.guess import initial_guess
from skyknot.solve import resolve_transcription

LEAST = 3
"""Rounds that even a slow contestant takes part in."""


@dataclass
class Timing:
    """What one contestant took.

    Attributes
    ----------
    build : seconds to build it; wall, cpu : seconds of each solve, by the clock and the processor
    answer : the last answer; None when it could not be built
    refusal : why it could not be built
    """

    name: str
    build: float = float("nan")
    wall: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)
    answer: Answer | None = None
    refusal: str = ""

    @property
    def median(self) -> float:
        """Median wall time of a solve, s; NaN without one that succeeded."""
        solved = self.answer is not None and self.answer.success
        return statistics.median(self.wall) if solved else float("nan")

    @property
    def per_iteration(self) -> float:
        """Median wall time of an iteration, s, solved or not."""
        if self.answer is None or not self.wall:
            return float("nan")
        return statistics.median(self.wall) / max(1, self.answer.iterations)


@dataclass(frozen=True)
class Contest:
    """One mission at one size, measured."""

    mission: str
    segments: int
    timings: dict[str, Timing]

    def ratio(self, name: str) -> float:
        """Return the time of a peer over our own; NaN when one of them did not solve."""
        return self.timings[name].median / self.timings["own"].median


SEGMENTS = {"city_hop": 140, "vertiport_hop": 150, "yaw_point_transfer": 60}
"""Equal segments of a mission in a contest: one mesh for all contestants, without refinement."""


def pose_of(mission: str, segments: int | None = None) -> Pose:
    """Return a library mission as contestants get it, on a mesh of its own or of ``segments``."""
    loaded = missions.load(mission)
    settings = loaded.settings()
    choice = settings["transcription"] | {"segments": segments or SEGMENTS.get(mission, 100)}
    guess = loaded.guess or initial_guess(loaded.problem)[0]
    return Pose(loaded.problem, resolve_transcription(choice), guess, settings["tolerance"])


def contest(mission: str, pose: Pose, names: Sequence[str], rounds: int, budget: float) -> Contest:
    """Build all, warm all up once, then measure in turns.

    Parameters
    ----------
    names : of the contestants
    rounds : solves of each
    budget : seconds after which a contestant that has had ``LEAST`` rounds retires; one whose
        single solve takes as long retires at once
    """
    timings, contestants = {}, dict[str, Contestant]()
    for name in names:
        timings[name] = Timing(name)
        try:
            contestants[name], timings[name].build = built(name, pose)
        except (UserError, RuntimeError) as error:
            timings[name].refusal = str(error).splitlines()[0]
            continue
        _measure(contestants[name], Timing(name))  # the first solve allocates: not counted
    for done in range(rounds):
        for name, contestant in contestants.items():
            spent = sum(timings[name].wall)
            if spent < budget and (done < LEAST or spent * (done + 1) / done < budget):
                _measure(contestant, timings[name])
    return Contest(mission, pose.scheme.segments, timings)


def _measure(contestant: Contestant, timing: Timing) -> None:
    wall, cpu = time.perf_counter(), time.process_time()
    timing.answer = contestant.solve()
    timing.wall.append(time.perf_counter() - wall)
    timing.cpu.append(time.process_time() - cpu)
