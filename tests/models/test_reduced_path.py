"""Claim: a path of the reduced model, smoothed and lifted, is a flight near it and a good guess."""

from __future__ import annotations

import numpy as np
import pytest
from craft import sample_vehicle
from scipy.interpolate import BSpline

import skyknot as sk
from skyknot.models import lift, lifted_path
from skyknot.models.reduced_path import _derivative, _knots, spline_basis

NAMES = ("x", "y", "z", "psi")


def test_the_basis_is_that_of_scipy_and_so_are_its_derivatives():
    t = _knots(0.0, 3.0, 0.5)
    x = np.linspace(0.0, 3.0, 50)
    expected = BSpline.design_matrix(x, t, 7).toarray()
    np.testing.assert_allclose(spline_basis(x, t, 7), expected, atol=1e-13)
    c = np.random.default_rng(0).normal(size=(expected.shape[1], 2))
    for order in range(5):
        exact = BSpline(t, c, 7).derivative(order)(x) if order else BSpline(t, c, 7)(x)
        found = _derivative(x, t, c, order)
        np.testing.assert_allclose(found, exact, atol=1e-10 * np.abs(exact).max())


def test_a_smooth_path_is_lifted_exactly():
    times = np.linspace(0.0, 2.0, 2001)
    s = np.polynomial.Polynomial([0, 0, 0, 0, 0.2, -0.08])
    flat = np.column_stack([s(times), 0.5 * s(times), -s(times), 0.3 * s(times)])
    # a Trajectory without segments is linear between nodes: 1 ms apart, 4e-7 of curvature is lost
    path = sk.Trajectory(times, flat, np.zeros((len(times), 1)), state_names=NAMES)
    found = lifted_path(sample_vehicle(), path)
    weights = np.array([1.0, 0.5, -1.0])
    jets = [s.deriv(order)(times)[:, None] * weights for order in range(5)]
    yaws = [0.3 * s.deriv(order)(times) for order in range(3)]
    states, controls = lift(sample_vehicle(), *jets, *yaws)
    np.testing.assert_allclose(found.states, states, atol=2e-3)
    np.testing.assert_allclose(found.controls[:, 0], controls[:, 0], rtol=2e-3)


def test_the_lift_of_the_reduced_solution_leads_to_the_optimum_of_the_full_problem():
    craft = sk.vehicles.load("hummingbird")
    reduced, full = craft.translational_yaw_model(), craft.wrench_model()
    asked = {"horizon": 4.0, "vehicle": craft}
    simple = sk.Problem(
        name="simple", states=reduced.state_names, controls=reduced.control_names,
        dynamics=reduced.dynamics, initial=[0.0] * 7, final=[4, 2, -1, 0, 0, 0, 0.5],
        running_cost=lambda x, u: sum(u[i] ** 2 for i in range(4)), **asked,
    )  # fmt: skip
    whole = sk.Problem(
        name="whole", states=full.state_names, controls=full.control_names,
        dynamics=full.dynamics, initial=[0.0] * 12, final=[4, 2, -1] + [0] * 5 + [0.5, 0, 0, 0],
        running_cost=lambda x, u: (u[0] - craft.hover[0]) ** 2
        + 1e3 * sum(u[i] ** 2 for i in (1, 2, 3)), **asked,
    )  # fmt: skip
    quick = sk.solve(simple, sk.HermiteSimpson(40))
    guess = lifted_path(craft, quick.trajectory)
    from_lift = sk.solve(whole, sk.HermiteSimpson(40), guess=guess)
    from_ladder = sk.solve(whole, sk.HermiteSimpson(40))
    assert np.abs(guess.states[:, :3] - quick.states[:, :3]).max() < 0.05
    assert from_lift.success
    assert from_lift.objective == pytest.approx(from_ladder.objective, rel=1e-6)


def test_a_path_without_position_and_yaw_is_refused_in_five_parts():
    path = sk.Trajectory([0.0, 1.0], np.zeros((2, 2)), np.zeros((2, 1)), state_names=("x", "v"))
    with pytest.raises(sk.UserError, match="does not tell position and yaw") as caught:
        lifted_path(sample_vehicle(), path)
    assert caught.value.found == "x, v"
    assert all(part.strip() for part in caught.value.parts().values())
