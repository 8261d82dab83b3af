"""Sections 5.4 and 6: the control flown open loop, and what the mesh must be for it to arrive.

Legend: N segments, h their lengths, x states, x̂ flown states, e_RMS of equation (26).
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.paper.base import Claim, Finding, Measure, Scale, judged, written
from skyknot.paper.transfers import (
    ACCURACY,
    GOAL,
    GRADING,
    SEGMENTS,
    graded_flight,
    refined_flight,
    report_flight,
    state_at,
    transfer,
)
from skyknot.solution import Solution
from skyknot.verification import certify
from skyknot.verification.evidence import Evidence

Array = NDArray[np.float64]

SAID_RMS, SAID_MISS = 0.02, 0.02
"""What the source report says: (26), and "1–2 %" of section 5.4."""

SHOWN = 0.6
"""Seconds at the start that the figure of the torques shows."""


@dataclass(frozen=True)
class Flown:
    """A solution on one mesh, and what its control does.

    Attributes
    ----------
    mesh, segments : in words, and N
    shortest : length of the shortest segment, s
    defect : largest, as solved
    objective : J
    rms : e_RMS, equation (26)
    miss : distance between the flown and the optimised end, m
    certified : whether every check of the certificate passes
    """

    mesh: str
    segments: int
    shortest: float
    defect: float
    objective: float
    rms: float
    miss: float
    certified: bool


def forward_simulation(scale: Scale) -> Finding:
    """Judge "RMS < 0.02 against forward simulation", (26), and find meshes that keep it."""
    counts = scale.pick((SEGMENTS, 400), (50, SEGMENTS, 200, 400, 800))
    equal = [flown("equal", report_flight(N)) for N in counts]
    at_size = equal[counts.index(SEGMENTS)]
    graded = flown("graded", graded_flight(SEGMENTS))
    refined = flown("refined", refined_flight())
    enough = [row.segments for row in equal if row.rms < SAID_RMS]
    claim = Claim(
        claim="Forward simulation",
        section="6, equation (26)",
        said="The flown trajectory follows the optimised one: e_RMS < 0.02.",
        measured=(
            *(Measure(f"e_RMS, N = {row.segments}, equal segments", row.rms) for row in equal),
            Measure(f"e_RMS, N = {SEGMENTS}, graded towards the start", graded.rms),
            Measure(f"e_RMS, refined by itself, N = {refined.segments}", refined.rms),
            Measure(f"miss at the end, N = {SEGMENTS}, equal", at_size.miss, "m"),
            Measure(f"miss at the end, N = {SEGMENTS}, graded", graded.miss, "m"),
            Measure("miss at the end, refined", refined.miss, "m"),
            Measure("first N of equal segments tried that keeps 0.02", min(enough, default=np.inf)),
        ),
        how=(
            "Controls of the report's transfer flown open loop from x(0) by DOP853 at 1e-9,"
            " restarted at every node; (26) over all twelve states in SI units. The graded mesh"
            f" has its nodes at t_f (k/N)^{GRADING:g}, k = 0 … N: the same N = {SEGMENTS};"
            f" the refined one begins with {SEGMENTS // 4} segments and is asked for an accuracy of"
            f" {ACCURACY:g}."
        ),
        verdict=judged(at_size.rms < SAID_RMS, max(graded.rms, refined.rms) < SAID_RMS),
        why=(
            "The optimum begins with full torque either way within tenths of a second, faster than"
            f" equal segments of {at_size.shortest:g} s resolve: the flight ends"
            f" {at_size.miss:.2g} m off. The same number of segments, dense at the start, keeps"
            f" the claim: {graded.rms:.2g}. A mesh that refines itself finds that out:"
            f" {written(refined.rms, 2)}."
        ),
    )
    data = {
        "rows": [asdict(row) for row in (*equal, graded, refined)],
        "paths": {
            "equal": _path(report_flight(SEGMENTS)),
            "graded": _path(graded_flight(SEGMENTS)),
            "refined": _path(refined_flight()),
        },
        "starts": {
            "equal": _start(report_flight(SEGMENTS)),
            "graded": _start(graded_flight(SEGMENTS)),
            "refined": _start(refined_flight()),
            "fine": _start(report_flight(counts[-1])),
        },
        "fine": counts[-1],
    }
    return Finding(claim, data)


def arrival(scale: Scale) -> Finding:
    """Judge "the final state is within 1–2 % of the desired values" (section 5.4)."""
    solution = report_flight(scale.pick(SEGMENTS, 400))
    share = _share(solution.states[-1])
    ways = {
        "equal": flown("equal", report_flight(SEGMENTS)),
        "graded": flown("graded", graded_flight(SEGMENTS)),
    }
    size = float(np.linalg.norm(GOAL[:3]))
    off = {name: way.miss / size for name, way in ways.items()}
    kept = share <= SAID_MISS
    claim = Claim(
        claim="Error in the final state",
        section="5.4",
        said="The final state is typically within 1–2 % of the desired values.",
        measured=(
            Measure("distance of the optimised end from x_f", 100 * share, "% of ‖x_f‖"),
            *(
                Measure(
                    f"flown end off it, N = {SEGMENTS}, {name} segments",
                    100 * value,
                    "% of the way",
                )
                for name, value in off.items()
            ),
        ),
        how="Last node of the report's transfer against x_f; and where the open-loop flight ends.",
        verdict=judged(kept and off["equal"] <= SAID_MISS, kept and off["graded"] <= SAID_MISS),
        why=(
            "The end weight 100 Q over ten seconds pulls the optimised state into the goal to"
            f" {100 * share:.1g} %. Flown open loop it misses by {ways['equal'].miss:.2g} m with"
            f" N = {SEGMENTS} equal segments, by {1e3 * ways['graded'].miss:.2g} mm with as many"
            " graded ones: see (26)."
        ),
    )
    return Finding(claim, {})


def flown(mesh: str, solution: Solution) -> Flown:
    """Return what flying a solution's control open loop tells of it."""
    certificate = certify(transfer(), solution.trajectory)
    end = _evidence(solution).flown[-1, :3] - solution.states[-1, :3]
    return Flown(
        mesh=mesh,
        segments=len(solution.times) - 1,
        shortest=round(float(np.diff(solution.times).min()), 9),
        defect=solution.max_defect,
        objective=solution.objective,
        rms=certificate.checks["open-loop flight"].value,
        miss=float(np.linalg.norm(end)),
        certified=certificate.passed,
    )


def _evidence(solution: Solution) -> Evidence:
    return Evidence(transfer(), solution.trajectory, {})


def _path(solution: Solution) -> dict[str, list[float] | list[list[float]]]:
    """Return node times with optimised and flown positions, m."""
    return {
        "times": solution.times.tolist(),
        "optimised": solution.states[:, :3].tolist(),
        "flown": _evidence(solution).flown[:, :3].tolist(),
    }


def _start(solution: Solution) -> dict[str, list[float] | list[list[float]]]:
    """Return torques over the first moments, N m, and where the nodes are."""
    times = np.linspace(0.0, SHOWN, 601)
    nodes = solution.times[solution.times <= SHOWN]
    return {
        "times": times.tolist(),
        "torques": solution.control(times)[:, 1:3].tolist(),
        "nodes": nodes.tolist(),
        "node torques": solution.controls[: len(nodes), 1:3].tolist(),
    }


def _share(end: Array) -> float:
    target = state_at(GOAL)
    return float(np.linalg.norm(end - target) / np.linalg.norm(target))
