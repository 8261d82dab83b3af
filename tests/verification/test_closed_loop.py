"""Claim: the flight with feedback tracks a good answer and exposes gains that do not."""

from dataclasses import replace

import numpy as np
import pytest
from drone_on_rail import problem

import skyknot as sk
from skyknot.verification import certify
from skyknot.verification.closed_loop import PERTURBATION, STARTS, starts
from skyknot.verification.evidence import Evidence

FLIGHTS = ("closed-loop flight", "closed-loop, perturbed")


def asked(**changes):
    return problem(rates=None, points=[], **changes)


@pytest.fixture(scope="module", params=["quadratic", "hold"])
def solution(request):
    return sk.solve(asked(), sk.HermiteSimpson(40, controls=request.param))


def certificate(solution, **changes):
    witness = replace(solution.full_witness(), **changes)
    return certify(solution.problem, solution.trajectory, {"drag": 0.2}, witness=witness)


def test_the_solution_s_own_gains_bring_it_home(solution):
    checks = solution.verify().checks
    assert all(checks[name].passed for name in FLIGHTS)
    assert checks["closed-loop flight"].value < 1e-6
    assert 0 < checks["closed-loop, perturbed"].value < 0.01


def test_gains_of_the_wrong_sign_do_not(solution):
    checks = certificate(solution, gains=-solution.gains).checks
    assert not checks["closed-loop, perturbed"].passed


def test_without_feedback_a_perturbed_start_misses_by_what_it_was_off(solution):
    """Of 0.5 % of 1 m and of the greatest speed, drag leaves the position off by a centimetre."""
    checks = certificate(solution, gains=0 * solution.gains).checks
    check = checks["closed-loop, perturbed"]
    x, v = (starts(solution.states)[1:] - solution.states[0]).T
    misses = np.abs(x + v * (1 - np.exp(-0.4)) / 0.2)
    assert check.value == pytest.approx(max(misses), rel=1e-4)


def test_the_starts_are_seeded_and_of_the_size_told(solution):
    first, second = starts(solution.states), starts(solution.states)
    np.testing.assert_array_equal(first, second)
    assert first.shape == (1 + STARTS, 2)
    off = np.abs(first[1:] - solution.states[0])
    np.testing.assert_allclose(off, PERTURBATION * np.ptp(solution.states, axis=0) + 0 * off)


def test_controls_are_clipped_to_their_bounds(solution):
    tight = replace(solution, problem=asked(control_bounds=(-0.1, 0.1)))
    check = tight.verify().checks["closed-loop flight"]
    assert not check.passed
    assert check.value > 0.5


def test_a_cost_that_does_not_curve_is_not_flown_with_feedback():
    fastest = asked(horizon=sk.Free(0.5, 4), running_cost=lambda x, u: 1.0)
    certificate = sk.solve(fastest, sk.HermiteSimpson(40)).verify()
    assert not set(FLIGHTS) & set(certificate.checks)
    assert "Not flown with feedback: the cost does not curve in a." in certificate.notes


def test_an_answer_without_gains_is_told():
    certificate = sk.solve(asked(), sk.HermiteSimpson(20), "ipopt").verify()
    assert "Not flown with feedback: the answer carries no gains." in certificate.notes


def test_a_flight_that_diverges_is_a_failed_check():
    runaway = sk.Problem(
        "runaway",
        ["x"],
        ["u"],
        lambda x, u: [x[0] ** 3 + u[0]],
        2.0,
        initial=[0.1],
        running_cost=lambda x, u: x[0] ** 2 + u[0] ** 2,
    )
    solution = sk.solve(runaway, sk.HermiteSimpson(20))
    wild = replace(solution, gains=-1e3 * np.ones_like(solution.gains))
    check = wild.verify().checks["closed-loop, perturbed"]
    assert not check.passed
    evidence = Evidence(runaway, solution.trajectory, {}, wild.full_witness())
    assert not np.all(np.isfinite(evidence.tracked))
