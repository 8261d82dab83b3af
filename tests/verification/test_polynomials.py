"""Claim: polynomials inside a segment are read to rounding, however many points it has."""

import numpy as np
import pytest

from skyknot.verification import polynomials


def lobatto_like(n):
    """Return Chebyshev–Gauss–Lobatto points on [0, 1]."""
    return 0.5 - 0.5 * np.cos(np.pi * np.arange(n) / (n - 1))


@pytest.mark.parametrize("n", [2, 3, 8, 41])
def test_values_slopes_and_integrals_of_a_sine(n):
    points, places = lobatto_like(n), np.linspace(0, 1, 17)
    C = polynomials.coefficients(points, np.sin(points)[None, :, None])
    allowed = {2: 0.2, 3: 3e-2, 8: 1e-8, 41: 1e-12}[n]
    assert np.allclose(polynomials.evaluated(C, places)[0, :, 0], np.sin(places), atol=allowed)
    slope = polynomials.evaluated(polynomials.differentiated(C), places)[0, :, 0]
    assert np.allclose(slope, np.cos(places), atol=20 * allowed)
    area = polynomials.evaluated(polynomials.integrated(C), places)[0, :, 0]
    assert np.allclose(area, 1 - np.cos(places), atol=allowed)


def test_cardinal_weights_return_the_values_at_the_points_themselves():
    points = lobatto_like(30)
    assert np.allclose(polynomials.cardinal(points, points), np.eye(30), atol=1e-12)


def test_a_constant_has_no_slope():
    C = polynomials.coefficients(np.array([0.0]), np.full((2, 1, 3), 7.0))
    assert np.all(polynomials.differentiated(C) == 0)
    assert polynomials.evaluated(C, np.array([0.3])).tolist() == [[[7.0] * 3]] * 2
