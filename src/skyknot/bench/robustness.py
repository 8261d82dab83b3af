"""How often a cold start ends well: seeded random missions, own solver beside Ipopt.

Both start from the same rung of the guess ladder with the same limits. Answers called solved are
measured again by the certificate's checks at the points the scheme sees, which share no code with
solvers or transcription: a *wrong success* is an answer called solved that fails one of them.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from skyknot.bench.random_missions import random_mission
from skyknot.problem.problem import Problem
from skyknot.solution import HISTORY, Solution
from skyknot.solve import solve
from skyknot.solvers.base import Solver
from skyknot.solvers.interior_point import InteriorPoint
from skyknot.solvers.ipopt import Ipopt
from skyknot.trajectory import Trajectory
from skyknot.verification import ends, motion, rate_limits, room
from skyknot.verification.base import Check
from skyknot.verification.evidence import Evidence
from skyknot.verification.tolerances import Limits

ITERATIONS, SECONDS = 500, 60.0
"""Limits given to both solvers."""

SOLVERS: tuple[Solver, ...] = (
    InteriorPoint(max_iterations=ITERATIONS, max_seconds=SECONDS),
    Ipopt(max_iterations=ITERATIONS, max_seconds=SECONDS),
)

SAME = 1e-4
"""Relative difference of objectives below which two answers count as the same optimum."""

WRONG = 10.0
"""Multiple of a check's limit beyond which a success is called wrong: below it lie differences of
what the solver and the check call the size of a quantity."""

CHECKS: tuple[Callable[[Evidence, Limits], Check | None], ...] = (
    ends.horizon,
    ends.ends,
    ends.points,
    room.state_bounds,
    room.control_bounds,
    room.path,
    rate_limits.rates,
    motion.defects,
)
"""The checks that a success must pass whatever the mesh."""


@dataclass(frozen=True)
class Attempt:
    """One solver on one mission.

    Attributes
    ----------
    status : how it ended; success : whether it says it is solved
    seconds : wall time of the solver, evaluation functions built anew
    worst_check, load : the check that comes closest to its limit, and its share of it; empty and
        NaN when not solved
    """

    solver: str
    status: str
    success: bool
    iterations: int
    seconds: float
    objective: float
    kkt_residual: float
    detail: str
    worst_check: str
    load: float

    @property
    def wrong(self) -> bool:
        """Whether it is called solved and is not."""
        return self.success and not self.load <= WRONG


@dataclass(frozen=True)
class Case:
    """One random mission and what each solver made of it."""

    seed: int
    title: str
    attempts: dict[str, Attempt]


def attempt(seed: int, solver: Solver) -> tuple[Attempt, Solution]:
    """Solve the mission of a seed with one solver, and judge the answer."""
    mission = random_mission(seed)
    settings = mission.settings() | {"solver": solver, "accuracy": None}
    began = time.perf_counter()
    solution = solve(mission.problem, **settings)
    seconds = time.perf_counter() - began
    worst, load = judged(mission.problem, solution) if solution.success else ("", float("nan"))
    found = Attempt(
        solver=solver.name,
        status=str(solution.status),
        success=solution.success,
        iterations=solution.iterations,
        seconds=seconds,
        objective=solution.objective,
        kkt_residual=solution.kkt_residual,
        detail=solution.record.detail,
        worst_check=worst,
        load=load,
    )
    return found, solution


def judged(problem: Problem, answer: Solution | Trajectory) -> tuple[str, float]:
    """Return the check closest to its limit (or farthest beyond it), and its share of it."""
    trajectory = answer.trajectory if isinstance(answer, Solution) else answer
    evidence = Evidence(problem, trajectory, {})
    checks = [check for judge in CHECKS if (check := judge(evidence, Limits())) is not None]
    worst = max(checks, key=lambda check: check.load)
    return f"{worst.name}: {worst.worst}", worst.load


def study(
    seeds: Iterable[int],
    solvers: Sequence[Solver] = SOLVERS,
    folder: Path | None = None,
    report: Callable[[Case], None] | None = None,
) -> list[Case]:
    """Return the cases of the seeds.

    Parameters
    ----------
    seeds : of ``random_mission``
    folder : where to keep cases as they are found (``cases.jsonl``, taken up again by a later
        call), and mission and iteration log of every failure
    report : called with every case
    """
    known = _kept(folder)
    cases = []
    for seed in seeds:
        case = known.get(seed) or _case(seed, solvers, folder)
        cases.append(case)
        if report is not None:
            report(case)
    return cases


def summary(
    cases: Sequence[Case], ours: str = "interior-point", peer: str = "ipopt"
) -> dict[str, Any]:
    """Return rates, lists of seeds and times of a study, as plain data."""
    pairs = [(case.seed, case.attempts[ours], case.attempts[peer]) for case in cases]
    both = [(seed, a, b) for seed, a, b in pairs if a.success and b.success]
    same = [(s, a, b) for s, a, b in both if abs(_excess(a, b)) <= SAME]
    return {
        "missions": len(pairs),
        "solved": {
            ours: sum(a.success for _, a, _ in pairs),
            peer: sum(b.success for _, _, b in pairs),
        },
        "only_peer_solves": [seed for seed, a, b in pairs if b.success and not a.success],
        "only_we_solve": [seed for seed, a, b in pairs if a.success and not b.success],
        "neither_solves": [seed for seed, a, b in pairs if not a.success and not b.success],
        "wrong": {
            ours: [seed for seed, a, _ in pairs if a.wrong],
            peer: [seed for seed, _, b in pairs if b.wrong],
        },
        "same_optimum": len(same),
        "ours_better": [seed for seed, a, b in both if _excess(a, b) < -SAME],
        "ours_worse": [seed for seed, a, b in both if _excess(a, b) > SAME],
        "median_iterations": {
            ours: _median([a.iterations for _, a, _ in same]),
            peer: _median([b.iterations for _, _, b in same]),
        },
        "median_seconds": {
            ours: _median([a.seconds for _, a, _ in same]),
            peer: _median([b.seconds for _, _, b in same]),
        },
    }


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else float("nan")


def _excess(a: Attempt, b: Attempt) -> float:
    """Return by how much a's objective is above b's, relative."""
    return (a.objective - b.objective) / max(abs(b.objective), 1e-3)


def _case(seed: int, solvers: Sequence[Solver], folder: Path | None) -> Case:
    mission = random_mission(seed)
    attempts = {}
    for solver in solvers:
        attempts[solver.name], solution = attempt(seed, solver)
        if folder is not None and not (solution.success and attempts[solver.name].load <= WRONG):
            (folder / f"seed_{seed}.toml").write_text(mission.text, encoding="utf-8")
            log = folder / f"seed_{seed}_{solver.name}.txt"
            log.write_text(iteration_log(solution), encoding="utf-8")
    case = Case(seed, mission.title, attempts)
    if folder is not None:
        with (folder / "cases.jsonl").open("a", encoding="utf-8") as lines:
            lines.write(json.dumps(asdict(case)) + "\n")
    return case


def iteration_log(solution: Solution) -> str:
    """Return the history as lines of text, the verdict last."""
    head = " ".join(f"{name[:12]:>13}" for name in HISTORY)
    rows = [" ".join(f"{value:13.5g}" for value in row) for row in solution.history]
    return "\n".join([head, *rows, solution.message, ""])


def _kept(folder: Path | None) -> dict[int, Case]:
    if folder is None:
        return {}
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / "cases.jsonl"
    if not kept.exists():
        return {}
    rows = [json.loads(line) for line in kept.read_text(encoding="utf-8").splitlines()]
    return {
        row["seed"]: Case(
            row["seed"],
            row["title"],
            {name: Attempt(**found) for name, found in row["attempts"].items()},
        )
        for row in rows
    }
