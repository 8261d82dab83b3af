"""Claim: a bound on du/dt holds at every time, not only where the rows stand."""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot.transcription.rates import derivative_weights


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
