"""Time of a cold solve: the own interior point beside Ipopt, mission by mission, in one run.

Both get the same finite program, guess and tolerance, one thread each, turn by turn; the best of
several repetitions counts. Transcription is not in the time: it is the same for both.
"""

from __future__ import annotations

import numpy as np

import skyknot as sk

MISSIONS = {
    "yaw_point_transfer": 15,
    "report_transfer": 15,
    "report_transfer_constrained": 10,
    "vertiport_hop": 5,
    "city_hop": 3,
}
"""Repetitions of each mission."""

SOLVERS = ("interior-point", "ipopt")


def main() -> None:
    """Print a line for each mission."""
    print(f"{'mission':<28}{'segments':>9}{'own':>22}{'Ipopt':>22}{'ratio':>7}  same optimum")
    for name, repetitions in MISSIONS.items():
        mission = sk.missions.load(name)
        settings = {k: v for k, v in mission.settings().items() if k != "solver"}
        answers = dict.fromkeys(SOLVERS)
        best = dict.fromkeys(SOLVERS, np.inf)
        for _ in range(repetitions):
            for solver in SOLVERS:
                solution = sk.solve(mission.problem, solver=solver, **settings)
                best[solver] = min(best[solver], solution.solve_time)
                answers[solver] = solution
        own, other = (answers[solver] for solver in SOLVERS)
        told = "".join(
            f"{1e3 * best[solver]:9.1f} ms, {answers[solver].iterations:4d} it."
            for solver in SOLVERS
        )
        apart = abs(own.objective - other.objective) / abs(other.objective)
        same = "not solved" if not (own.success and other.success) else f"to {apart:.0e}"
        ratio = best["ipopt"] / best["interior-point"]
        print(f"{name:<28}{own.record.segments:9d}{told}{ratio:7.1f}  {same}", flush=True)


if __name__ == "__main__":
    main()
