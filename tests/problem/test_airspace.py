"""Claim: an obstacle's margin has the right sign and never exceeds the true distance.

The true distance comes from the shape's definition: closed form for spheres, cylinders, planes,
corridors; projection for boxes; brute force over the surface for ellipsoids.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import skyknot as sk
from skyknot.problem import airspace

COORDINATE = st.floats(-30.0, 30.0)
POSITIONS = st.tuples(COORDINATE, COORDINATE, COORDINATE)
SIZE = st.floats(0.2, 12.0)
CLEARANCE = st.floats(0.0, 2.0)


def margin(constraint, position):
    """Return constraint value minus its lower bound at a position, metres."""
    x = ca.DM([*position, *[0.0] * 9])
    value = float(constraint.function(x, ca.DM.zeros(4)))
    return value - constraint.lower


def signed_box_distance(rel, half):
    """Return the distance to a box from its centre's frame, negative inside."""
    q = np.abs(rel) - half
    return np.linalg.norm(np.maximum(q, 0)) + min(q.max(), 0)


@given(position=POSITIONS, radius=SIZE, clearance=CLEARANCE)
def test_cylinder_margins_are_never_optimistic(position, radius, clearance):
    tower = sk.cylinder("tower", (1.0, -2.0), radius, clearance=clearance)
    true = np.hypot(position[0] - 1.0, position[1] + 2.0) - radius - clearance
    found = margin(tower, position)
    assert found <= max(true, 0) + 1e-9
    assert np.sign(found) == np.sign(true) or abs(true) < 1e-9


@given(position=POSITIONS, radius=SIZE, clearance=CLEARANCE)
def test_sphere_margins_are_never_optimistic(position, radius, clearance):
    balloon = sk.sphere("balloon", (1.0, -2.0, -5.0), radius, clearance=clearance)
    true = np.linalg.norm(np.array(position) - [1.0, -2.0, -5.0]) - radius - clearance
    found = margin(balloon, position)
    assert found <= max(true, 0) + 1e-9
    assert np.sign(found) == np.sign(true) or abs(true) < 1e-9


