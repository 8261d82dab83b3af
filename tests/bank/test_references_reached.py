"""Claim: every reference problem reaches its optimum, what others printed, and its switches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import skyknot as sk
from skyknot.bank import CATALOGUE, judged, minimum_time
from skyknot.bank.base import COMPUTED, KINDS, OF_THE_HORIZON, RELATIVE, Printed
from skyknot.bank.catalogue import about


@pytest.mark.parametrize("name", CATALOGUE)
def test_the_reference_is_reached(name):
    judgement = judged(name, CATALOGUE[name]())
    assert judgement.reached, judgement.complaint
    assert abs(judgement.found - judgement.reference.optimum) <= judgement.reference.limit
    if judgement.reference.switches:
        assert judgement.switching <= OF_THE_HORIZON


@pytest.mark.parametrize("name", CATALOGUE)
def test_the_reference_tells_kind_source_and_digits(name):
    reference = CATALOGUE[name]()
    assert reference.kind in KINDS
    assert reference.source.startswith(reference.kind)
    assert (reference.digits is not None) == (reference.kind == COMPUTED)
    assert about(name).endswith(".")
    if reference.digits is None:
        assert reference.limit == RELATIVE * (abs(reference.optimum) or 1.0)


@pytest.mark.parametrize("name", CATALOGUE)
def test_no_recipe_has_a_node_on_a_known_switch(name):
    reference = CATALOGUE[name]()
    if reference.switches:
        mesh = reference.recipe.scheme.nodes
        np.testing.assert_allclose(np.diff(mesh), 1 / (len(mesh) - 1), rtol=1e-12)


def test_an_optimum_that_is_wrong_is_missed():
    reference = minimum_time()
    wrong = replace(reference, optimum=reference.optimum * (1 + 2e-6))
    assert "optimum missed by 1.1e-05" in judged("wrong", wrong).complaint


def test_a_switch_that_is_wrong_is_missed():
    reference = minimum_time()
    late = replace(reference, switches=(reference.switches[0] + 0.01,))
    assert judged("late", late).complaint == "switches off by 1.8e-03 of the horizon"
    more = replace(reference, switches=(*reference.switches, 5.0))
    assert judged("more", more).complaint == "another number of switches"


def test_a_printed_number_that_disagrees_is_missed_unless_known_to_be_wrong():
    reference = minimum_time()
    for wrong, complaint in (("", "printed 5.4771 by nobody"), ("a typing error", "")):
        printed = replace(reference, printed=(Printed("5.4771", "nobody", wrong),))
        assert judged("printed", printed).complaint == complaint


def test_a_solve_that_fails_is_missed():
    reference = minimum_time()
    hopeless = sk.Problem(
        "too soon",
        ["x", "v"],
        ["a"],
        lambda x, u: [x[1], u[0]],
        horizon=0.1,
        initial=[0.0, 0.0],
        final=[10.0, 0.0],
        control_bounds=(-2.0, 1.0),
    )
    judgement = judged("hopeless", replace(reference, problem=hopeless))
    assert judgement.complaint.startswith("not solved: ")
