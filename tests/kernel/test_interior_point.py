"""The kernel's interior point finds Ipopt's optimum of the same program."""

import numpy as np
import pytest

import skyknot as sk
from skyknot import missions

EVEN = {"transcription": sk.HermiteSimpson(100, enforce="nodes"), "accuracy": None}


@pytest.mark.parametrize("name", ["report_transfer", "report_transfer_constrained", "minimum_time"])
def test_own_solver_finds_the_optimum_of_ipopt(name: str) -> None:
    mission = missions.load(name)
    settings = mission.settings() | EVEN | {"tolerance": 1e-7}
    ours = sk.solve(mission.problem, **(settings | {"solver": "interior-point"}))
    theirs = sk.solve(mission.problem, **(settings | {"solver": "ipopt"}))
    assert ours.success
    assert theirs.success
    assert ours.objective == pytest.approx(theirs.objective, rel=1e-6)


def test_states_agree_where_the_optimum_is_unique() -> None:
    mission = missions.load("report_transfer")
    settings = mission.settings() | EVEN | {"tolerance": 1e-8}
    ours = sk.solve(mission.problem, **(settings | {"solver": "interior-point"}))
    theirs = sk.solve(mission.problem, **(settings | {"solver": "ipopt"}))
    np.testing.assert_allclose(ours.states, theirs.states, atol=1e-4)
    assert ours.kkt_residual < 1e-6


def test_a_cost_that_falls_without_end_is_called_unbounded() -> None:
    problem = sk.Problem(
        "fall", ["x"], ["u"], lambda x, u: [u[0]], 1.0, [0.0], running_cost=lambda x, u: u[0]
    )
    solution = sk.solve(problem, sk.HermiteSimpson(5))
    assert solution.status is sk.Status.UNBOUNDED
    assert "sign error in the cost" in solution.status.advice
