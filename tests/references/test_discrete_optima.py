"""Claim: every scheme poses exactly the finite problem its equations say.

The table comes from a transcription written by hand (``generate_discrete_optima.py``).
"""

from __future__ import annotations

import json

import pytest

import skyknot as sk
from references.generate_discrete_optima import CASES, TABLE, discrete_optimum

SCHEMES = {
    "trapezoid": lambda N: sk.Trapezoid(N, enforce="nodes"),
    "hermite-simpson": lambda N: sk.HermiteSimpson(N, enforce="nodes"),
    "hermite-simpson averaged": lambda N: sk.HermiteSimpson(N, controls="linear", enforce="nodes"),
}
OPTIMA = json.loads(TABLE.read_text(encoding="utf-8"))
# Solved to 1e-10 with a barrier of the same size for each active bound.
RELATIVE = 1e-8


@pytest.mark.parametrize(
    ("case", "scheme", "segments"),
    [(case, scheme, int(N)) for case in CASES for scheme in SCHEMES for N in OPTIMA[case][scheme]],
)
def test_the_optimum_is_that_of_the_scheme_written_by_hand(case, scheme, segments):
    reference = CASES[case]()
    solution = sk.solve(
        reference.problem,
        SCHEMES[scheme](segments),
        solver="ipopt",
        guess=reference.guess,
        tolerance=1e-10,
    )
    assert solution.status == "solved", solution.message
    assert solution.objective == pytest.approx(OPTIMA[case][scheme][str(segments)], rel=RELATIVE)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_stored_table_is_what_its_generator_makes(scheme):
    made = discrete_optimum(CASES["bryson-denham"](), scheme, 10)
    assert made == pytest.approx(OPTIMA["bryson-denham"][scheme]["10"], rel=1e-11)


def test_bang_bang_with_averaged_controls_equals_free_midpoints_on_half_the_mesh():
    averaged, free = (
        OPTIMA["minimum time"][f"hermite-simpson{kind}"] for kind in (" averaged", "")
    )
    assert averaged["40"] == pytest.approx(free["20"], rel=1e-9)
    assert averaged["80"] == pytest.approx(free["40"], rel=1e-9)
