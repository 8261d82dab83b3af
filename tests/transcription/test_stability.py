"""Claim: stability functions, regions and tests are those of the textbooks, from the tables alone.

Legend: z = hλ, R(z) = x_{k+1}/x_k on ẋ = λx; P, Q numerator and denominator of R; E(y) = |Q(iy)|² −
|P(iy)|², whose sign decides on the imaginary axis (Hairer & Wanner II, IV.3).
"""

from __future__ import annotations

from math import factorial

import numpy as np
import pytest
from numpy.polynomial import Polynomial

import skyknot as sk
from skyknot.transcription.collocation import chebyshev, lobatto, radau
from skyknot.transcription.schemes import EULER, HERMITE_SIMPSON, SCHEMES, TRAPEZOID

TABLES = {
    **SCHEMES,
    **{f"lobatto {s}": lobatto(s) for s in (2, 4, 6, 9)},
    **{f"radau {s}": radau(s) for s in (1, 2, 3, 7)},
    **{f"chebyshev {s}": chebyshev(s) for s in (4, 6, 7, 10)},
}
# Lobatto IIIA is the diagonal Padé approximant of exp, Radau IIA the first below it
PADE = {"lobatto": (lobatto, 1, 1), "radau": (radau, 1, 0)}


def pade(k, m):
    """Return numerator and denominator of the (k, m) Padé approximant: H. & W. II, (IV.3.30)."""
    above = [
        factorial(k) * factorial(k + m - j) / factorial(k - j) / factorial(k + m) / factorial(j)
        for j in range(k + 1)
    ]
    below = [
        (-1) ** j * factorial(m) * factorial(k + m - j) / factorial(m - j) / factorial(k + m)
        / factorial(j)
        for j in range(m + 1)
    ]  # fmt: skip
    return np.array(above), np.array(below)


@pytest.mark.parametrize("s", [2, 3, 4, 5, 8])
@pytest.mark.parametrize("family", PADE)
def test_lobatto_and_radau_are_the_pade_approximants_of_the_exponential(family, s):
    make, less_above, less_below = PADE[family]
    found = make(s).stability
    above, below = pade(s - less_above, s - less_below)
    np.testing.assert_allclose(found.numerator, above, rtol=1e-9)
    np.testing.assert_allclose(found.denominator, below, rtol=1e-9)
    z = np.array([0.3, -2.0, 4j, -7.0 + 3j, -50.0])
    powers = z[:, None] ** np.arange(s + 1)
    expected = powers[:, : len(above)] @ above / (powers[:, : len(below)] @ below)
    np.testing.assert_allclose(found(z), expected, rtol=1e-10)


def test_the_functions_of_the_small_schemes_are_the_known_ones():
    euler, hermite = sk.stability("euler"), sk.stability(HERMITE_SIMPSON)
    np.testing.assert_allclose(euler.numerator, [1, 1])
    np.testing.assert_allclose(euler.denominator, [1])
    np.testing.assert_allclose(hermite.numerator, [1, 1 / 2, 1 / 12])
    np.testing.assert_allclose(hermite.denominator, [1, -1 / 2, 1 / 12])
    roots = sorted(hermite.poles, key=np.imag)
    np.testing.assert_allclose(roots, [3 - 3**0.5 * 1j, 3 + 3**0.5 * 1j])
    np.testing.assert_allclose(sorted(hermite.zeros, key=np.imag), -np.conj(roots))


@pytest.mark.parametrize("name", TABLES)
def test_the_rational_function_is_the_step_of_the_rows(name):
    found, z = TABLES[name].stability, np.array([0.1, -1.0, 3j, -4 + 2j])
    above, below = Polynomial(found.numerator), Polynomial(found.denominator)
    np.testing.assert_allclose(above(z) / below(z), found(z), rtol=1e-8, atol=1e-12)
    assert found(0.0) == pytest.approx(1.0)
    assert np.all(abs(found(found.poles)) > 1e5)


@pytest.mark.parametrize("name", TABLES)
def test_a_stability_is_what_the_exact_test_on_the_axis_says(name):
    """E(y) has no negative coefficient, up to rounding, and no pole lies on the left."""
    found = TABLES[name].stability
    axis = [Polynomial(each * 1j ** np.arange(len(each))) for each in
            (found.denominator, found.numerator)]  # fmt: skip
    squares = [(each * Polynomial(np.conj(each.coef))).coef.real for each in axis]
    size = max(len(each) for each in squares)
    Q, P = (np.pad(each, (0, size - len(each))) for each in squares)
    nonnegative = np.all(np.maximum(np.abs(Q), np.abs(P)) * 1e-9 + Q >= P)
    assert found.a_stable == bool(nonnegative and np.all(found.poles.real > 0))
    assert found.a_stable == (name != "euler")
    assert found.l_stable == name.startswith("radau")


