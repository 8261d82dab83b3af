"""Run with the allocation counter preloaded: heap allocations of set-up, then of each iteration.

The callback itself is quiet: it writes to a list made before the solve, and what Python needs for
its numbers comes from pools that are warm after the first iterations.
"""

import ctypes
import sys
from itertools import pairwise

from agreement.variants import PROBLEMS, SCHEMES, program_of
from skyknot.solvers.interior_point import InteriorPoint, Prepared

counter = ctypes.CDLL(None).allocation_count
counter.restype = ctypes.c_long


def solve_counting(problem: str, scheme: str) -> list[int]:
    """Return allocations of the native set-up, then between one iteration and the next."""
    prepared = Prepared(program_of(PROBLEMS[problem], SCHEMES[scheme]))
    before = counter()
    prepared = prepared.another()
    set_up = counter() - before
    data = prepared.rows.data(prepared.program.start)
    options = options_of(prepared)
    seen = [0] * 200

    def callback(iteration, *_):
        seen[iteration] = counter()

    prepared.native.solve(data, options, callback)  # warms Python's pools
    raw = prepared.native.solve(data, options, callback)
    assert raw["restorations"] == 0
    last = raw["iterations"]
    return [set_up, *(b - a for a, b in pairwise(seen[: last + 1]))]


def options_of(prepared: Prepared) -> dict:
    settings = InteriorPoint()
    names = ("max_iterations", "max_seconds", "barrier_start", "push", "refinements")
    fixed = {"tolerance": 1e-8, "acceptable_factor": 100.0, "warm": False, "interruptible": True}
    return {name: getattr(settings, name) for name in names} | fixed


if __name__ == "__main__":
    for pair in sys.argv[1:]:
        print(pair, *solve_counting(*pair.split("/")))  # noqa: T201
