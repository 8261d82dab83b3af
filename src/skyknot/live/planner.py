"""Plans a mission again and again while it changes: quickly on one mesh, thoroughly at rest."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from statistics import median
from typing import Any

import numpy as np

from skyknot.live.adjustable import Wish, adjustable
from skyknot.live.quick_check import QuickCheck
from skyknot.live.workspace import Workspace
from skyknot.missions import Mission
from skyknot.problem.problem import Problem
from skyknot.solution import Solution
from skyknot.solve import resolve_transcription, solve
from skyknot.status import Status
from skyknot.trajectory import Trajectory
from skyknot.transcription.pointwise import PointFunctions
from skyknot.verification import Certificate, Limits, certify

RECENT = 30
"""Re-plans over which the rate is measured."""

SOLVER = "interior-point"

ACCURACY = 1e-4
"""Of the thorough plans of missions that do not ask for an accuracy themselves."""


@dataclass(frozen=True)
class Plan:
    """What one round of planning found.

    Attributes
    ----------
    wish : where everything was wanted
    problem : the problem at these numbers
    status : how the solve ended; None when it was refused before
    objective : its value; NaN when nothing was solved
    trajectory : the path found; None when nothing was solved
    certificate : what was checked of it; None when nothing was solved
    thorough : whether this is the full certificate, not its quick part
    iterations : of the solver
    seconds : time by phase: "solve", "recover", "check"
    reason : why there is no path, in words; empty when there is one
    solution : the whole answer, of thorough plans only
    """

    wish: Wish
    problem: Problem
    status: Status | None = None
    objective: float = math.nan
    trajectory: Trajectory | None = None
    certificate: Certificate | None = None
    thorough: bool = False
    iterations: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)
    reason: str = ""
    solution: Solution | None = None

    @property
    def solved(self) -> bool:
        """Whether there is a path at all."""
        return self.trajectory is not None

    @property
    def holds(self) -> bool:
        """Whether there is a path and everything that was checked of it holds."""
        return self.certificate is not None and self.certificate.passed

    @property
    def certified(self) -> bool:
        """Whether the full certificate holds."""
        return self.thorough and self.holds

    @property
    def total(self) -> float:
        """Time of all phases, s."""
        return float(sum(self.seconds.values()))

    @property
    def sentence(self) -> str:
        """The verdict in one or two sentences."""
        if self.certificate is None or self.trajectory is None:
            return f"No plan: {self.reason}"
        if self.thorough:
            return self.certificate.sentence
        if self.holds:
            return (
                f"Solved: {self.trajectory.duration:.4g} s of flight; ends, bounds, path and"
                " equations hold. The full certificate follows at rest."
            )
        worst = self.certificate.failures[0]
        return (
            f"Solved, but too coarse between the nodes: '{worst.name}' is {worst.value:.2g}"
            f" {worst.unit} where {worst.limit:.2g} {worst.unit} is allowed ({worst.worst})."
            " The mesh follows at rest."
        )


class Planner:
    """A mission kept solved while it changes.

    Parameters
    ----------
    mission : what to fly

    Attributes
    ----------
    adjustable : what can be moved
    wish : what is wanted now
    latest : the last plan, whatever became of it; a thorough one to begin with
    certified : the last plan whose full certificate holds; None before there is one
    """

    def __init__(self, mission: Mission) -> None:
        self.adjustable = adjustable(mission)
        self.wish = self.adjustable.wish
        settings = mission.settings()
        self._scheme = resolve_transcription(settings["transcription"])
        self._tolerance = float(settings["tolerance"])
        self._accuracy = settings["accuracy"] or ACCURACY
        self._functions = PointFunctions.of(self.adjustable.problem)
        self._check = QuickCheck(self.adjustable.problem)
        self._limits = Limits.of(mission.vehicle, **_stated(mission))
        self._workspace: Workspace | None = None
        self._recent: deque[tuple[float, float]] = deque(maxlen=RECENT)
        self._path: Trajectory | None = None
        self.certified: Plan | None = None
        self.latest: Plan | None = None
        self.settle()

    @property
    def rate(self) -> float:
        """Re-plans per second, by the median time of the last ones; NaN before there is any."""
        return 1 / median(wall for wall, _ in self._recent) if self._recent else math.nan

    @property
    def rate_alone(self) -> float:
        """The same per second of processor time: the rate where nothing else is running."""
        return 1 / median(own for _, own in self._recent) if self._recent else math.nan

    @property
    def segments(self) -> int:
        """Number of segments of the mesh of re-plans; 0 before the first success."""
        return 0 if self._workspace is None else self._workspace.family.segments

    def replan(
        self,
        start: Any = None,
        goal: Any = None,
        obstacles: Mapping[str, Any] | None = None,
        limits: Mapping[str, float] | None = None,
    ) -> Plan:
        """Return the plan after a change, from the last answer on its mesh.

        Parameters
        ----------
        start, goal : (3,) NED, m; None leaves them where they are
        obstacles : shifts (3,) from the mission's places, NED, m, by name
        limits : values by name, in the unit of the limit

        Raises
        ------
        UserError
            When a name is unknown, a value is not finite, or a limit leaves its range.
        """
        self.wish = self.adjustable.changed(self.wish, start, goal, obstacles, limits)
        if self._workspace is None:
            return self.settle()
        begun, own = time.perf_counter(), time.thread_time()
        plan = self._replanned(self._workspace)
        if plan.status is not None:
            self._recent.append((time.perf_counter() - begun, time.thread_time() - own))
        self.latest, self._path = plan, plan.trajectory or self._path
        return plan

    def settle(self) -> Plan:
        """Return the plan of what is wanted now, solved thoroughly, and go on from it."""
        return self.adopt(self.examine(self.wish))

    def examine(self, wish: Wish) -> Plan:
        """Return the thorough plan of a wish: mesh refined, full certificate.

        From the last path first, then as the mission itself begins, until a certificate holds.
        Changes nothing, so that it can run beside re-plans, on another thread.
        """
        problem = self.adjustable.at(wish)
        reason = self._refusal(problem)
        if reason:
            return Plan(wish, problem, thorough=True, reason=reason)
        best = None
        for guess in self._guesses():
            plan = self._examined(wish, problem, guess)
            if plan.certified:
                return plan
            best = plan if best is None or plan.solved > best.solved else best
        assert best is not None
        return best

    def adopt(self, plan: Plan) -> Plan:
        """Take a thorough plan over: its mesh when it is still wanted, its path when certified."""
        if plan.certified:
            self.certified = plan
        if plan.wish == self.wish:
            self.latest, self._path = plan, plan.trajectory or self._path
            if plan.solved and plan.solution is not None:
                self._workspace = Workspace.of(
                    self._scheme, self._functions, plan.problem, plan.solution
                )
        return plan

    def _guesses(self) -> list[Trajectory | None]:
        last = self._path
        own = self.adjustable.mission.guess
        return [own] if last is None else [last, own]

    def _examined(self, wish: Wish, problem: Problem, guess: Trajectory | None) -> Plan:
        begun = time.perf_counter()
        solution = solve(
            problem, self._scheme, SOLVER, guess, self._tolerance, accuracy=self._accuracy
        )
        plan = Plan(
            wish,
            problem,
            status=solution.status,
            objective=solution.objective,
            thorough=True,
            iterations=solution.iterations,
            seconds={"solve": time.perf_counter() - begun},
            solution=solution,
        )
        if not solution.success:
            return replace(plan, reason=_words(solution.status, solution.record.detail))
        solved = time.perf_counter()
        certificate = certify(
            problem, solution.trajectory, {}, self._limits, solution.full_witness()
        )
        seconds = {**plan.seconds, "check": time.perf_counter() - solved}
        return replace(
            plan, trajectory=solution.trajectory, certificate=certificate, seconds=seconds
        )

    def _replanned(self, workspace: Workspace) -> Plan:
        problem = self.adjustable.at(self.wish)
        reason = self._refusal(problem)
        if reason:
            return Plan(self.wish, problem, reason=reason)
        begun = time.perf_counter()
        program, result = workspace.solve(problem, self._tolerance)
        solved = time.perf_counter()
        plan = Plan(
            self.wish,
            problem,
            status=result.status,
            iterations=result.iterations,
            seconds={"solve": solved - begun},
        )
        if not result.status.success:
            return replace(plan, reason=_words(result.status, result.detail))
        found = workspace.recovered(program, result)
        recovered = time.perf_counter()
        certificate = self._check(problem, found.trajectory, self._limits)
        seconds = {
            "solve": solved - begun,
            "recover": recovered - solved,
            "check": time.perf_counter() - recovered,
        }
        return replace(
            plan,
            objective=found.objective,
            trajectory=found.trajectory,
            certificate=certificate,
            seconds=seconds,
        )

    def _refusal(self, problem: Problem) -> str:
        """Return why no path can join the ends, when that can be said at once; else nothing."""
        ends = (
            ("start", problem.initial_lower, problem.initial_upper),
            ("goal", problem.final_lower, problem.final_upper),
        )
        equations = self._check.equations(problem)
        for name, lower, upper in ends:
            fixed = np.isfinite(lower) & (lower == upper)
            if not np.all(fixed[:3]):
                continue
            state = np.where(fixed, lower, 0.0)
            values = equations.path(state[None], np.zeros((1, problem.nu)), np.zeros(1))[0]
            for entry, value in zip(problem.path, values, strict=True):
                excess = max(
                    -math.inf if entry.lower is None else entry.lower - value,
                    -math.inf if entry.upper is None else value - entry.upper,
                )
                if entry.shape is not None and excess > _INSIDE:
                    side = "outside" if entry.shape.keep_in else "inside"
                    return (
                        f"the {name} lies {side} '{entry.name}',"
                        f" {excess:.2g} {entry.unit} on the wrong side. Move one of them."
                    )
        return ""


_INSIDE = 1e-6
"""Metres on the wrong side of a constraint from which an end is refused."""


def _words(status: Status, detail: str) -> str:
    parts = [status.sentence[0].lower() + status.sentence[1:], detail, status.advice]
    return " ".join(part for part in parts if part)


def _stated(mission: Mission) -> dict[str, float]:
    """Return the limits of the certificate that the mission states itself."""
    return mission.file.verification.model_dump(exclude_none=True)