@pytest.mark.parametrize("s", [20, 40, 100])
@pytest.mark.parametrize("make", [lobatto, radau, chebyshev])
def test_many_points_are_a_stable_too(make, s):
    found = make(s).stability
    assert found.a_stable
    assert found.l_stable == (make is radau)
    assert found(-2.0 + 5j) == pytest.approx(np.exp(-2.0 + 5j), rel=1e-11)


@pytest.mark.parametrize(
    ("table", "limit"),
    [
        (EULER, np.inf),
        (TRAPEZOID, -1.0),
        (HERMITE_SIMPSON, 1.0),
        (lobatto(4), -1.0),
        (radau(3), 0.0),
    ],
)
def test_stiff_modes_end_where_they_should(table, limit):
    found = table.stability
    assert found.at_infinity == pytest.approx(limit, abs=1e-12)
    if np.isfinite(limit):
        assert found(-1e9).real == pytest.approx(limit, abs=1e-7)


def test_symmetric_schemes_neither_damp_nor_feed_an_oscillation():
    for table in (TRAPEZOID, HERMITE_SIMPSON, lobatto(5), chebyshev(6)):
        np.testing.assert_allclose(abs(table.stability(1j * np.geomspace(1e-2, 1e4, 50))), 1)
    assert abs(radau(3).stability(5j)) < 0.999


def test_the_region_of_eulers_scheme_is_the_disc_around_minus_one():
    real, imaginary = np.linspace(-3, 1, 41), np.linspace(-2, 2, 31)
    size = sk.stability(sk.Euler(3)).region(real, imaginary)
    assert size.shape == (31, 41)
    disc = np.hypot(real[None, :] + 1, imaginary[:, None])
    np.testing.assert_allclose(size, disc, atol=1e-12)


def test_a_table_with_a_pole_on_the_left_is_not_a_stable():
    """One theta step with θ < ½ fails on the axis; a mirrored Radau has its poles on the left."""
    theta = sk.stability("trapezoid").__class__(np.array([[1.0, -1.0]]), np.array([[0.6, 0.4]]))
    assert theta.axis_excess > 0.4
    assert not theta.a_stable
    mirrored = theta.__class__(np.array([[1.0, -1.0]]), np.array([[0.0, -1.0]]))
    assert mirrored.poles[0] == pytest.approx(-1.0)
    assert mirrored.axis_excess <= 0
    assert not mirrored.a_stable


def test_the_first_error_term_of_hermite_simpson_is_a_720th():
    """exp(z) − R(z) = z⁵/720 + O(z⁶)."""
    z = 1e-2
    assert (np.exp(z) - sk.stability("hermite-simpson")(z).real) / z**5 == pytest.approx(
        1 / 720, rel=1e-2
    )


def test_an_unknown_name_is_told():
    with pytest.raises(sk.UserError, match="no scheme of this name") as caught:
        sk.stability("simpson")
    assert "'hermite-simpson'" in caught.value.expected


def test_the_iteration_matrix_tells_which_fixed_steps_converge():
    random = np.random.default_rng(3)
    rotation = np.linalg.qr(random.normal(size=(6, 6)))[0]
    eigenvalues = np.array([0.5, 1.0, 2.0, 3.0, 7.0, 10.0])
    H = rotation @ np.diag(eigenvalues) @ rotation.T
    for alpha, bounded in ((0.19, True), (0.21, False)):
        norm = sk.iteration_matrix_norm(H, alpha)
        assert norm == pytest.approx(np.linalg.norm(np.eye(6) - alpha * H, 2))
        assert norm == pytest.approx(sk.iteration_matrix_norm(eigenvalues, alpha))
        assert (norm < 1) == bounded
        z = random.normal(size=6)
        start = np.linalg.norm(z)
        for _ in range(400):
            z = z - alpha * (H @ z)
        assert (np.linalg.norm(z) < start) == bounded
    assert sk.iteration_matrix_norm(-eigenvalues, 0.1) > 1
