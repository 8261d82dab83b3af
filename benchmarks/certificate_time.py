"""The time a certificate takes, and the shares of its parts.

    python benchmarks/certificate_time.py [MISSION …]

Processor seconds, least of five, one thread. The first check that needs a shared part (equations,
samples, flights, the finite program) pays for it. The source report's transfer is measured on its
own mesh of 100 equal segments, other missions on the meshes they refine to.
"""

from __future__ import annotations

import sys
import time

import skyknot as sk
from skyknot import missions
from skyknot.verification.certify import CHECKS
from skyknot.verification.evidence import Evidence
from skyknot.verification.tolerances import Limits

TURNS = 5
REPORT = "report_transfer"


def solved(name: str) -> sk.Solution:
    """Return the answer that is to be certified."""
    mission = missions.load(name)
    if name == REPORT:
        return sk.solve(mission.problem, sk.HermiteSimpson(100))
    return sk.solve(mission.problem, **mission.settings())


def measured(solution: sk.Solution) -> dict[str, float]:
    """Return the seconds of every part, in order."""
    parts: dict[str, float] = {}
    problem, witness = solution.problem, solution.full_witness()
    limits = Limits.of(problem.vehicle)
    last = time.process_time()
    evidence = Evidence(problem, solution.trajectory, solution.record.parameters, witness)
    now = time.process_time()
    parts["equations"], last = now - last, now
    for check in CHECKS:
        found = check(evidence, limits)
        now = time.process_time()
        if found is not None:
            parts[found.name] = now - last
        last = now
    return parts


def main() -> None:
    """Print a table for each mission."""
    for name in sys.argv[1:] or [REPORT, "city_hop"]:
        solution = solved(name)
        turns = [measured(solution) for _ in range(TURNS + 1)][1:]  # the first one imports
        best = min(turns, key=lambda parts: sum(parts.values()))
        total = sum(best.values())
        print(f"{name}, {solution.record.segments} segments: {1e3 * total:.0f} ms")
        for part, seconds in sorted(best.items(), key=lambda pair: -pair[1])[:10]:
            print(f"  {part:<28} {1e3 * seconds:6.1f} ms  {100 * seconds / total:4.0f} %")


if __name__ == "__main__":
    main()
