"""Claim: a refined mesh has its nodes where the errors are, and keeps what it must keep."""

from __future__ import annotations

import numpy as np
import pytest

from skyknot.errors import UserError
from skyknot.transcription.refinement import Refinement, refined, split
from skyknot.transcription.schemes import HERMITE_SIMPSON
from skyknot.transcription.segment_error import SegmentError
from skyknot.transcription.switches import Switch

UNIFORM = np.linspace(0.0, 1.0, 21)
LAYS = pytest.mark.parametrize("lay", [refined, split])


def errors(between, effect=None, passed=None, flight=None, smeared=None):
    between = np.asarray(between, dtype=float)
    effect = np.zeros_like(between) if effect is None else np.asarray(effect, dtype=float)
    apart = np.zeros((len(between) + 1, 1))
    apart[-1] = np.sum(effect) if flight is None else flight
    return SegmentError(
        between=between[:, None],
        missed=0.1 * between[:, None],
        apart=apart,
        effect=effect,
        passed=np.zeros_like(between) if passed is None else np.asarray(passed, dtype=float),
        smeared=np.zeros_like(between) if smeared is None else np.asarray(smeared, dtype=float),
        sizes=np.ones(1),
    )


def one_bad(k, size, others=5e-5, N=20):
    values = np.full(N, others)
    values[k] = size
    return values


@LAYS
@pytest.mark.parametrize("k", [0, 7, 19])
def test_a_segment_at_fault_is_split(lay, k):
    mesh = lay(UNIFORM, errors(one_bad(k, 1e-2)), Refinement(1e-4), HERMITE_SIMPSON)
    inside = (mesh > UNIFORM[k] - 1e-9) & (mesh < UNIFORM[k + 1] + 1e-9)
    assert np.sum(inside) >= 3
    assert mesh[0] == 0.0
    assert mesh[-1] == 1.0
    assert np.all(np.diff(mesh) > 0)


@LAYS
def test_an_error_of_four_orders_too_much_asks_for_ten_times_the_nodes_within_the_limit(lay):
    mesh = lay(UNIFORM, errors(np.full(20, 1.0)), Refinement(1e-4), HERMITE_SIMPSON)
    assert len(mesh) - 1 == 100  # five pieces of each at most in one round


def test_what_adds_up_in_flight_is_divided_until_the_sum_is_allowed():
    effect = np.full(20, 1e-3)
    mesh = refined(UNIFORM, errors(np.full(20, 1e-6), effect), Refinement(1e-4), HERMITE_SIMPSON)
    pieces = (len(mesh) - 1) / 20
    assert np.sum(effect) * pieces**-4 <= 1e-4
    assert pieces < 5


def test_of_what_adds_up_in_flight_the_largest_parts_are_halved_and_no_more():
    effect = one_bad(6, 3e-4, others=1e-6)
    mesh = split(UNIFORM, errors(np.full(20, 1e-6), effect), Refinement(1e-4), HERMITE_SIMPSON)
    assert len(mesh) == len(UNIFORM) + 1
    assert np.min(np.abs(mesh - 0.325)) < 1e-12


@LAYS
def test_a_limit_passed_between_the_nodes_is_reason_enough(lay):
    passed = one_bad(5, 0.05, others=0.0)
    mesh = lay(UNIFORM, errors(np.full(20, 1e-6), passed=passed), Refinement(1e-4), HERMITE_SIMPSON)
    longest = np.max(
        np.diff(mesh)[(mesh[:-1] > UNIFORM[5] - 0.01) & (mesh[1:] < UNIFORM[6] + 0.01)]
    )
    assert longest <= 0.05 / 3


@LAYS
def test_a_jump_spread_over_a_segment_is_reason_enough(lay):
    smeared = one_bad(5, 0.05, others=0.0)
    calm = np.full(20, 1e-6)
    mesh = lay(UNIFORM, errors(calm, smeared=smeared), Refinement(1e-4), HERMITE_SIMPSON)
    assert np.sum((mesh > UNIFORM[5] + 1e-9) & (mesh < UNIFORM[6] - 1e-9)) >= 3


def test_segments_that_do_better_than_asked_for_merge_while_the_rest_is_far_off():
    values = one_bad(0, 1e-1, others=1e-12)
    mesh = refined(UNIFORM, errors(values), Refinement(1e-4), HERMITE_SIMPSON)
    assert np.max(np.diff(mesh)) > 2 * 0.05


