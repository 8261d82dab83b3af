"""Claim: the witness holds every multiplier of the program once, free of the program's layout."""

import numpy as np
import pytest

import skyknot as sk
from agreement.variants import PROBLEMS, SCHEMES


@pytest.fixture(scope="module", params=SCHEMES)
def solution(request):
    return sk.solve(PROBLEMS["everything"], SCHEMES[request.param])


def test_every_bound_multiplier_is_there_once(solution):
    witness = solution.witness
    parts = (witness.state_bounds, witness.control_bounds, witness.global_bounds)
    told = np.concatenate([part[part != 0] for part in parts])
    known = solution.multipliers["bounds"]
    np.testing.assert_array_equal(np.sort(told), np.sort(known[known != 0]))


def test_every_path_multiplier_is_there_once(solution):
    told, known = solution.witness.path, solution.multipliers["path"]
    np.testing.assert_array_equal(np.sort(told[told != 0]), np.sort(known[known != 0]))


def test_rate_rows_read_the_control_values_they_bound(solution):
    witness, segments = solution.witness, solution.trajectory.segments
    changes = np.sum(
        witness.rate_weights * segments.control_values.reshape(-1)[witness.rate_values], axis=1
    )
    rates = changes / (witness.rate_spans * solution.trajectory.duration)
    nu = len(solution.trajectory.control_names)
    control = witness.rate_values[:, 0] % nu
    assert len(rates) > 0
    assert np.all(rates <= solution.problem.rate_upper[control] + 1e-5)
    assert np.all(rates >= solution.problem.rate_lower[control] - 1e-5)


def test_the_full_witness_carries_costates_and_gains(solution):
    full = solution.full_witness()
    assert full.costates is solution.costates
    assert full.gains is solution.gains
    assert solution.witness.costates is None
