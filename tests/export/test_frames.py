"""Claim: NED/FRD and ENU/FLU tell one motion; every flip of a sign would be seen."""

from __future__ import annotations

from itertools import combinations, permutations, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from scipy.spatial.transform import Rotation

from export.flights import MOTIONS, state_of
from skyknot.export.frames import (
    continuous,
    enu_attitude_from_ned,
    enu_from_ned,
    enu_yaw_from_ned,
    flu_from_frd,
    quaternion_of_angles,
    quaternion_product,
    rotated,
    x_first,
)

TIMES = np.linspace(0, 4, 9)
NORTH, EAST, UP = np.eye(3)[1], np.eye(3)[0], np.eye(3)[2]


def attitude(name):
    """Return (M, 4) FRD → NED and FLU → ENU of a motion, w first."""
    ned = quaternion_of_angles(state_of(MOTIONS[name], TIMES)[:, 6:9])
    return ned, enu_attitude_from_ned(ned)


def turned(quaternion, axis):
    """Return where a body axis points, by SciPy."""
    return Rotation.from_quat(quaternion[[1, 2, 3, 0]]).apply(axis)


def test_the_world_axes_change_places_and_down_becomes_up():
    np.testing.assert_array_equal(enu_from_ned(np.array([1.0, 2.0, 3.0])), [2.0, 1.0, -3.0])
    np.testing.assert_array_equal(flu_from_frd(np.array([1.0, 2.0, 3.0])), [1.0, -2.0, -3.0])


def test_zero_stays_without_a_sign():
    assert not np.signbit(enu_from_ned(np.zeros(3))).any()
    assert not np.signbit(flu_from_frd(np.zeros(3))).any()


@pytest.mark.parametrize("name", MOTIONS)
def test_attitudes_agree_with_scipy_and_with_matrices(name):
    angles = state_of(MOTIONS[name], TIMES)[:, 6:9]
    ned, enu = attitude(name)
    truth = Rotation.from_euler("ZYX", angles[:, ::-1])
    P, D = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]]), np.diag([1, -1, -1])
    np.testing.assert_allclose(Rotation.from_quat(ned[:, [1, 2, 3, 0]]).as_matrix(),
                               truth.as_matrix(), atol=1e-14)  # fmt: skip
    np.testing.assert_allclose(Rotation.from_quat(enu[:, [1, 2, 3, 0]]).as_matrix(),
                               P @ truth.as_matrix() @ D, atol=1e-14)  # fmt: skip


def test_a_nose_to_the_north_is_a_quarter_turn_from_east():
    _, enu = attitude("pure yaw")
    np.testing.assert_allclose(enu[0], [np.sqrt(0.5), 0, 0, np.sqrt(0.5)], atol=1e-15)
    np.testing.assert_allclose(turned(enu[0], [1, 0, 0]), NORTH, atol=1e-14)
    np.testing.assert_allclose(turned(enu[0], [0, 1, 0]), -EAST, atol=1e-14)


def test_a_pure_yaw_to_the_right_turns_the_nose_from_north_to_east():
    ned, enu = attitude("pure yaw")
    yaw = 0.4 * TIMES
    for i in range(len(TIMES)):
        nose = np.cos(yaw[i]) * NORTH + np.sin(yaw[i]) * EAST
        np.testing.assert_allclose(turned(enu[i], [1, 0, 0]), nose, atol=1e-14)
        np.testing.assert_allclose(turned(enu[i], [0, 0, 1]), UP, atol=1e-14)
    assert np.all(ned[1:, 3] > 0)
    np.testing.assert_allclose(enu_yaw_from_ned(yaw), np.pi / 2 - yaw)


def test_a_pure_roll_to_the_right_lowers_the_right_side():
    ned, enu = attitude("pure roll")
    roll = 0.3 * TIMES
    for i in range(1, len(TIMES)):
        right = turned(enu[i], [0, -1, 0])
        np.testing.assert_allclose(right, np.cos(roll[i]) * EAST - np.sin(roll[i]) * UP, atol=1e-14)
        np.testing.assert_allclose(turned(enu[i], [1, 0, 0]), NORTH, atol=1e-14)
    np.testing.assert_allclose(ned[:, 1], np.sin(roll / 2), atol=1e-15)


