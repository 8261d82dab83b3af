"""Claim: the kernel's interior point and Ipopt agree on every feature of a program."""

from __future__ import annotations

import pytest

import skyknot as sk
from agreement.variants import ALL_SCHEMES, CASES, PROBLEMS
from skyknot import bank as problems

# The pendulum with a free horizon has several local optima: only the conditions are compared.
SEVERAL_OPTIMA = {"free horizon", "free horizon, rates", "everything"}


@pytest.mark.parametrize(("problem", "scheme"), CASES)
def test_both_solvers_find_the_same_optimum(problem: str, scheme: str) -> None:
    ours = sk.solve(PROBLEMS[problem], ALL_SCHEMES[scheme], solver="interior-point", tolerance=1e-8)
    assert ours.success, ours.message
    assert ours.kkt_residual < 1e-6
    if problem not in SEVERAL_OPTIMA:
        theirs = sk.solve(PROBLEMS[problem], ALL_SCHEMES[scheme], solver="ipopt", tolerance=1e-8)
        assert ours.objective == pytest.approx(theirs.objective, rel=1e-6, abs=1e-6)


CLASSICS = (
    problems.hager,
    problems.garg,
    problems.minimum_energy,
    problems.bryson_denham,
    lambda: problems.van_der_pol(-0.25, 1.0),
    problems.minimum_time,
    problems.brachistochrone,
    problems.steering,
    problems.cart_pole,
    problems.quadrotor_transfer,
)


@pytest.mark.parametrize("make", CLASSICS)
@pytest.mark.parametrize("controls", ["quadratic", "linear", "hold"])
def test_both_solvers_agree_on_the_classics(make, controls: str) -> None:
    reference = make()
    scheme = sk.HermiteSimpson(20, controls=controls)
    settings = {"guess": reference.guess, "tolerance": 1e-8}
    ours = sk.solve(reference.problem, scheme, solver="interior-point", **settings)
    theirs = sk.solve(reference.problem, scheme, solver="ipopt", **settings)
    assert ours.success, ours.message
    assert ours.objective == pytest.approx(theirs.objective, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("make", CLASSICS)
@pytest.mark.parametrize(
    "scheme",
    [sk.Lobatto(8, 5), sk.Radau(8, 4), sk.Chebyshev(8, 5), sk.Lobatto(1, 14)],
    ids=["lobatto", "radau", "chebyshev", "one segment"],
)
def test_both_solvers_agree_on_the_classics_with_longer_segments(make, scheme) -> None:
    reference = make()
    settings = {"guess": reference.guess, "tolerance": 1e-8}
    ours = sk.solve(reference.problem, scheme, solver="interior-point", **settings)
    theirs = sk.solve(reference.problem, scheme, solver="ipopt", **settings)
    assert ours.success, ours.message
    assert ours.objective == pytest.approx(theirs.objective, rel=1e-6, abs=1e-6)


def test_a_path_constraint_active_at_a_fixed_end_needs_no_interior() -> None:
    problem = sk.Problem(
        "climb from the floor",
        ["height", "climb"],
        ["thrust"],
        lambda x, u: [x[1], u[0]],
        horizon=1.0,
        initial=[0.5, 0.0],
        final=[1.0, 0.0],
        running_cost=lambda x, u: u[0] ** 2,
        path=[sk.PathConstraint("floor", lambda x, u: x[0], lower=0.5)],
    )
    solution = sk.solve(problem, sk.HermiteSimpson(20), solver="interior-point")
    assert solution.success, solution.message
    assert solution.objective == pytest.approx(12 * 0.5**2, rel=1e-6)
