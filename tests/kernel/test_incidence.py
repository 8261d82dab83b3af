"""Claim: the entries that parts of a program read are spelled out once and summed in order."""

from __future__ import annotations

import numpy as np
import pytest

from agreement.variants import PROBLEMS, SCHEMES, program_of
from skyknot.kernel.incidence import summed


def test_sums_are_those_of_one_addend_after_the_other_to_the_bit():
    random = np.random.default_rng(5)
    places, values = random.integers(0, 50, 2000), random.normal(size=2000) * 1e8
    expected = np.zeros(50)
    np.add.at(expected, places, values)
    np.testing.assert_array_equal(summed(places, values, 50), expected)


def test_a_program_that_differs_in_numbers_only_keeps_its_incidence():
    program = program_of(PROBLEMS["plain"], SCHEMES["hermite-simpson"])
    assert program.starting_at(program.start + 1.0).incidence is program.incidence
    assert program.with_parameters(program.parameters).incidence is program.incidence


@pytest.mark.parametrize("scheme", SCHEMES)
def test_cost_weights_of_points_sum_to_the_horizon(scheme):
    program = program_of(PROBLEMS["plain"], SCHEMES[scheme])
    assert np.isclose(program.point_cost.sum(), 1.0)
