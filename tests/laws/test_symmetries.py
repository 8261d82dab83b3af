"""Claim: what physics leaves unchanged, the optimum leaves unchanged too.

Rotation about the vertical and translation of a quadrotor transfer, reversal of time, change of
units, and relaxation of a bound. Few examples, derandomised: each is a pair of solves.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import skyknot as sk
from skyknot import bank as problems

FEW = settings(max_examples=6)
MESH = sk.HermiteSimpson(10)
TIGHT = 1e-9


def transfer(start, displacement, yaw_start, yaw_turn):
    """Return the hover-to-hover transfer of the reference vehicle between other ends, solved."""
    reference = problems.quadrotor_transfer()
    first, last = np.zeros(12), np.zeros(12)
    first[:3], last[:3] = start, np.asarray(start) + displacement
    first[8], last[8] = yaw_start, yaw_start + yaw_turn
    problem = reference.problem
    problem.initial_lower = problem.initial_upper = first
    problem.final_lower = problem.final_upper = last
    hover = reference.guess.controls[0]
    guess = sk.Trajectory([0.0, 2.0], [first, last], [hover, hover])
    solution = sk.solve(problem, MESH, guess=guess, tolerance=TIGHT)
    assert solution.success, solution.message
    return solution


DISPLACEMENT, TURN = np.array([2.0, -1.0, -0.7]), 0.6


@pytest.fixture(scope="module")
def at_home():
    return transfer(np.zeros(3), DISPLACEMENT, 0.0, TURN)


@FEW
@given(angle=st.floats(-3.0, 3.0))
def test_rotation_about_the_vertical_changes_nothing(at_home, angle):
    cosine, sine = np.cos(angle), np.sin(angle)
    R = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    turned = transfer(np.zeros(3), R @ DISPLACEMENT, angle, TURN)
    assert turned.objective == pytest.approx(at_home.objective, rel=1e-9)
    np.testing.assert_allclose(turned.controls, at_home.controls, atol=1e-7)
    np.testing.assert_allclose(turned.states[:, :3], at_home.states[:, :3] @ R.T, atol=1e-7)
    np.testing.assert_allclose(turned.costates[:, :3], at_home.costates[:, :3] @ R.T, atol=1e-6)


@FEW
@given(start=st.tuples(*[st.floats(-50.0, 50.0)] * 3))
def test_translation_changes_nothing(at_home, start):
    moved = transfer(start, DISPLACEMENT, 0.0, TURN)
    assert moved.objective == pytest.approx(at_home.objective, rel=1e-9)
    np.testing.assert_allclose(moved.controls, at_home.controls, atol=1e-6)


def test_the_costate_of_position_is_conserved(at_home):
    """Translation invariance makes it a first integral (Noether)."""
    p = at_home.costates[:, :3]
    np.testing.assert_allclose(p, np.broadcast_to(p[0], p.shape), atol=1e-7)


@FEW
@given(
    start=st.tuples(st.floats(-2, 2), st.floats(-1, 1)),
    end=st.tuples(st.floats(-2, 2), st.floats(-1, 1)),
    T=st.floats(0.5, 3.0),
)
def test_time_reversal_mirrors_the_double_integrator(start, end, T):
    def solved(first, last):
        problem = problems.minimum_energy(T=T).problem
        problem.initial_lower = problem.initial_upper = np.array(first)
        problem.final_lower = problem.final_upper = np.array(last)
        problem.state_lower, problem.state_upper = np.array([-2.2, -9.0]), np.array([2.2, 9.0])
        return sk.solve(problem, MESH, tolerance=1e-10)

    forward = solved(start, end)
    backward = solved((end[0], -end[1]), (start[0], -start[1]))
    assert backward.objective == pytest.approx(forward.objective, rel=1e-6, abs=1e-9)
    mirrored = forward.states[::-1] * [1.0, -1.0]
    np.testing.assert_allclose(backward.states, mirrored, atol=1e-4)


@FEW
@given(length=st.floats(1e-2, 1e3), time=st.floats(1e-1, 1e2))
def test_units_of_length_and_time_scale_the_optimum_and_nothing_else(length, time):
    """x → Lx, t → Tt: speeds scale by L/T, accelerations by L/T², ½∫u² by L²/T³."""
    L, T = length, time
    home = sk.solve(problems.bryson_denham().problem, MESH, tolerance=TIGHT)
    problem = sk.Problem(
        "bryson-denham in other units",
        ["x", "v"],
        ["a"],
        lambda x, u: [x[1], u[0]],
        horizon=T,
        initial=[0.0, L / T],
        final=[0.0, -L / T],
        running_cost=lambda x, u: 0.5 * u[0] ** 2 * T**3 / L**2,
        state_bounds=([None, None], [L / 9, None]),
    )
    away = sk.solve(problem, MESH, tolerance=TIGHT * min(1, 1 / L, T / L))
    assert away.objective == pytest.approx(home.objective, rel=1e-5)
    np.testing.assert_allclose(away.states / [L, L / T], home.states, atol=1e-4)


@FEW
@given(bounds=st.tuples(st.floats(0.04, 0.3), st.floats(0.04, 0.3)))
def test_relaxing_a_state_bound_never_costs_more(bounds):
    tight, loose = (
        sk.solve(problems.bryson_denham(level).problem, MESH, tolerance=TIGHT)
        for level in sorted(bounds)
    )
    assert loose.objective <= tight.objective * (1 + 1e-8)


@FEW
@given(bounds=st.tuples(st.floats(0.3, 3.0), st.floats(0.3, 3.0)))
def test_relaxing_a_control_bound_never_takes_longer(bounds):
    tight, loose = (
        sk.solve(problems.minimum_time(4.0, most, most).problem, MESH, tolerance=TIGHT)
        for most in sorted(bounds)
    )
    assert loose.objective <= tight.objective * (1 + 1e-7)


@FEW
@given(factor=st.floats(1e-3, 1e3))
def test_a_factor_on_the_cost_moves_no_trajectory(factor):
    reference = problems.van_der_pol()
    home = sk.solve(reference.problem, sk.HermiteSimpson(20), guess=reference.guess, tolerance=1e-9)
    cost = reference.problem.running_cost
    reference.problem.running_cost = lambda x, u: factor * cost(x, u)
    away = sk.solve(
        reference.problem,
        sk.HermiteSimpson(20),
        guess=reference.guess,
        tolerance=1e-9 * min(1.0, factor),
    )
    assert away.objective == pytest.approx(factor * home.objective, rel=1e-9)
    np.testing.assert_allclose(away.states, home.states, atol=1e-6)
    np.testing.assert_allclose(away.costates, factor * home.costates, rtol=1e-5, atol=1e-5 * factor)
