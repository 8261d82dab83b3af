"""Claim: the entries that parts of a program read are spelled out once and summed in order."""

from __future__ import annotations

import numpy as np
import pytest

from agreement.variants import PROBLEMS, SCHEMES, program_of
from skyknot.kernel.evaluation import complete_fixed, evaluate, gradient
from skyknot.kernel.incidence import MOST_PARTS, summed


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


def test_a_program_at_other_parameters_has_functions_of_its_own():
    program = program_of(PROBLEMS["plain"], SCHEMES["hermite-simpson"])
    here = program.point, program.terminal
    there = program.with_parameters(program.parameters + 1.0)
    assert there.point is not here[0]
    assert there.terminal is not here[1]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_cost_weights_of_points_sum_to_the_horizon(scheme):
    program = program_of(PROBLEMS["plain"], SCHEMES[scheme])
    assert np.isclose(program.point_cost.sum(), 1.0)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("problem", ["everything", "free horizon"])
def test_multipliers_of_fixed_unknowns_are_those_of_all_points(problem, scheme):
    """Evaluated where a fixed unknown is read only, they are the same to the bit."""
    program = program_of(PROBLEMS[problem], SCHEMES[scheme])
    random = np.random.default_rng(7)
    m = program.empty_multipliers()
    for values in (m.defects, m.path, m.rates, m.bounds):
        values[...] = random.normal(size=values.shape)
    fixed = program.lower == program.upper
    assert fixed.any()
    complete_fixed(program, program.start, m)
    completed = m.bounds[fixed].copy()
    m.bounds[fixed] = 0.0
    whole = gradient(program, evaluate(program, program.start), m)
    np.testing.assert_array_equal(completed, -whole[fixed])


def test_parts_that_are_kept_are_few_and_those_of_their_own_mask():
    incidence = program_of(PROBLEMS["plain"], SCHEMES["hermite-simpson"]).incidence
    for i in range(3 * MOST_PARTS):
        mask = np.zeros(incidence.size, dtype=bool)
        mask[i] = True
        part = incidence.reading(mask)
        np.testing.assert_array_equal(part.entries, [i])
        assert incidence.reading(mask) is part
        assert len(incidence._parts) <= MOST_PARTS
