"""Claim: a bound on du/dt holds at every time, not only where the rows stand."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest

import skyknot as sk
from skyknot.transcription import quadrature
from skyknot.transcription.rates import derivative_weights, enclosing_weights


def swing(rates, **extras):
    asked = {
        "name": "swing",
        "states": ["x", "v"],
        "controls": ["a", "b"],
        "dynamics": lambda x, u: [x[1], u[0] + 0.2 * u[1]],
        "horizon": 2.0,
        "initial": [0.0, 0.0],
        "final": [1.0, 0.0],
        "running_cost": lambda x, u: u[0] ** 2 + u[1] ** 2,
        "rates": rates,
    }
    return sk.Problem(**(asked | extras))


def fastest(solution, column=0):
    """Return least and greatest slope of a control, densely inside every segment."""
    slopes = []
    for left, right in zip(solution.times[:-1], solution.times[1:], strict=True):
        t = np.linspace(left, right, 41)[1:-1]
        slopes.append(np.diff(solution.control(t)[:, column]) / np.diff(t))
    return np.min(slopes), np.max(slopes)


MESH = np.array([0.0, 0.1, 0.15, 0.5, 0.6, 0.9, 1.0])
CURVED = {
    "linear": lambda mesh: sk.Trapezoid(mesh=mesh),
    "quadratic": lambda mesh: sk.HermiteSimpson(mesh=mesh),
    "compressed": lambda mesh: sk.HermiteSimpson(mesh=mesh, form="compressed"),
    "averaged": lambda mesh: sk.HermiteSimpson(mesh=mesh, controls="linear"),
}


@pytest.mark.parametrize("scheme", CURVED)
@pytest.mark.parametrize("horizon", [2.0, sk.Free(1.5, 2.5, 2.0)], ids=["fixed", "free"])
def test_the_slope_of_the_control_stays_within_its_bounds_everywhere(scheme, horizon):
    free = sk.solve(swing(None, horizon=horizon), CURVED[scheme](MESH), tolerance=1e-9)
    bound = 0.7 * max(np.abs(fastest(free)))
    bounded = sk.solve(swing([bound, None], horizon=horizon), CURVED[scheme](MESH), tolerance=1e-9)
    assert bounded.success
    assert max(np.abs(fastest(bounded))) == pytest.approx(bound, abs=1e-6)
    assert bounded.objective > free.objective


LONGER = {
    "lobatto": lambda mesh: sk.Lobatto(mesh=mesh, points=4),
    "lobatto, one segment": lambda mesh: sk.Lobatto(1, 12),
    "lobatto, one long segment": lambda mesh: sk.Lobatto(1, 20),
    "chebyshev": lambda mesh: sk.Chebyshev(mesh=mesh, points=6),
    "radau, linear": lambda mesh: sk.Radau(mesh=mesh, points=3, controls="linear"),
}


@pytest.mark.parametrize("scheme", LONGER)
@pytest.mark.parametrize("horizon", [2.0, sk.Free(1.5, 2.5, 2.0)], ids=["fixed", "free"])
def test_the_slope_of_longer_polynomials_stays_within_its_bounds_too(scheme, horizon):
    free = sk.solve(swing(None, horizon=horizon), LONGER[scheme](MESH), tolerance=1e-9)
    bound = 0.7 * max(np.abs(fastest(free)))
    bounded = sk.solve(swing([bound, None], horizon=horizon), LONGER[scheme](MESH), tolerance=1e-9)
    assert bounded.success
    # more than MOST_ENCLOSED values are sampled densely, not enclosed
    slack = 1e-4 if "long segment" in scheme else 1e-7
    assert max(np.abs(fastest(bounded))) < bound * (1 + slack)
    # what encloses gives something away, the more the higher the degree
    assert max(np.abs(fastest(bounded))) > 0.75 * bound
    assert bounded.objective > free.objective


@pytest.mark.parametrize("count", [2, 3, 4, 5, 8, 12, 16])
def test_the_enclosing_rows_are_bernstein_coefficients_of_the_rate(count):
    """Σ_j c_j B_j = u', Σ_j B_j = 1, B_j ≥ 0: the rate lies between least and greatest c_j."""
    points = quadrature.lobatto(count)[0]
    values = np.random.default_rng(count).normal(size=count)
    c, tau, n = enclosing_weights(points) @ values, np.linspace(0, 1, 101), count - 2
    basis = np.array([comb(n, j) * tau**j * (1 - tau) ** (n - j) for j in range(n + 1)])
    rate = derivative_weights(points, tau) @ values
    np.testing.assert_allclose(c @ basis, rate, atol=1e-9 * np.abs(c).max())
    assert c.min() - 1e-9 <= rate.min()
    assert rate.max() <= c.max() + 1e-9


@pytest.mark.parametrize("scheme", [sk.Radau(4, 3), sk.Lobatto(4, 4, controls="discontinuous")])
def test_a_rate_cannot_bound_what_may_jump(scheme):
    with pytest.raises(sk.UserError, match="no rate there to bound") as caught:
        sk.solve(swing([1.0, None]), scheme)
    assert "a" in caught.value.found
    assert "linear" in caught.value.do


@pytest.mark.parametrize("scheme", CURVED)
def test_each_side_and_each_control_has_its_own_bound(scheme):
    problem = swing(([-1.0, None], [None, 0.1]))
    solution = sk.solve(problem, CURVED[scheme](MESH), tolerance=1e-9)
    assert fastest(solution, 0)[0] >= -1.0 - 1e-6
    assert fastest(solution, 1)[1] <= 0.1 + 1e-6


@pytest.mark.parametrize(
    "scheme",
    [
        sk.Euler,
        lambda mesh: sk.Trapezoid(mesh=mesh, controls="hold"),
        lambda mesh: sk.HermiteSimpson(mesh=mesh, controls="hold"),
    ],
    ids=["euler", "trapezoid", "hermite-simpson"],
)
def test_a_held_control_jumps_no_more_than_its_rate_allows(scheme):
    transcription = sk.Euler(mesh=MESH) if scheme is sk.Euler else scheme(MESH)
    solution = sk.solve(swing([1.0, None]), transcription, tolerance=1e-9)
    middles = 0.5 * (solution.times[1:] + solution.times[:-1])
    jumps = np.abs(np.diff(solution.controls[:-1, 0])) / np.diff(middles)
    assert jumps.max() <= 1.0 + 1e-6
    assert jumps.max() > 0.95


def test_derivative_weights_differentiate_polynomials():
    points, places = np.array([0.0, 0.3, 0.8, 1.0]), np.array([0.0, 0.5, 1.0])
    W = derivative_weights(points, places)
    for q in range(1, 4):
        np.testing.assert_allclose(W @ points**q, q * places ** (q - 1), atol=1e-12)
    np.testing.assert_allclose(W.sum(axis=1), 0, atol=1e-12)


def test_derivative_weights_are_stable_for_many_points():
    points = np.sin(0.5 * np.pi * np.arange(40) / 39) ** 2
    np.testing.assert_allclose(
        derivative_weights(points, points) @ np.sin(3 * points), 3 * np.cos(3 * points), atol=1e-10
    )


def test_without_rates_there_are_no_rows():
    program = sk.HermiteSimpson(3).program(swing(None), sk.initial_guess(swing(None))[0])
    assert len(program.rates.length) == 0
