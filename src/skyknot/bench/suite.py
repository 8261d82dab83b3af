"""The whole bench: missions, growth with the number of segments, cold start; as plain data."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from skyknot import missions
from skyknot.bench.cold_start import cold_starts
from skyknot.bench.machine import machine_facts
from skyknot.bench.measurement import Contest, contest, pose_of

GROWTH = "report_transfer"
"""The mission whose number of segments is varied."""

FORMS = ("own", "ipopt", "ipopt, expanded", "fatrop", "fatrop, expanded")
COMPILED = ("ipopt, compiled", "fatrop, compiled")
GROWING = ("own", "ipopt", "fatrop")


@dataclass(frozen=True)
class Plan:
    """What to measure.

    Attributes
    ----------
    missions : names; segments : sizes for the growth
    forms, growing : contestants on missions and in the growth
    rounds : solves of each; budget : see ``contest``; cold : rounds of cold starts
    """

    missions: tuple[str, ...]
    segments: tuple[int, ...] = (25, 50, 100, 200, 400, 800, 1600)
    forms: tuple[str, ...] = FORMS
    growing: tuple[str, ...] = GROWING
    rounds: int = 10
    budget: float = 60.0
    cold: int = 5


@dataclass(frozen=True)
class Results:
    """What was measured."""

    contests: list[Contest]
    growth: list[Contest]
    cold: dict[str, float]
    machine: dict[str, Any]

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for JSON; the slopes and the headline are among it."""
        return asdict(self) | {"slopes": self.slopes(), "headline": self.headline()}

    def slopes(self) -> dict[str, dict[str, float]]:
        """Return, of each contestant, the exponents of time and of time an iteration in N."""
        found = {}
        for name in self.growth[0].timings if self.growth else ():
            timings = [(each.segments, each.timings[name]) for each in self.growth]
            found[name] = {
                "time": slope([(n, timing.median) for n, timing in timings]),
                "time_per_iteration": slope([(n, t.per_iteration) for n, t in timings]),
            }
        return found

    def headline(self) -> str:
        """Return the verdict in one sentence; where we lose, it says so."""
        ratios = {(c.mission, name): c.ratio(name) for c in self.contests for name in c.timings}
        fastest = [
            (_least(ratios[c.mission, name] for name in c.timings if name != "own"), c.mission)
            for c in self.contests
        ]
        known = sorted(pair for pair in fastest if math.isfinite(pair[0]))
        lost = [f"{name} ({1 / ratio:.2g} times slower)" for ratio, name in known if ratio < 1]
        unsolved = [c.mission for c in self.contests if math.isnan(c.timings["own"].median)]
        if not known:
            return "Nothing could be compared."
        text = (
            f"Against the fastest peer form of each mission, own is {known[0][0]:.3g} to"
            f" {known[-1][0]:.3g} times as fast on {len(known)} missions"
        )
        text += f"; slower on {', '.join(lost)}" if lost else "; slower on none"
        text += f"; own does not solve {', '.join(unsolved)}" if unsolved else ""
        return text + "."


def plan(*, quick: bool, compiled: bool = False, rounds: int = 10, budget: float = 60.0) -> Plan:
    """Return the plan of a bench; a quick one takes less than a minute and tells less."""
    forms = FORMS + (COMPILED if compiled else ())
    if quick:
        short = ("report_transfer", "report_transfer_constrained", "yaw_point_transfer")
        return Plan(short, (25, 50, 100, 200, 400), forms, ("own", "ipopt"), 3, 3.0, 1)
    return Plan(tuple(missions.names()), forms=forms, rounds=rounds, budget=budget)


def measured(asked: Plan, report: Callable[[Contest], None] | None = None) -> Results:
    """Run a plan; ``report`` sees every contest as it ends."""
    machine = machine_facts()
    told = report or (lambda _: None)

    def run(mission: str, names: Sequence[str], segments: int | None = None) -> Contest:
        found = contest(mission, pose_of(mission, segments), names, asked.rounds, asked.budget)
        told(found)
        return found

    contests = [run(mission, asked.forms) for mission in asked.missions]
    growth = [run(GROWTH, asked.growing, segments) for segments in asked.segments]
    cold = cold_starts(asked.cold) if asked.cold else {}
    return Results(
        contests, growth, cold, machine | {"load_at_end": machine_facts()["load_average"]}
    )


def slope(points: Sequence[tuple[float, float]]) -> float:
    """Return the exponent that fits the points best, log over log; NaN with fewer than three."""
    known = [(n, t) for n, t in points if math.isfinite(t) and t > 0]
    if len(known) < 3:
        return float("nan")
    n, t = np.log(np.array(known)).T
    return float(np.polyfit(n, t, 1)[0])


def _least(values: Any) -> float:
    return min((value for value in values if math.isfinite(value)), default=float("nan"))
