"""Claim: rotor thrusts make the wrench that r × F and the spin's reaction say, and back."""

from __future__ import annotations

import casadi
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from skyknot.errors import UserError
from skyknot.models import Allocation

THRUSTS = st.tuples(*[st.floats(0.0, 10.0)] * 4).map(np.array)
HEXAROTOR = Allocation(
    positions=tuple(
        (0.215 * float(np.cos(angle)), 0.215 * float(np.sin(angle)))
        for angle in np.deg2rad([30, 90, 150, -150, -90, -30])
    ),
    spins=(1, -1, 1, -1, 1, -1),
    kappa=0.016,
)
LAYOUTS = [
    Allocation.x(0.25, 0.02),
    Allocation.x_levers(0.1, 0.2, 0.02),
    Allocation.plus(0.3, 0.03),
    HEXAROTOR,
]


@given(f=THRUSTS)
@pytest.mark.parametrize("allocation", LAYOUTS[:3])
def test_wrench_is_the_sum_of_cross_products_and_reactions(allocation, f):
    torque = np.zeros(3)
    for hub, spin, thrust in zip(allocation.rotor_positions, allocation.spins, f, strict=True):
        torque += np.cross(hub, [0.0, 0.0, -thrust])
        rotor_turns_about = np.array([0.0, 0.0, float(spin)])  # clockwise from above: about +z down
        torque -= rotor_turns_about * allocation.kappa * thrust
    np.testing.assert_allclose(allocation.wrench(f), [f.sum(), *torque], atol=1e-12)


@pytest.mark.parametrize("allocation", LAYOUTS)
def test_wrench_of_the_inverse_is_the_wrench(allocation):
    wrench = np.random.default_rng(2).normal(size=(5, 3, 4))
    thrusts = allocation.rotor_thrusts(wrench)
    assert thrusts.shape == (5, 3, allocation.rotor_count)
    np.testing.assert_allclose(allocation.wrench(thrusts), wrench, atol=1e-12)


@pytest.mark.parametrize("allocation", LAYOUTS[:3])
def test_pure_commands_move_the_right_rotors(allocation):
    x, y, _ = allocation.rotor_positions.T
    spins = np.array(allocation.spins)
    roll, pitch, yaw = (allocation.rotor_thrusts(np.eye(4)[axis]) for axis in (1, 2, 3))
    np.testing.assert_array_equal(np.sign(roll.round(9)), -np.sign(y))  # roll right: left pushes
    np.testing.assert_array_equal(np.sign(pitch.round(9)), np.sign(x))  # nose up: front pushes
    np.testing.assert_array_equal(np.sign(yaw.round(9)), -spins)  # nose right: CCW rotors push
    for thrusts in (roll, pitch, yaw):
        assert thrusts.sum() == pytest.approx(0.0, abs=1e-12)


def test_hexarotor_chooses_the_least_thrusts():
    thrusts = HEXAROTOR.rotor_thrusts(np.array([12.0, 0.1, -0.2, 0.05]))
    null = np.linalg.svd(HEXAROTOR.matrix)[2][4:]
    np.testing.assert_allclose(null @ thrusts, 0.0, atol=1e-12)


def test_diagonal_rotors_of_an_x_turn_the_same_way():
    hubs, spins = LAYOUTS[0].rotor_positions, LAYOUTS[0].spins
    for i, hub in enumerate(hubs):
        opposite = int(np.argmin(np.linalg.norm(hubs + hub, axis=1)))
        assert spins[i] == spins[opposite]


def test_arm_is_the_distance_to_the_hub():
    for allocation in (Allocation.x(0.25, 0.02), Allocation.plus(0.25, 0.02)):
        np.testing.assert_allclose(np.linalg.norm(allocation.rotor_positions, axis=1), 0.25)


def test_casadi_wrenches_give_casadi_thrusts():
    u, numbers = casadi.SX.sym("u", 4), np.array([9.0, 0.1, 0.2, -0.05])
    for allocation in LAYOUTS:
        thrusts = casadi.Function("f", [u], [allocation.rotor_thrusts(u)])(numbers)
        np.testing.assert_allclose(thrusts.full().ravel(), allocation.rotor_thrusts(numbers))
        back = allocation.wrench([thrusts[i] for i in range(allocation.rotor_count)])
        np.testing.assert_allclose(back.full().ravel(), numbers, atol=1e-12)


def test_skydio_x2_as_published_is_refused_naming_yaw_and_roll():
    # MuJoCo Menagerie skydio_x2/x2.xml: yaw gear signs -, +, +, - in the order rear right,
    # rear left, front left, front right, so that both right rotors turn the same way.
    hubs = ((-0.14, 0.18), (-0.14, -0.18), (0.14, -0.18), (0.14, 0.18))
    with pytest.raises(UserError, match="cannot command yaw on its own") as caught:
        Allocation(positions=hubs, spins=(1, -1, -1, 1), kappa=0.0201)
    assert "yaw row is 0.1117 times the roll row" in caught.value.what
    assert "rank 3" in caught.value.found
    assert "diagonal rotors" in caught.value.do
    assert Allocation(positions=hubs, spins=(1, -1, 1, -1), kappa=0.0201).rotor_count == 4


@pytest.mark.parametrize(
    ("positions", "spins", "sentence"),
    [
        (((1, 1), (-1, -1), (1, -1), (-1, 1)), (1, 1, 1, 1), "yaw row is -0.02 times the thrust"),
        (((0, 1), (0, -1), (0, 2), (0, -2)), (1, -1, -1, 1), "no rotor makes any pitch torque"),
        (((1, 0), (-1, 0), (2, 0), (-2, 0)), (1, -1, -1, 1), "no rotor makes any roll torque"),
        (((1, 1), (-1, -1), (1, -1)), (1, 1, -1), "cannot command"),
        (((0, 1), (1, 0), (0, -1), (-1, 0)), (1, 1, -1, -1), "rows roll, pitch, yaw depend"),
    ],
)
def test_lost_axes_are_named(positions, spins, sentence):
    with pytest.raises(UserError, match=sentence):
        Allocation(positions=positions, spins=spins, kappa=0.02)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"spins": (1, -1, 1)}, "not one spin each"),
        ({"spins": (1, -1, 1, 0)}, "neither clockwise nor counter-clockwise"),
        ({"kappa": -0.02}, "not a positive length"),
        ({"positions": ((np.nan, 1), (-1, -1), (1, -1), (-1, 1))}, "not a finite number"),
    ],
)
def test_impossible_entries_are_refused(changes, sentence):
    good = LAYOUTS[0]
    entries = {"positions": good.positions, "spins": good.spins, "kappa": good.kappa}
    with pytest.raises(UserError, match=sentence):
        Allocation(**(entries | changes))
