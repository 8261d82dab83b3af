"""Claim: the tracking cost is the quadratic form it says, for diagonals and full matrices."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import skyknot as sk


def numbers(seed):
    random = np.random.default_rng(seed)
    full = random.normal(size=(4, 4))
    return {
        "x": random.normal(size=4),
        "u": random.normal(size=2),
        "target": random.normal(size=4),
        "reference": random.normal(size=2),
        "Q": full + full.T,
        "R": random.uniform(0.1, 2.0, 2),
        "Q_final": random.uniform(0.1, 9.0, 4),
    }


@given(seed=st.integers(0, 2**31))
def test_the_running_cost_is_numpys_quadratic_form(seed):
    n = numbers(seed)
    cost = sk.QuadraticTracking(
        n["target"], n["Q"], n["R"], n["Q_final"], control_reference=n["reference"]
    )
    e, w = n["x"] - n["target"], n["u"] - n["reference"]
    expected = e @ n["Q"] @ e + w @ np.diag(n["R"]) @ w
    assert float(cost.running_cost(ca.DM(n["x"]), ca.DM(n["u"]))) == pytest.approx(expected)
    final = e @ np.diag(n["Q_final"]) @ e
    assert float(cost.terminal_cost(ca.DM(n["x"]), 1.0)) == pytest.approx(final)


def test_without_an_end_weight_there_is_no_end_term():
    cost = sk.QuadraticTracking([0.0], [1.0], [1.0])
    assert cost.terminal_cost(ca.DM([3.0])) == 0.0


def test_without_a_reference_controls_are_measured_from_zero():
    cost = sk.QuadraticTracking([0.0], [0.0], [2.0])
    assert float(cost.running_cost(ca.DM([5.0]), ca.DM([3.0]))) == pytest.approx(18.0)


@pytest.mark.parametrize(
    ("weights", "name"),
    [
        ({"Q": [1.0]}, "Q"),
        ({"Q": [[1.0, 2.0], [0.0, 1.0]]}, "Q"),
        ({"R": [1.0, 2.0], "control_reference": [0.0]}, "R"),
        ({"Q_final": np.eye(3)}, "Q_final"),
    ],
)
def test_a_weight_that_does_not_fit_is_named(weights, name):
    chosen = {"Q": [1.0, 1.0], "R": [1.0], "Q_final": [1.0, 1.0]} | weights
    cost = sk.QuadraticTracking([0.0, 0.0], **chosen)
    with pytest.raises(sk.UserError, match=f"The weight {name} does not fit") as caught:
        sk.Problem(
            "tracking", ["x", "v"], ["a"], lambda x, u: [x[1], u[0]], 1.0, **cost.callables()
        )
    assert caught.value.where == name
