"""Claim: Barzilai–Borwein lengths and the stability test (15) agree with known spectra."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from skyknot.solvers.step_size import (
    LONGEST,
    barzilai_borwein,
    cauchy_length,
    spectral_norm,
)

seeds = st.integers(0, 2**32 - 1)


def symmetric(seed: int, eigenvalues: np.ndarray) -> np.ndarray:
    """Return a symmetric matrix of known spectrum."""
    rotation = np.linalg.qr(np.random.default_rng(seed).normal(size=(len(eigenvalues),) * 2))[0]
    return rotation @ np.diag(eigenvalues) @ rotation.T


@given(seeds)
def test_the_length_is_the_inverse_of_a_value_inside_the_spectrum(seed):
    H = symmetric(seed, np.array([0.5, 1.0, 3.0, 40.0]))
    s = np.random.default_rng(seed).normal(size=4)
    assert 1 / 40 <= barzilai_borwein(s, H @ s, s, 1.0) * (1 + 1e-12) <= 2 * (1 + 2e-12)


@pytest.mark.parametrize("value", [0.25, 1.0, 17.0])
def test_along_an_eigenvector_it_is_the_inverse_of_the_eigenvalue(value):
    H = symmetric(3, np.array([value, 2.0, 5.0]))
    eigenvector = np.linalg.eigh(H)[1][:, np.argmin(np.abs(np.linalg.eigvalsh(H) - value))]
    found = barzilai_borwein(eigenvector, H @ eigenvector, eigenvector, 1.0)
    assert found == pytest.approx(1 / value, rel=1e-12)


@given(seeds)
def test_in_the_metric_of_the_hessian_it_is_one(seed):
    H = symmetric(seed, np.array([0.1, 7.0, 200.0]))
    s = np.random.default_rng(seed).normal(size=3)
    assert barzilai_borwein(s, H @ s, H @ s, 0.3) == pytest.approx(1.0, rel=1e-12)


def test_without_positive_curvature_it_grows_tenfold_up_to_a_limit():
    s = np.array([1.0, 0.0])
    assert barzilai_borwein(s, -s, s, 0.2) == 2.0
    assert barzilai_borwein(s, 0 * s, s, LONGEST) == LONGEST


def test_it_solves_a_quadratic_that_a_stable_fixed_step_hardly_moves():
    eigenvalues = np.geomspace(1.0, 1e3, 12)
    H, b = symmetric(5, eigenvalues), np.ones(12)
    exact = np.linalg.solve(H, b)

    def error(length):
        x, alpha, last = np.zeros(12), 1e-3, None
        for _ in range(500):
            gradient = H @ x - b
            if last is not None:
                alpha = length(x - last[0], gradient - last[1], alpha)
            last = x, gradient
            x = x - alpha * gradient
        return np.linalg.norm(x - exact) / np.linalg.norm(exact)

    assert error(lambda s, y, alpha: barzilai_borwein(s, y, s, alpha)) < 1e-6
    assert error(lambda _s, _y, _alpha: 1e-3) > 1e-2


def test_the_cauchy_length_minimises_a_quadratic_along_a_line():
    H = symmetric(8, np.array([1.0, 4.0, 9.0]))
    g = np.array([1.0, -2.0, 0.5])
    alpha = cauchy_length(g, g, H @ g)
    assert g @ (g - alpha * H @ g) == pytest.approx(0.0, abs=1e-12)


@given(seeds, st.floats(1e-3, 2.0))
def test_the_norm_of_equation_15_is_the_largest_eigenvalue(seed, alpha):
    random = np.random.default_rng(seed)
    H = symmetric(seed, random.uniform(-1.0, 4.0, size=5))
    M = symmetric(seed + 1, random.uniform(0.5, 2.0, size=5))
    relative = np.linalg.eigvals(np.linalg.solve(M, H)).real
    found = spectral_norm(
        lambda v: np.linalg.solve(M, H @ v),
        lambda v: float(np.sqrt(v @ M @ v)),
        lambda v: v,
        random.normal(size=5),
        alpha,
        rounds=2000,
    )
    exact = np.max(np.abs(1 - alpha * relative))
    assert found <= exact * (1 + 1e-9)
    assert found >= exact * (1 - 1e-2)


def test_a_step_of_twice_the_inverse_eigenvalue_is_where_stability_ends():
    H = np.diag([1.0, 4.0])

    def norm(alpha):
        return spectral_norm(
            lambda v: H @ v,
            lambda v: float(np.linalg.norm(v)),
            lambda v: v,
            np.array([1.0, 1.0]),
            alpha,
            500,
        )

    assert norm(0.49) < 1.0 < norm(0.51)


def test_the_norm_is_taken_on_the_tangent_steps_alone():
    found = spectral_norm(
        lambda v: np.array([1.0, 4.0]) * v,
        lambda v: float(np.linalg.norm(v)),
        lambda v: np.array([1.0, 0.0]) * v,
        np.array([1.0, 1.0]),
        0.9,
    )
    assert found == pytest.approx(0.1)
