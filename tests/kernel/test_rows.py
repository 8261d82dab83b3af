"""Claim: rows keep what does not change, and what they keep is never another program's."""

from __future__ import annotations

import numpy as np
import pytest

from agreement.variants import PROBLEMS, SCHEMES, program_of
from skyknot.kernel.rows import Rows, tapes


def rows_of(program):
    """Return rows that know the sparsity of the path constraints."""
    rows = Rows(program)
    rows.structure(tapes(program, rows.path_scale).patterns)
    return rows


def assert_same_data(found, expected):
    """Assert that two packed programs agree to the bit."""
    assert found.keys() == expected.keys()
    for name, values in expected.items():
        tables = values if isinstance(values, list) else [values]
        for ours, theirs in zip(
            found[name] if isinstance(values, list) else [found[name]], tables, strict=True
        ):
            np.testing.assert_array_equal(ours, theirs, name)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_rows_of_other_numbers_are_those_made_anew(scheme):
    first = program_of(PROBLEMS["everything"], SCHEMES[scheme])
    kept = rows_of(first)
    kept.data(first.start)
    lower, upper = first.lower.copy(), first.upper.copy()
    upper[0] = lower[0] = 0.5 * (lower[0] + upper[0]) if np.isfinite(lower[0] + upper[0]) else 0.1
    upper[3] = lower[3] = first.start[3]
    other = first.with_numbers(lower=lower, upper=upper, start=first.start + 0.1)
    assert_same_data(kept.at(other).data(other.start), rows_of(other).data(other.start))
    assert_same_data(kept.data(first.start), rows_of(first).data(first.start))


def bounded(program, where, low, high):
    """Return the program with other bounds of some unknowns."""
    lower, upper = program.lower.copy(), program.upper.copy()
    lower[where], upper[where] = low, high
    return program.with_numbers(lower=lower, upper=upper)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_limits_are_kept_where_only_values_of_fixed_unknowns_differ(scheme):
    program = program_of(PROBLEMS["everything"], SCHEMES[scheme])
    state, end = slice(0, program.layout.nx), program.layout.globals
    one, other = (bounded(program, state, value, value) for value in (0.1, 0.2))
    kept = rows_of(one)
    assert kept.at(other).limits is kept.limits
    assert_same_data(kept.at(other).data(other.start), rows_of(other).data(other.start))
    for changed in (bounded(other, 1, 0.1, 0.2), bounded(other, end, 0.5, 0.5)):
        assert kept.at(changed).limits is not kept.limits
        here = rows_of(changed).data(changed.start)
        assert_same_data(kept.at(changed).data(changed.start), here)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_vector_survives_the_way_to_rows_and_back(scheme):
    program = program_of(PROBLEMS["everything"], SCHEMES[scheme])
    rows, z = rows_of(program), np.arange(program.layout.size, dtype=float)
    table = rows.to_rows(z, -1.0)
    assert np.all(table[~rows.here] == -1.0)
    np.testing.assert_array_equal(table.ravel()[rows.places], z[: program.layout.globals])
