"""Claim: at what Ipopt calls solved, the package's own unscaled KKT residual is small too.

The residual is assembled from point-wise Jacobians, Ipopt works on one expression graph; the two
share the point functions only.
"""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from agreement.variants import ALL_SCHEMES, CASES, PROBLEMS, SCHEMES
from skyknot.kernel.evaluation import evaluate, residuals
from skyknot.kernel.program import Multipliers

TOLERANCE = 1e-9


@pytest.mark.parametrize(("problem", "scheme"), CASES)
def test_the_residual_of_a_solved_problem_is_small(problem, scheme):
    solution = sk.solve(PROBLEMS[problem], ALL_SCHEMES[scheme], solver="ipopt", tolerance=TOLERANCE)
    assert solution.status == "solved", solution.message
    # Ipopt's own test divides by the size of the multipliers, at most a hundred here.
    assert solution.kkt_residual < 100 * TOLERANCE
    assert solution.max_defect < 10 * TOLERANCE


@pytest.mark.parametrize("problem", PROBLEMS)
def test_signs_of_multipliers_tell_the_side_of_the_bound(problem):
    solution = sk.solve(PROBLEMS[problem], SCHEMES["hermite-simpson"], tolerance=TOLERANCE)
    program = SCHEMES["hermite-simpson"].program(PROBLEMS[problem], solution.trajectory)
    z, bounds = solution.decision, solution.multipliers["bounds"]
    free = program.lower < program.upper
    assert np.all(np.abs(z - program.upper)[free & (bounds > 1e-4)] < 1e-4)
    assert np.all(np.abs(z - program.lower)[free & (bounds < -1e-4)] < 1e-4)


def test_a_wrong_multiplier_shows_in_the_residual():
    problem, scheme = PROBLEMS["everything"], SCHEMES["hermite-simpson"]
    solution = sk.solve(problem, scheme, tolerance=TOLERANCE)
    program = scheme.program(problem, solution.trajectory)
    for name in ("defects", "path", "rates", "bounds"):
        arrays = {key: value.copy() for key, value in solution.multipliers.items()}
        arrays[name].flat[np.argmax(np.abs(arrays[name]))] += 1e-3
        wrong = residuals(
            program, solution.decision, Multipliers(**arrays), evaluate(program, solution.decision)
        )
        assert wrong.largest > 1e-5, name
