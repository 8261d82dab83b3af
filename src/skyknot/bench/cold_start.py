"""Cold start: a new process imports, builds, solves the reference transfer, and ends."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

SCRIPTS = {
    "own": """
import skyknot as sk
mission = sk.missions.load("report_transfer")
even = {"transcription": sk.HermiteSimpson(100), "accuracy": None}
assert sk.solve(mission.problem, **(mission.settings() | even)).success
""",
    "ipopt": """
import skyknot as sk
mission = sk.missions.load("report_transfer")
even = {"transcription": sk.HermiteSimpson(100), "accuracy": None, "solver": "ipopt"}
assert sk.solve(mission.problem, **(mission.settings() | even)).success
""",
    "fatrop": """
from skyknot.bench.measurement import pose_of
from skyknot.bench.peers import Fatrop
assert Fatrop(pose_of("report_transfer")).solve().success
""",
}
"""What the process runs; all import skyknot, which poses the problem."""


def cold_starts(rounds: int) -> dict[str, float]:
    """Return the median seconds of each script, run in turns; NaN for one that fails."""
    times: dict[str, list[float]] = {name: [] for name in SCRIPTS}
    for _ in range(rounds):
        for name, script in SCRIPTS.items():
            times[name].append(_seconds(script))
    return {name: statistics.median(values) for name, values in times.items()}


def _seconds(script: str) -> float:
    began = time.perf_counter()
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, check=False)
    return time.perf_counter() - began if ended.returncode == 0 else float("nan")
