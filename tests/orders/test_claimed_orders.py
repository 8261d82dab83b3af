"""Claim: every scheme, with every kind of control, has the orders its table claims, ± 0.15.

States and costates at the nodes, controls at the scheme's own points, on a linear–quadratic problem
and on the same one seen through sinh, where no scheme is linear; three meshes each. The tables are
measured by the function that writes docs/schemes.md; its closed forms are checked here first.
"""

from __future__ import annotations

from math import factorial

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from skyknot.bench import smooth_problems
from skyknot.bench.observed_orders import QUANTITIES, Case, cases, decay, observed

PROBLEMS = {
    "linear": smooth_problems.linear(),
    "curved": smooth_problems.curved(),
    "mayer": smooth_problems.mayer(),
}
CASES = {f"{c.scheme} {c.points or ''} {c.controls}": c for c in cases()}
# On linear dynamics the costates do not feel the control that two segments share.
BETTER_THAN_CLAIMED = {("linear", "lobatto 4 polynomial", "costates")}
# What double precision leaves no room to show.
UNSEEN = {
    ("linear", "lobatto 5 polynomial", "costates"),
    ("linear", "lobatto 5 discontinuous", "states"),
    *(("curved", "radau 4 polynomial", quantity) for quantity in QUANTITIES),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_closed_forms_satisfy_the_conditions_of_optimality(name):
    """ẋ = ∂H/∂p, ṗ = −∂H/∂x, ∂H/∂u = 0, p(T) = ∂M/∂x, by CasADi's derivatives of the problem."""
    smooth = PROBLEMS[name]
    problem, T = smooth.problem, smooth.problem.duration_guess
    x, u, p, t = (ca.SX.sym(n) for n in "xupt")
    H = ca.SX(problem.running_cost_of(x, u, None, t)) + p * ca.vertcat(
        problem.rates_of(x, u, None, t)
    )
    slopes = ca.Function("slopes", [x, u, p], [ca.gradient(H, v) for v in (p, x, u)])
    M = ca.Function("M", [x], [ca.gradient(ca.SX(problem.terminal_cost_of(x, None, T)), x)])
    for at in np.linspace(0.1, T - 0.1, 7):
        step = np.array([at - 1e-4, at, at + 1e-4])
        X, U, P = smooth.state(step), smooth.control(step), smooth.costate(step)
        rate, pull, stationary = (float(v) for v in slopes(X[1], U[1], P[1]))
        assert rate == pytest.approx((X[2] - X[0]) / 2e-4, rel=1e-6)
        assert -pull == pytest.approx((P[2] - P[0]) / 2e-4, rel=1e-6, abs=1e-9)
        assert stationary == pytest.approx(0.0, abs=1e-12)
    last = np.array([T])
    assert float(M(smooth.state(last))) == pytest.approx(smooth.costate(last)[0], abs=1e-12)
    assert smooth.state(np.zeros(1))[0] == pytest.approx(problem.initial_lower[0])


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("problem", ["linear", "curved"])
def test_observed_orders_are_the_claimed_ones(problem, name):
    case = CASES[name]
    found = observed(case, PROBLEMS[problem])
    for quantity in QUANTITIES:
        place = (problem, name, quantity)
        assert (quantity in found) == (place not in UNSEEN), place
        if quantity not in found:
            continue
        claimed = getattr(case.claimed, quantity)
        if place in BETTER_THAN_CLAIMED:
            assert found[quantity] > claimed + 0.5
        else:
            assert found[quantity] == pytest.approx(claimed, abs=0.15), place


@pytest.mark.parametrize(
    ("case", "order", "meshes"),
    [
        (Case("hermite-simpson", None, "quadratic"), 2, (60, 90, 135)),
        (Case("lobatto", 4, "polynomial"), 3, (40, 60, 90)),
        (Case("lobatto", 5, "discontinuous"), 4, (24, 36, 54)),
        (Case("radau", 3, "polynomial"), 3, (40, 60, 90)),
        (Case("chebyshev", 5, "polynomial"), 2, (60, 90, 135)),
        (Case("chebyshev", 6, "polynomial"), 1, (60, 90, 135)),
    ],
    ids=str,
)
def test_interior_costates_have_the_order_of_the_stages(case, order, meshes):
    """Lobatto IIIB s − 1, Radau IA s; Chebyshev's adjoint is exact for constants at most."""
    smooth, errors = PROBLEMS["curved"], []
    for N in meshes:
        solution = sk.solve(smooth.problem, case.on(N), guess=smooth.guess, tolerance=1e-13)
        inside = solution.trajectory.segments.interior_points
        t = solution.times[:-1, None] + np.diff(solution.times)[:, None] * inside
        errors.append(np.abs(solution.interior_costates[..., 0] - smooth.costate(t)).max())
    observed_order = -np.polyfit(np.log(meshes), np.log(errors), 1)[0]
    assert observed_order == pytest.approx(order, abs=0.15)


def test_one_long_segment_reaches_1e_10_with_fewer_than_forty_points():
    for scheme in ("lobatto", "radau", "chebyshev"):
        assert decay(scheme, PROBLEMS["mayer"], (22,))[0, :2].max() < 1e-10
    for scheme in ("lobatto", "radau"):
        assert decay(scheme, PROBLEMS["mayer"], (22,)).max() < 1e-10
        assert decay(scheme, PROBLEMS["linear"], (16,)).max() < 1e-10
        assert decay(scheme, PROBLEMS["curved"], (30,)).max() < 1e-10


def test_the_error_of_an_entire_optimum_decays_as_equation_29_says():
    """C Mᴺ/N! with M = ωT/4: what N points leave of e^(±ωt), ω = 3/2, over the horizon T."""
    points = tuple(range(4, 15))
    M = 1.5 * PROBLEMS["linear"].problem.duration_guess / 4
    bound = np.array([M**n / factorial(n) for n in points])
    for scheme in ("lobatto", "radau"):
        states, controls, costates = (decay(scheme, PROBLEMS["linear"], points) / bound[:, None]).T
        assert states.max() < 1
        assert max(controls.max(), costates.max()) < 50
    states = decay("lobatto", PROBLEMS["linear"], points)[:, 0] / bound
    assert states.min() > 0.1  # the bound is sharp: not only below it, but as fast as it


def test_a_pole_near_the_horizon_makes_the_decay_geometric():
    """ρ^−N with ρ of the ellipse through the pole (Trefethen, ATAP, theorem 8.2): (29) is for
    optima without poles, its M^N/N! falls faster than any ρ^−N.
    """
    pole = (-np.log(3) + 1j * np.pi) / 2.5 - 1.0  # on [−1, 1]
    rho = max(abs(pole + sign * np.sqrt(pole**2 - 1)) for sign in (1, -1))
    points = np.arange(8, 23)
    for scheme in ("lobatto", "radau", "chebyshev"):
        scaled = decay(scheme, PROBLEMS["mayer"], tuple(points))[:, 0] * rho**points
        assert scaled.max() < 20
        assert scaled.min() > 0.1


def test_clenshaw_curtis_weights_leave_algebraic_decay_where_the_control_needs_the_costate():
    points = (9, 17, 33)
    found = decay("chebyshev", PROBLEMS["linear"], points)
    slopes = -np.diff(np.log(found[:, 1])) / np.diff(np.log(points))
    assert np.all(slopes < 4)
    assert found[-1, 1] > 1e-5
    assert decay("lobatto", PROBLEMS["linear"], points)[-1, 1] < 1e-11