@given(position=POSITIONS, size=st.tuples(SIZE, SIZE, SIZE), yaw=st.floats(-3, 3), c=CLEARANCE)
def test_box_margins_are_never_optimistic(position, size, yaw, c):
    building = sk.box("building", (2.0, 1.0, -6.0), size, yaw=yaw, clearance=c)
    R = np.array([[np.cos(yaw), np.sin(yaw), 0], [-np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    rel = R @ (np.array(position) - [2.0, 1.0, -6.0])
    true = signed_box_distance(rel, np.array(size) / 2)
    assert margin(building, position) <= true - c + 1e-9


@given(size=st.tuples(SIZE, SIZE, SIZE), yaw=st.floats(-3, 3), across=POSITIONS)
def test_a_box_seen_from_far_or_from_within_has_the_right_sign(size, yaw, across):
    building = sk.box("building", (0.0, 0.0, 0.0), size, yaw=yaw)
    inside = np.array([np.cos(yaw), np.sin(yaw), 0.0]) * 0.4 * size[0]
    assert margin(building, inside) < 0
    direction = np.add(across, [0.0, 0.0, 31.0])
    outside = direction / np.linalg.norm(direction) * 2 * np.linalg.norm(size)
    assert margin(building, outside) > 0


@given(position=POSITIONS, semi_axes=st.tuples(SIZE, SIZE, SIZE), clearance=CLEARANCE)
def test_ellipsoid_margins_are_never_optimistic(position, semi_axes, clearance):
    cloud = sk.ellipsoid("cloud", (1.0, -2.0, -5.0), semi_axes, clearance=clearance)
    axes = np.array(semi_axes)
    rel = np.array(position) - [1.0, -2.0, -5.0]
    outside = np.sum((rel / axes) ** 2) > 1
    found = margin(cloud, position)
    if outside:
        polar, turn = np.meshgrid(np.linspace(0, np.pi, 60), np.linspace(0, 2 * np.pi, 120))
        surface = axes[:, None] * np.array(
            [
                (np.sin(polar) * np.cos(turn)).ravel(),
                (np.sin(polar) * np.sin(turn)).ravel(),
                np.cos(polar).ravel(),
            ]
        )
        # the surface is sampled, so the brute distance is an upper bound of the true one
        brute = np.linalg.norm(surface - rel[:, None], axis=0).min()
        assert found <= max(brute - clearance, 0) + 1e-9
        assert found >= -1e-9 or brute < 3 * (clearance + 1e-9)
    else:
        assert found <= 1e-9


def test_a_long_ellipsoid_keeps_its_clearance_beside_its_tip():
    """Adding the clearance to the semi-axes would let a position come within 1.3 m of 2 m here."""
    cloud = sk.ellipsoid("cloud", (0.0, 0.0, 0.0), (10.0, 0.2, 0.2), clearance=2.0)
    assert margin(cloud, (10.8, 0.96, 0.0)) < 0
    assert margin(cloud, (0.0, 4.1, 0.0)) > 0


@given(position=POSITIONS, normal=POSITIONS.filter(lambda n: np.linalg.norm(n) > 0.1))
def test_half_space_margins_are_the_distance_to_the_plane(position, normal):
    wall = sk.half_space("wall", normal, 3.0)
    true = np.dot(normal, position) / np.linalg.norm(normal) - 3.0
    assert margin(wall, position) == pytest.approx(true, abs=1e-9)


@given(position=POSITIONS, end=POSITIONS.filter(lambda n: np.linalg.norm(n) > 0.1), radius=SIZE)
def test_corridor_margins_are_never_optimistic(position, end, radius):
    lane = sk.corridor("lane", (0.0, 0.0, 0.0), end, radius)
    along = np.array(end) / np.linalg.norm(end)
    off = np.array(position) - np.dot(position, along) * along
    true = radius - np.linalg.norm(off)
    found = margin(lane, position)
    assert found <= true + 1e-9
    if true > 0:  # smooth on the axis at the price of up to half the distance inside
        assert found >= 0.5 * true - 1e-9


@pytest.mark.parametrize(
    "make",
    [
        lambda: sk.cylinder("c", (0.0, 0.0), 2.0),
        lambda: sk.sphere("s", (0.0, 0.0, 0.0), 2.0),
        lambda: sk.ellipsoid("e", (0.0, 0.0, 0.0), (2.0, 2.0, 2.0)),
    ],
)
def test_on_the_surface_the_margin_is_zero(make):
    assert margin(make(), (2.0, 0.0, 0.0)) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    "make",
    [
        lambda: sk.cylinder("c", (0.0, 0.0), 2.0),
        lambda: sk.sphere("s", (0.0, 0.0, 0.0), 2.0),
        lambda: sk.ellipsoid("e", (0.0, 0.0, 0.0), (2.0, 1.0, 3.0)),
        lambda: sk.box("b", (0.0, 0.0, 0.0), (2.0, 1.0, 3.0)),
        lambda: sk.corridor("k", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 2.0),
        lambda: sk.speed_limit("v", 5.0),
        lambda: sk.tilt_limit("t", 0.5),
    ],
)
def test_slopes_exist_everywhere_even_at_the_centre(make):
    x = ca.SX.sym("x", 12)
    slope = ca.Function("slope", [x], [ca.gradient(make().function(x, ca.SX(4, 1)), x)])
    for point in (np.zeros(12), np.ones(12), np.eye(12)[0]):
        assert np.all(np.isfinite(np.asarray(slope(point))))


def test_the_altitude_band_counts_metres_up():
    band = sk.altitude_band("band", 10.0, 120.0)
    height = float(band.function(ca.DM([0.0, 0.0, -50.0]), None))
    assert height == 50.0
    assert (band.lower, band.upper) == (10.0, 120.0)


@given(velocity=POSITIONS, fastest=SIZE)
def test_the_speed_limit_is_never_optimistic(velocity, fastest):
    limit = sk.speed_limit("speed", fastest)
    x = ca.DM([0.0, 0.0, 0.0, *velocity, *[0.0] * 6])
    assert float(limit.function(x, None)) >= np.linalg.norm(velocity) - 1e-12
    assert limit.upper == fastest


@given(roll=st.floats(-1.4, 1.4), pitch=st.floats(-1.4, 1.4), yaw=st.floats(-3, 3))
def test_tilt_is_the_angle_between_thrust_and_vertical(roll, pitch, yaw):
    """The third column of Rz Ry Rx dotted with z is cos φ cos θ."""
    limit = sk.tilt_limit("tilt", 0.6)
    x = ca.DM([0.0] * 6 + [roll, pitch, yaw] + [0.0] * 3)
    angle = np.arccos(float(limit.function(x, None)))
    assert (angle <= 0.6) == (np.cos(roll) * np.cos(pitch) >= np.cos(0.6))
    assert limit.lower == pytest.approx(np.cos(0.6))


@pytest.mark.parametrize(
    ("make", "where"),
    [
        (lambda: sk.cylinder("tower", (0, 0), 0.0), "tower.radius"),
        (lambda: sk.cylinder("tower", (0, 0, 0), 1.0), "tower.center"),
        (lambda: sk.sphere("ball", (0, 0, np.nan), 1.0), "ball.center"),
        (lambda: sk.sphere("ball", (0, 0, 0), -1.0), "ball.radius"),
        (lambda: sk.ellipsoid("egg", (0, 0, 0), (1, 0, 1)), "egg.semi_axes"),
        (lambda: sk.box("house", (0, 0, 0), (1, 1)), "house.size"),
        (lambda: sk.box("house", (0, 0, 0), (1, 1, -1)), "house.size"),
        (lambda: sk.half_space("wall", (0, 0, 0), 1.0), "wall.length of normal"),
        (lambda: sk.corridor("lane", (1, 1, 1), (1, 1, 1), 1.0), "lane.length"),
        (lambda: sk.corridor("lane", (0, 0, 0), (1, 1, 1), 0.0), "lane.radius"),
        (lambda: sk.altitude_band("band", 50.0, 10.0), "band"),
        (lambda: sk.speed_limit("speed", 0.0), "speed.fastest"),
        (lambda: sk.tilt_limit("tilt", -0.1), "tilt.steepest"),
        (lambda: sk.cylinder("tower", (0, 0), 1.0, clearance=-2.0), "tower.clearance"),
        (lambda: sk.box("house", (0, 0, 0), (1, 1, 1), clearance=np.nan), "house.clearance"),
    ],
)
def test_a_shape_without_a_size_or_place_is_refused(make, where):
    with pytest.raises(sk.UserError, match="where:") as caught:
        make()
    assert where in caught.value.where
    assert all(caught.value.parts().values())


def test_every_obstacle_carries_what_to_draw():
    made = [
        sk.cylinder("a", (0, 0), 1.0),
        sk.sphere("b", (0, 0, 0), 1.0),
        sk.ellipsoid("c", (0, 0, 0), (1, 2, 3)),
        sk.box("d", (0, 0, 0), (1, 2, 3), yaw=0.3),
        sk.half_space("e", (0, 0, 1), 0.0),
        sk.corridor("f", (0, 0, 0), (1, 0, 0), 1.0),
        sk.altitude_band("g", 0.0, 10.0),
    ]
    kinds = [constraint.shape.kind for constraint in made]
    assert kinds == ["cylinder", "sphere", "ellipsoid", "box", "half-space", "corridor", "band"]
    assert [constraint.shape.keep_in for constraint in made] == [False] * 4 + [True] * 3
    assert airspace.Shape("box", {}).keep_in is False


def test_the_shortest_way_round_a_tower_is_two_tangents_and_an_arc():
    """Unit speed from (−2, 0) to (2, 0) round a unit circle: 2√3 + π/3."""
    problem = sk.Problem(
        "round the tower",
        ["x", "y", "z"],
        ["heading"],
        lambda x, u: [ca.cos(u[0]), ca.sin(u[0]), 0 * u[0]],
        horizon=sk.Free(4.0, 9.0, 5.0),
        initial=[-2.0, 0.0, 0.0],
        final=[2.0, 0.0, 0.0],
        terminal_cost=lambda x, tf: tf,
        path=[sk.cylinder("tower", (0.0, 0.0), 0.8, clearance=0.2)],
    )
    s = np.linspace(0, 1, 21)
    bow = sk.Trajectory(
        5 * s,
        np.stack([4 * s - 2, 1.2 * np.sin(np.pi * s), 0 * s], axis=1),
        np.arctan2(1.2 * np.pi * np.cos(np.pi * s), 4)[:, None],
    )
    solution = sk.solve(problem, sk.HermiteSimpson(40), guess=bow, tolerance=1e-8)
    assert solution.success, solution.message
    assert solution.objective == pytest.approx(2 * np.sqrt(3) + np.pi / 3, rel=1e-4)
    assert np.linalg.norm(solution.states[:, :2], axis=1).min() > 1 - 1e-7