def test_no_segments_merge_near_the_goal():
    values = one_bad(0, 5e-4, others=1e-12)
    mesh = refined(UNIFORM, errors(values), Refinement(1e-4), HERMITE_SIMPSON)
    assert np.max(np.diff(mesh)) <= 0.05 * 1.5
    assert len(mesh) >= len(UNIFORM)


def test_splitting_keeps_every_node():
    mesh = split(UNIFORM, errors(one_bad(3, 1e-2)), Refinement(1e-4), HERMITE_SIMPSON)
    assert all(np.min(np.abs(mesh - node)) < 1e-12 for node in UNIFORM)


def test_a_mesh_laid_anew_is_graded():
    mesh = refined(UNIFORM, errors(one_bad(10, 1e3)), Refinement(1e-4), HERMITE_SIMPSON)
    lengths = np.diff(mesh)
    ratios = lengths[1:] / lengths[:-1]
    assert np.max(ratios) < 5
    assert np.min(ratios) > 1 / 5


@LAYS
def test_the_limit_of_segments_is_kept(lay):
    mesh = lay(UNIFORM, errors(np.full(20, 1e3)), Refinement(1e-4, segments=50), HERMITE_SIMPSON)
    assert 20 <= len(mesh) - 1 <= 50


@LAYS
def test_switches_do_not_exceed_the_limit_of_segments(lay):
    places = [Switch(0, place, (place, place), jump=True) for place in np.linspace(0.11, 0.9, 9)]
    wanted = Refinement(1e-4, segments=22)
    mesh = lay(UNIFORM, errors(np.full(20, 4e-5)), wanted, HERMITE_SIMPSON, places)
    assert len(mesh) - 1 <= 22


@LAYS
@pytest.mark.parametrize("place", [0.512345, 0.549, 0.5000001])
def test_a_switch_gets_a_node(lay, place):
    switch = Switch(0, place, (0.5, 0.55), jump=False)
    mesh = lay(UNIFORM, errors(np.full(20, 4e-5)), Refinement(1e-4), HERMITE_SIMPSON, [switch])
    assert np.min(np.abs(mesh - place)) < 1e-12
    assert len(mesh) <= len(UNIFORM) + 1


@LAYS
def test_switches_are_not_believed_while_the_answer_is_far_off(lay):
    switch = Switch(0, 0.512345, (0.5, 0.55), jump=False)
    mesh = lay(UNIFORM, errors(np.full(20, 0.3)), Refinement(1e-1), HERMITE_SIMPSON, [switch])
    assert np.min(np.abs(mesh - 0.512345)) > 1e-6


@LAYS
def test_places_of_point_constraints_stay_nodes(lay):
    nodes = np.sort(np.append(UNIFORM, 0.123))
    mesh = lay(
        nodes, errors(np.full(21, 1e-3)), Refinement(1e-4), HERMITE_SIMPSON, [], [0.123, 1.0]
    )
    assert np.min(np.abs(mesh - 0.123)) < 1e-12
    assert np.all(np.diff(mesh) > 1e-6)


@LAYS
def test_errors_without_number_ask_for_the_most_pieces(lay):
    values = one_bad(4, np.nan)
    mesh = lay(UNIFORM, errors(values), Refinement(1e-4), HERMITE_SIMPSON)
    assert np.sum((mesh > UNIFORM[4] + 1e-9) & (mesh < UNIFORM[5] - 1e-9)) >= 3
    assert np.all(np.isfinite(mesh))


@pytest.mark.parametrize("accuracy", [0.0, -1e-4, 1e-13, 1.0, 7, float("nan"), float("inf")])
def test_an_accuracy_that_cannot_be_is_refused_in_five_parts(accuracy):
    with pytest.raises(UserError, match="The accuracy asked for cannot be") as caught:
        Refinement(accuracy)
    error = caught.value
    assert error.where == "accuracy"
    assert "1e-10" in str(error.expected)
    assert error.found is not None
    assert error.do


@pytest.mark.parametrize("accuracy", [True, "1e-4", None, [1e-4]])
def test_an_accuracy_of_the_wrong_type_is_refused(accuracy):
    with pytest.raises(UserError, match="a number such as 1e-4"):
        Refinement(accuracy)


@pytest.mark.parametrize("limit", ["rounds", "segments", "seconds"])
def test_limits_must_be_positive(limit):
    with pytest.raises(UserError, match=f"accuracy.{limit}"):
        Refinement(1e-4, **{limit: 0})