@pytest.mark.parametrize("frame", ["ned", "enu"])
@pytest.mark.parametrize("name", MOTIONS)
def test_body_rates_are_the_rates_at_which_the_attitude_turns(name, frame):
    step = 1e-5
    around = [state_of(MOTIONS[name], TIMES + shift)[:, 6:9] for shift in (-step, 0, step)]
    rates = state_of(MOTIONS[name], TIMES)[:, 9:12]
    q = [quaternion_of_angles(angles) for angles in around]
    if frame == "enu":
        q, rates = [enu_attitude_from_ned(each) for each in q], flu_from_frd(rates)
    derivative = (q[2] - q[0]) / (2 * step)
    pure = np.concatenate([np.zeros((len(TIMES), 1)), rates], axis=1)
    np.testing.assert_allclose(derivative, 0.5 * quaternion_product(q[1], pure), atol=1e-9)


def test_body_vectors_come_out_in_the_right_world():
    body = np.array([[0.3, -0.5, 0.7]] * len(TIMES))
    ned, enu = attitude("asymmetric path")
    np.testing.assert_allclose(
        rotated(enu, flu_from_frd(body)), enu_from_ned(rotated(ned, body)), atol=1e-14
    )


def test_signs_do_not_jump_when_the_craft_turns_round_and_round():
    angles = np.zeros((400, 3))
    angles[:, 2] = np.linspace(-3, 20, 400)
    q = quaternion_of_angles(angles)
    assert q[0, 0] >= 0
    assert np.all(np.einsum("mi,mi->m", q[:-1], q[1:]) > 0.99)
    mixed = q * np.where(np.arange(400) % 3 == 0, -1, 1)[:, None]
    np.testing.assert_array_equal(continuous(mixed), q)


SIGNED_PERMUTATIONS = [
    np.eye(3)[list(order)] * np.array(signs)[:, None]
    for order in permutations(range(3))
    for signs in product((1.0, -1.0), repeat=3)
]


@pytest.mark.parametrize("columns", [(0, 1, 2), (3, 4, 5), (9, 10, 11)])
def test_the_asymmetric_path_would_show_every_wrong_choice_of_axes(columns):
    """No two of the 48 ways to name and sign three axes look alike on it."""
    vectors = state_of(MOTIONS["asymmetric path"], TIMES)[:, list(columns)]
    for one, other in combinations(SIGNED_PERMUTATIONS, 2):
        assert np.abs(vectors @ one.T - vectors @ other.T).max() > 0.05


@pytest.mark.parametrize("frame", [0, 1], ids=["ned", "enu"])
def test_the_asymmetric_path_would_show_every_wrong_order_or_sign_of_a_quaternion(frame):
    q = attitude("asymmetric path")[frame]
    right = Rotation.from_quat(q[:, [1, 2, 3, 0]])
    seen = 0
    for order, signs in product(permutations(range(4)), product((1.0, -1.0), repeat=4)):
        if order == (0, 1, 2, 3) and len(set(signs)) == 1:
            continue  # q and −q are one rotation
        wrong = Rotation.from_quat((q[:, list(order)] * signs)[:, [1, 2, 3, 0]])
        assert (wrong * right.inv()).magnitude().max() > 0.05, (order, signs)
        seen += 1
    assert seen == 24 * 16 - 2


@given(
    npst.arrays(float, 3, elements=st.floats(-3.1, 3.1)),
    npst.arrays(float, 3, elements=st.floats(-9, 9)),
)
def test_turning_the_axes_twice_brings_them_back(angles, vector):
    q = quaternion_of_angles(angles[None])
    np.testing.assert_array_equal(enu_from_ned(enu_from_ned(vector)), vector)
    np.testing.assert_array_equal(flu_from_frd(flu_from_frd(vector)), vector)
    twice = enu_attitude_from_ned(enu_attitude_from_ned(q))
    assert abs(abs(np.sum(q * twice)) - 1) < 1e-12
    turned_body = rotated(enu_attitude_from_ned(q), flu_from_frd(vector[None]))
    np.testing.assert_allclose(turned_body, enu_from_ned(rotated(q, vector[None])), atol=1e-13)


def test_the_other_order_of_quaternions_moves_w_only():
    np.testing.assert_array_equal(x_first(np.array([1.0, 2.0, 3.0, 4.0])), [2.0, 3.0, 4.0, 1.0])
