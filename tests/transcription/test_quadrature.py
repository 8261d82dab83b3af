"""Claim: points and weights integrate what they should, for few points and for a hundred.

Legend: c points in [0, 1], b weights; the integral of τ^q is 1/(q + 1).
"""

from __future__ import annotations

import numpy as np
import pytest

from skyknot.transcription import quadrature

RULES = {
    "lobatto": (quadrature.lobatto, 2, lambda s: 2 * s - 3),
    "radau": (quadrature.radau, 1, lambda s: 2 * s - 2),
    "chebyshev": (quadrature.chebyshev, 2, lambda s: s - 1 + s % 2),
}
COUNTS = (1, 2, 3, 4, 5, 8, 13, 20, 33, 40, 64, 100)
CASES = [(name, s) for name, (_, least, _) in RULES.items() for s in COUNTS if s >= least]


@pytest.mark.parametrize(("name", "s"), CASES)
def test_powers_up_to_the_degree_are_integrated_exactly(name, s):
    make, _, degree = RULES[name]
    c, b = make(s)
    q = np.arange(degree(s) + 1)
    np.testing.assert_allclose((c[:, None] ** q).T @ b, 1 / (q + 1), atol=2e-14)
    if s <= 8:
        beyond = degree(s) + 1
        assert abs(b @ c**beyond - 1 / (beyond + 1)) > 1e-10


@pytest.mark.parametrize(("name", "s"), CASES)
def test_points_increase_to_the_end_and_weights_are_positive(name, s):
    c, b = RULES[name][0](s)
    assert c[-1] == 1.0
    assert np.all(np.diff(c) > 0)
    assert np.all(b > 0)
    if name == "radau":
        assert c[0] > 0
    else:
        assert c[0] == 0.0
        np.testing.assert_allclose(c + c[::-1], 1, atol=1e-16)
        np.testing.assert_allclose(b, b[::-1], rtol=1e-12)


@pytest.mark.parametrize("s", [10, 40, 100])
def test_points_are_the_zeros_they_are_defined_by(s):
    """Legendre series of NumPy, and Chebyshev's cosines, are the second road."""
    P = np.polynomial.legendre.Legendre.basis
    slope, sum_of_two = P(s - 1).deriv(), P(s) - P(s - 1)
    inner = 2 * quadrature.lobatto(s)[0][1:-1] - 1
    step = slope(inner) / slope.deriv()(inner)
    np.testing.assert_allclose(step, 0, atol=1e-13)
    ends = 2 * quadrature.radau(s)[0] - 1
    np.testing.assert_allclose(sum_of_two(ends) / sum_of_two.deriv()(ends), 0, atol=1e-13)
    cosines = 0.5 * (1 - np.cos(np.pi * np.arange(s) / (s - 1)))
    np.testing.assert_allclose(quadrature.chebyshev(s)[0], cosines, atol=1e-15)


def test_few_points_are_the_known_ones():
    # Abramowitz & Stegun, table 25.6, and Hairer & Wanner, Solving ODEs II, table IV.5.5
    c, b = quadrature.lobatto(4)
    np.testing.assert_allclose(c, [0, (5 - 5**0.5) / 10, (5 + 5**0.5) / 10, 1], atol=1e-15)
    np.testing.assert_allclose(b, [1 / 12, 5 / 12, 5 / 12, 1 / 12], atol=1e-15)
    c, b = quadrature.radau(3)
    np.testing.assert_allclose(c, [(4 - 6**0.5) / 10, (4 + 6**0.5) / 10, 1], atol=1e-15)
    np.testing.assert_allclose(b, [(16 - 6**0.5) / 36, (16 + 6**0.5) / 36, 1 / 9], atol=1e-15)
    c, b = quadrature.chebyshev(5)
    np.testing.assert_allclose(b, np.array([1, 8, 12, 8, 1]) / 30, atol=1e-15)


@pytest.mark.parametrize("name", RULES)
def test_an_analytic_function_is_integrated_to_rounding_with_forty_points(name):
    c, b = RULES[name][0](40)
    assert b @ np.exp(3 * c) == pytest.approx((np.exp(3) - 1) / 3, rel=1e-14)
