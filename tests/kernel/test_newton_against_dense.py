"""Claim: the structured Newton step solves the unreduced system, and tells its inertia.

The other road is dense: the matrix from CasADi's derivatives of the program as it is written,
solved by least squares, its inertia from the eigenvalues of the projected Hessian.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, event, given, settings
from hypothesis import strategies as st

from kernel.newton_systems import NewtonSystem, system_of
from kernel.stage_problems import CHOICES, Case, cases

CLOSE = 1e-8
WELL_POSED = 1e6  # condition up to which a residual of 1e-10 leaves eight digits of the solution


def largest(values: np.ndarray) -> float:
    return float(np.max(np.abs(values), initial=0.0))


def check_against_dense(system: NewtonSystem) -> None:
    step = system.step()
    assert step["factored"]
    K, right, found = system.K, system.right, system.unpacked(step)
    size = largest(right)
    exact = np.linalg.lstsq(K, -right, rcond=1e-13)[0]
    attainable = largest(K @ exact + right) / size
    assert largest(system.judged(K @ found + right)) / size <= CLOSE + 100 * attainable
    singular = np.linalg.svd(K, compute_uv=False)
    unique = singular[0] < WELL_POSED * singular[-1]
    if unique:
        exact[: len(system.sigma)][system.pinned] = 0.0
        judged = np.ones(len(exact), dtype=bool)
        judged[len(exact) - system.pinned.sum() :] = ~system.unjudged[system.pinned]
        assert largest((found - exact)[judged]) <= CLOSE * largest(exact)


def check_where_refinement_works(system: NewtonSystem) -> None:
    """Equalities that all but contradict one another are beyond a weight of 1e8."""
    assume(system.step()["factored"])
    assume(system.slowest_refinement() < 0.1)
    check_against_dense(system)


@settings(max_examples=50)
@given(cases(most_states=6))
def test_the_step_solves_the_unreduced_system(case: Case) -> None:
    check_where_refinement_works(system_of(case))


@pytest.mark.parametrize("scheme", CHOICES)
@pytest.mark.parametrize("N", [8, 9, 16, 17])
def test_groups_of_eight_segments_full_or_not_make_no_difference(scheme, N: int) -> None:
    """Kept rows and sums over globals of a second group of eight stand elsewhere."""
    check_against_dense(system_of(Case(nx=2, nu=1, N=N, scheme=scheme, seed=1, free_horizon=True)))


@settings(max_examples=5)
@given(cases(most_states=20, N=3))
def test_many_states_make_no_difference(case: Case) -> None:
    check_where_refinement_works(system_of(replace(case, nx=20, nu=6)))


FULL = Case(
    nx=3, nu=2, N=9, scheme=CHOICES[0], seed=5, uneven=True, free_horizon=True, parameters=2,
    inequalities=2, equalities=1, final=2, final_twice=True, rates=True, bend=0.3,
)  # fmt: skip


@pytest.mark.parametrize("scheme", CHOICES, ids=lambda choice: ", ".join(choice))
@pytest.mark.parametrize("repeated", [False, True])
def test_every_scheme_carries_every_feature(scheme: tuple[str, str], repeated: bool) -> None:
    check_against_dense(system_of(replace(FULL, scheme=scheme, repeated=repeated)))


def test_the_multipliers_of_redundant_rows_stay_bounded() -> None:
    system = system_of(replace(FULL, scheme=CHOICES[3], repeated=True))
    least_norm = np.linalg.lstsq(system.K, -system.right, rcond=1e-13)[0]
    assert largest(system.unpacked(system.step())) <= 10 * largest(least_norm)


INDEFINITE = replace(FULL, curvature=-3.0, spread=0.0, bounds=False, inequalities=0)

indefinite = st.sampled_from([1.0, 0.0, -1.0]).flatmap(
    lambda curvature: cases(most_states=5, curvature=curvature, spread=0.0, bounds=False)
)


@settings(max_examples=60)
@given(indefinite)
def test_the_factorisation_tells_the_inertia(case: Case) -> None:
    system = system_of(case)
    least = system.least_curvature()
    assume(abs(least) > 1e-7 * largest(system.H))  # nearer to zero, rounding decides
    event(f"positive definite: {least > 0}")
    assert system.step()["factored"] == (least > 0)


def test_the_inertia_cases_hold_both_answers() -> None:
    answers = {
        system_of(replace(INDEFINITE, scheme=scheme, curvature=curvature)).step()["factored"]
        for scheme in CHOICES[:2]
        for curvature in (1.0, -3.0)
    }
    assert answers == {True, False}


def test_enough_regularisation_always_makes_the_system_definite() -> None:
    assert not system_of(replace(INDEFINITE, scheme=CHOICES[1])).step()["factored"]
    assert system_of(replace(INDEFINITE, scheme=CHOICES[1], regularisation=100.0)).step()[
        "factored"
    ]
