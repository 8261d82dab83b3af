"""Claim: separated and compressed Hermite–Simpson have one optimum, controls and multipliers.

Eliminating the midpoint state changes only who does the elimination; the multipliers of the
Hermite rows are lifted back by stationarity in the midpoint state.
"""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from agreement.variants import PROBLEMS
from skyknot import bank as problems

REFERENCES = {
    "quadrotor transfer": problems.quadrotor_transfer(),
    "hager": problems.hager(),
    "garg": problems.garg(),
}
CASES = {name: (problem, None) for name, problem in PROBLEMS.items()} | {
    name: (reference.problem, reference.guess) for name, reference in REFERENCES.items()
}


def both_forms(case, segments, controls, tolerance):
    problem, guess = CASES[case]
    return (
        sk.solve(
            problem,
            sk.HermiteSimpson(segments, controls=controls, form=form),
            solver="ipopt",
            guess=guess,
            tolerance=tolerance,
        )
        for form in ("separated", "compressed")
    )


@pytest.mark.parametrize("controls", ["quadratic", "linear", "hold"])
@pytest.mark.parametrize("case", CASES)
def test_both_forms_give_the_same_answer(case, controls):
    separated, compressed = both_forms(case, 8, controls, 1e-11)
    assert compressed.objective == pytest.approx(separated.objective, rel=1e-9)
    # Weakly active bounds settle within the root of the barrier.
    close = {"rtol": 1e-5, "atol": 1e-5}
    np.testing.assert_allclose(compressed.states, separated.states, **close)
    np.testing.assert_allclose(compressed.midpoint_states, separated.midpoint_states, **close)
    np.testing.assert_allclose(compressed.controls, separated.controls, **close)
    np.testing.assert_allclose(compressed.costates, separated.costates, **close)
    np.testing.assert_allclose(
        compressed.multipliers["defects"], separated.multipliers["defects"], **close
    )


@pytest.mark.parametrize("case", REFERENCES)
def test_without_active_bounds_they_agree_to_rounding(case):
    separated, compressed = both_forms(case, 12, "quadratic", 1e-12)
    assert compressed.objective == pytest.approx(separated.objective, rel=1e-12)
    for name in ("states", "controls", "costates", "decision"):
        np.testing.assert_allclose(
            getattr(compressed, name), getattr(separated, name), rtol=1e-8, atol=1e-8
        )
    np.testing.assert_allclose(
        compressed.multipliers["defects"],
        separated.multipliers["defects"],
        rtol=1e-8,
        atol=1e-8,
    )
