"""Claim: the arcs of an answer are read off its controls, and phases of free length polish it."""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot.bank import CATALOGUE, minimum_time
from skyknot.bank.arcs import changes, phased, switching_times
from skyknot.bank.judgement import answered

PLAIN = sk.Problem("p", ["x"], ["u"], lambda x, u: [u[0]], horizon=10.0, control_bounds=(-1.0, 1.0))


def flown(t, u):
    return sk.Trajectory(np.array(t), np.zeros((len(t), 1)), np.array(u, dtype=float)[:, None])


def test_jumps_ramps_and_arcs_between_the_bounds_are_told_apart():
    t = [0.0, 2.0, 2.1, 5.0, 5.001, 8.0, 8.001, 10.0]
    found = changes(PLAIN, flown(t, [1, 1, -1, -1, 0.3, 0.3, 1, 1]))
    # a jump over 0.1 s, then an arc of three seconds between the bounds
    np.testing.assert_allclose([each.time for each in found], [2.05, 5.0, 8.0], atol=2e-3)
    assert [(each.before, each.after) for each in found] == [(1, -1), (-1, 0), (0, 1)]


def test_a_dip_that_returns_to_its_bound_is_no_switch():
    t = [0.0, 5.0, 5.05, 5.1, 10.0]
    assert len(switching_times(PLAIN, flown(t, [1, 1, 0.4, 1, 1]))) == 0


def test_a_control_without_bounds_has_no_switches():
    free = sk.Problem("p", ["x"], ["u"], lambda x, u: [u[0]], horizon=10.0)
    assert len(switching_times(free, flown([0.0, 5.0, 5.01, 10.0], [1, 1, -1, -1]))) == 0


def test_phases_give_the_exact_switch_from_a_coarse_answer():
    reference = minimum_time()
    coarse = sk.solve(reference.problem, sk.HermiteSimpson(50), tolerance=1e-8)
    assert abs(coarse.objective - reference.optimum) > 1e-5
    stated = phased(reference.problem, coarse.trajectory)
    assert stated.phases == 2
    scheme = sk.Radau(2, 3, controls="linear")
    exact = sk.solve(stated.problem, scheme, guess=stated.guess, tolerance=1e-11)
    assert exact.objective == pytest.approx(reference.optimum, rel=1e-10)
    lengths = list(exact.record.parameters.values())
    assert lengths[0] == pytest.approx(reference.switches[0], rel=1e-7)
    assert sum(lengths) == pytest.approx(reference.optimum, rel=1e-10)


def test_phases_keep_a_running_cost():
    reference = CATALOGUE["soft-landing"]()
    rough = sk.solve(reference.problem, sk.HermiteSimpson(60), tolerance=1e-8)
    stated = phased(reference.problem, rough.trajectory)
    assert stated.phases == 2
    scheme = sk.Radau(2, 3, controls="linear")
    exact = sk.solve(stated.problem, scheme, guess=stated.guess, tolerance=1e-10)
    assert exact.objective == pytest.approx(reference.optimum, rel=1e-9)


def test_singular_arcs_are_found_not_told():
    answer = answered(CATALOGUE["planar-quadrotor"]())
    assert len(answer.switches) == 4
    # the craft turns back as it turned out
    np.testing.assert_allclose(answer.switches + answer.switches[::-1], answer.duration, rtol=1e-4)
