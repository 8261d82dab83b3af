"""Claim: the optimality conditions, put together again, hold for answers and fail for others."""

from dataclasses import replace

import numpy as np
import pytest

import skyknot as sk
from agreement.variants import PROBLEMS, SCHEMES
from skyknot.verification import certify
from skyknot.verification.evidence import Evidence

CONDITIONS = ("stationarity", "multiplier signs", "complementarity")


def evidence_of(solution):
    return Evidence(
        solution.problem, solution.trajectory, solution.record.parameters, solution.full_witness()
    )


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("name", ["free horizon", "point"])
def test_they_hold_for_every_scheme(name, scheme):
    solution = sk.solve(PROBLEMS[name], SCHEMES[scheme])
    checks = solution.verify().checks
    assert all(checks[condition].passed for condition in CONDITIONS)
    program = evidence_of(solution).program
    assert program.objective == pytest.approx(solution.objective, rel=1e-12)


@pytest.mark.parametrize("scheme", ["euler", "hermite-simpson", "hermite-simpson, linear"])
def test_they_hold_with_bounds_on_rates(scheme):
    checks = sk.solve(PROBLEMS["everything"], SCHEMES[scheme]).verify().checks
    assert all(checks[condition].passed for condition in CONDITIONS)


@pytest.mark.parametrize("name", PROBLEMS)
def test_they_hold_for_every_feature_of_a_problem(name):
    solution = sk.solve(PROBLEMS[name], sk.HermiteSimpson(8), "ipopt", tolerance=1e-8)
    checks = solution.verify().checks
    assert all(checks[condition].passed for condition in CONDITIONS)


def test_the_slope_of_the_lagrangian_is_its_difference_quotient():
    """A free duration moves every time, every rate bound and the end cost at once."""
    solution = sk.solve(PROBLEMS["everything"], sk.HermiteSimpson(8))

    def value(duration):
        times = solution.times / solution.times[-1] * duration
        longer = replace(solution, trajectory=replace(solution.trajectory, times=times))
        program = evidence_of(longer).program
        w = program.witness
        linear = np.einsum("ij,kjx->kix", w.C, program.X)
        defects = linear + np.einsum(
            "k,ij,kjx->kix", duration * program.fractions, w.A, program.rates
        )
        rate, _, _ = program.rate_rows
        return (
            program.objective
            + np.sum(w.defects * defects)
            + np.sum(w.path * program.rows)
            + np.sum(w.rates * rate - program.rate_pull * duration * w.rate_spans)
            + w.global_bounds @ program.lagrangian.q
        )

    T = solution.times[-1]
    quotient = (value(T + 1e-5) - value(T - 1e-5)) / 2e-5
    slope = evidence_of(solution).program.global_slopes[0]
    assert np.max(np.abs(evidence_of(solution).program.global_terms[:, 0])) > 1e-3
    assert slope == pytest.approx(quotient, abs=1e-6)


def test_the_unscaled_residual_is_the_one_the_solution_tells():
    solution = sk.solve(PROBLEMS["path"], sk.HermiteSimpson(8), tolerance=1e-3)
    checks = solution.verify().checks
    found = max(checks[condition].value for condition in CONDITIONS)
    assert found == pytest.approx(solution.kkt_residual, rel=1e-6)


def test_without_a_witness_nothing_is_said_about_optimality():
    solution = sk.solve(PROBLEMS["plain"], sk.HermiteSimpson(8))
    assert not set(CONDITIONS) & set(certify(solution.problem, solution.trajectory).checks)


FIELDS = ("C", "A", "weights", "defects", "path", "state_bounds", "control_bounds", "rates")


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("number", [np.nan, np.inf, 1e300])
@pytest.mark.parametrize("field", [*FIELDS, "costates", "global_bounds"])
def test_numbers_that_are_none_fail_without_a_word_of_warning(everything, field, number):
    witness = everything.full_witness()
    values = getattr(witness, field).copy()
    values.flat[values.size // 3] = number
    certificate = certify(
        everything.problem,
        everything.trajectory,
        everything.record.parameters,
        witness=replace(witness, **{field: values}),
    )
    assert not certificate.passed
    assert certificate.sentence.startswith("Not certified")


@pytest.fixture(scope="module")
def everything():
    return sk.solve(PROBLEMS["everything"], sk.HermiteSimpson(8))
