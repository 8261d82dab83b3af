"""What a second thread brings to a batch of random transfers.

    python benchmarks/batch_threads.py [INSTANCES [TURNS]]

The source report's quadrotor flies to its goal from seeded random positions and headings, each on
50 segments. One thread and two take turns, so that what else the machine does meets both; the
median of the turns is told, and the ratio of the medians with the least and most of a turn.
"""

from __future__ import annotations

import statistics
import sys
import time

import numpy as np
from numpy.typing import NDArray

import skyknot as sk
from skyknot import missions

MISSION, SEGMENTS, SEED = "report_transfer", 50, 20
INSTANCES, TURNS = 256, 5


def starts(count: int) -> NDArray[np.float64]:
    """Return (count, 12) states at rest within 2 m of the origin, 1 rad of north."""
    random = np.random.default_rng(SEED)
    states = np.zeros((count, 12))
    states[:, :3] = random.uniform(-2.0, 2.0, (count, 3))
    states[:, 8] = random.uniform(-1.0, 1.0, count)
    return states


def seconds(problem: sk.Problem, initials: NDArray[np.float64], threads: int) -> float:
    """Return the wall time of a batch, s."""
    begin = time.perf_counter()
    answers = sk.solve_many(
        problem, initials=initials, transcription=sk.HermiteSimpson(SEGMENTS), threads=threads
    )
    elapsed = time.perf_counter() - begin
    failed = sum(not answer.success for answer in answers)
    if failed:
        print(f"{failed} of {len(answers)} were not solved")
    return elapsed


def main() -> None:
    """Print the times of one and two threads and their ratio."""
    given = [int(word) for word in sys.argv[1:]]
    count, turns = given[0] if given else INSTANCES, given[1] if len(given) > 1 else TURNS
    problem, initials = missions.load(MISSION).problem, starts(count)
    seconds(problem, initials[:2], 2)  # the first one writes the tapes
    pairs = [[seconds(problem, initials, threads) for threads in (1, 2)] for _ in range(turns)]
    one, two = (statistics.median(times) for times in zip(*pairs, strict=True))
    ratios = [alone / together for alone, together in pairs]
    print(f"{count} transfers, {SEGMENTS} segments, median of {turns} turns")
    print(f"  1 thread   {1e3 * one:7.0f} ms  {1e3 * one / count:6.2f} ms each")
    print(f"  2 threads  {1e3 * two:7.0f} ms  {1e3 * two / count:6.2f} ms each")
    print(f"  ratio {one / two:.2f}, of a turn {min(ratios):.2f} to {max(ratios):.2f}")


if __name__ == "__main__":
    main()
