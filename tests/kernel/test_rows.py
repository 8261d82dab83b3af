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


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_vector_survives_the_way_to_rows_and_back(scheme):
    program = program_of(PROBLEMS["everything"], SCHEMES[scheme])
    rows, z = rows_of(program), np.arange(program.layout.size, dtype=float)
    table = rows.to_rows(z, -1.0)
    assert np.all(table[~rows.here] == -1.0)
    np.testing.assert_array_equal(rows.from_rows(table, z[program.incidence.globals]), z)
