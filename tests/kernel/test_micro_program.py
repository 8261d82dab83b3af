"""Claim: micro programs solve sparse systems, eight at a time, with what their pattern needs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from skyknot.kernel import native

LANES = 8


def systems(n: int, density: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return (n, n, 8) matrices of one random pattern, heavy on the diagonal, and right sides."""
    random = np.random.default_rng(seed)
    pattern = random.random((n, n)) < density
    M = np.where(pattern[..., None], random.normal(size=(n, n, LANES)), 0.0)
    sign = np.where(random.random((n, LANES)) < 0.5, -1.0, 1.0)
    M[np.arange(n), np.arange(n)] = sign * (1.0 + np.abs(M).sum(axis=1))
    return M, random.normal(size=(n, LANES))


@given(
    st.integers(1, 24), st.sampled_from([0.0, 0.1, 0.3, 1.0]), st.integers(0, 10**6), st.booleans()
)
def test_every_lane_solves_its_own_system(n: int, density: float, seed: int, turned: bool) -> None:
    M, right = systems(n, density, seed)
    found, _ = native.solve_lanes(M, right, turned)
    for lane in range(LANES):
        matrix = M[..., lane].T if turned else M[..., lane]
        expected = np.linalg.solve(matrix, right[:, lane])
        np.testing.assert_allclose(found[:, lane], expected, rtol=1e-12, atol=1e-13)


def test_a_diagonal_system_costs_one_product_an_unknown() -> None:
    M, right = systems(10, 0.0, 1)
    assert native.solve_lanes(M, right)[1] == 10


def test_elimination_order_keeps_an_arrow_sparse() -> None:
    """An arrow pointing at its first entry fills up unless that entry is eliminated last."""
    n = 20
    M = np.zeros((n, n, LANES))
    M[np.arange(n), np.arange(n)] = 30.0
    M[0, :] = M[:, 0] = 1.0
    M[0, 0] = 30.0
    assert native.solve_lanes(M, np.ones((n, LANES)))[1] < 8 * n


def test_a_lane_without_a_number_leaves_the_others_alone() -> None:
    M, right = systems(6, 0.5, 2)
    clean, _ = native.solve_lanes(M, right)
    M[2, 2, 3] = np.nan
    found, _ = native.solve_lanes(M, right)
    others = np.arange(LANES) != 3
    np.testing.assert_array_equal(found[:, others], clean[:, others])
    assert np.isnan(found[:, 3]).any()


def test_shapes_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match=r"right-hand sides \(n, 8\) expected"):
        native.solve_lanes(np.ones((2, 2, LANES)), np.ones((3, LANES)))
