"""Claim: the interior point works as little as it should, counted, not timed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import skyknot as sk
from kernel.stage_problems import Case, problem_of
from skyknot import bank as problems
from skyknot.solvers.interior_point import Prepared

HERE = Path(__file__).parent
COMPILER = shutil.which("cc")
PAIRS = (
    "everything/hermite-simpson",
    "path/trapezoid, hold",
    "point/euler",
    "rates/euler",
    "plain/hermite-simpson, hold",
)


@pytest.mark.skipif(
    not (COMPILER and sys.platform == "linux"), reason="counting needs glibc and a C compiler"
)
def test_iterations_allocate_nothing(tmp_path: Path) -> None:
    library = tmp_path / "counter.so"
    source = HERE / "allocation_counter.c"
    subprocess.run([COMPILER, "-shared", "-fPIC", "-O1", "-o", library, source], check=True)
    path = os.pathsep.join([str(HERE.parent), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(
        [sys.executable, HERE / "counted_solve.py", *PAIRS],
        env=os.environ | {"LD_PRELOAD": str(library), "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=True,
    )
    lines = [line.removeprefix(pair).split() for line, pair in _lines(run.stdout)]
    assert len(lines) == len(PAIRS)
    for set_up, *iterations in lines:
        assert int(set_up) > 100  # the counter counts
        assert len(iterations) > 5
        assert set(iterations) == {"0"}


def _lines(text: str) -> list[tuple[str, str]]:
    return list(zip(text.splitlines(), PAIRS, strict=True))


@pytest.mark.parametrize("segments", [10, 40, 100])
def test_a_quadrotor_transfer_takes_few_factorisations(segments: int) -> None:
    reference = problems.quadrotor_transfer()
    solution = sk.solve(
        reference.problem, sk.HermiteSimpson(segments), guess=reference.guess, tolerance=1e-8
    )
    assert solution.success
    work = solution.record.work
    assert solution.iterations <= 15
    assert work["restorations"] == 0
    assert work["factorisations"] <= 2 * solution.iterations + 3
    assert work["solves"] <= 4 * solution.iterations + 4
    assert work["value_runs"] <= 3 * solution.iterations + 2
    assert work["full_runs"] <= solution.iterations + 2


def test_a_linear_quadratic_problem_is_one_step() -> None:
    problem = problem_of(Case(4, 2, 10, ("hermite-simpson", "quadratic"), seed=3, bounds=False))
    for segments in (5, 50):
        solution = sk.solve(problem, sk.HermiteSimpson(segments), tolerance=1e-7)
        assert solution.iterations == 1
        assert solution.record.work["value_runs"] <= 2


@pytest.mark.parametrize("door", [sk.Euler, sk.Trapezoid, sk.HermiteSimpson])
def test_the_work_of_a_segment_does_not_grow_with_their_number(door) -> None:
    problem = problems.quadrotor_transfer().problem
    start = sk.initial_guess(problem)[0]
    work = [
        Prepared(door(segments).program(problem, start)).native.elimination_work()
        for segments in (4, 16, 128)
    ]
    assert work[0] == work[1] == work[2]


def test_elimination_exploits_the_sparsity_of_the_dynamics() -> None:
    """Dense: T of M T = −N, then H projected by it, for 24 interior and 24 other unknowns."""
    problem = problems.quadrotor_transfer().problem
    program = sk.HermiteSimpson(8).program(problem, sk.initial_guess(problem)[0])
    factor = Prepared(program).native.elimination_work()[0]
    interior, outer = 2 * 12, 12 + 3 * 4
    dense = interior**2 * outer + (outer + interior) * interior * outer
    assert factor < 0.2 * dense
