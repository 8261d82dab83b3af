"""Projection, bodies, hiding and the craft obey closed forms."""

import numpy as np
import pytest
from gallery import SURROUNDINGS, flight
from hypothesis import given
from hypothesis import strategies as st

from skyknot.missions import vehicles
from skyknot.models.quadrotor import rotation as model_rotation
from skyknot.problem import airspace
from skyknot.report.camera import Camera, east_north_up
from skyknot.report.craft import craft_shape, rotation, rotor_radius, span
from skyknot.report.reading import Reading
from skyknot.report.scene import Scene
from skyknot.report.solids import solids_of

angles = st.floats(-1.4, 1.4)
lengths = st.floats(-50.0, 50.0)


@given(angles, angles, angles)
def test_the_rotation_drawn_is_the_rotation_flown(roll, pitch, yaw):
    flown = np.array(model_rotation(roll, pitch, yaw), dtype=float).reshape(3, 3)
    assert np.allclose(rotation(roll, pitch, yaw), flown, atol=1e-14)


def test_north_east_down_becomes_east_north_up_without_mirroring():
    axes = east_north_up(np.eye(3))
    assert np.array_equal(axes, [[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    assert np.linalg.det(axes) == pytest.approx(1.0)


@given(st.floats(-3, 3), st.floats(0.1, 1.4), st.floats(1, 8), lengths, lengths, lengths, lengths)
def test_points_along_the_ray_fall_together_and_come_nearer(a, e, k, x, y, z, t):
    camera, P = Camera(a, e, k), np.array([x, y, z])
    moved = P + t * camera.ray
    assert np.allclose(camera.project(moved), camera.project(P), atol=1e-9)
    assert camera.depth(moved) - camera.depth(P) == pytest.approx(t, abs=1e-9)


def test_up_is_up_on_paper_and_north_is_away():
    camera = Camera(np.deg2rad(-60), np.deg2rad(25))
    assert np.allclose(camera.project(np.array([0, 0, 1.0])), [0, np.cos(np.deg2rad(25))])
    assert camera.depth(np.array([0, 1.0, 0])) < 0
    assert camera.project(np.array([1.0, 0, 0]))[0] > 0


def volume(solid):
    """Return the volume by the divergence theorem on its faces."""
    _, offsets = solid.planes
    areas = []
    for face in solid.faces:
        cross = np.cross(face, np.roll(face, -1, axis=0)).sum(axis=0)
        areas.append(0.5 * np.linalg.norm(cross))
    return float(np.dot(areas, offsets)) / 3


def test_bodies_have_the_volumes_of_their_shapes():
    def body(constraint):
        (solid,) = solids_of(constraint.name, constraint.shape, 0.0, 10.0)
        return solid

    n = 40
    polygon = 0.5 * n * np.sin(2 * np.pi / n)
    box = airspace.box("b", (1, 2, -3), (2, 4, 6), yaw=0.7)
    assert volume(body(box)) == pytest.approx(48.0)
    cylinder = airspace.cylinder("c", (1, 2), 3.0)
    assert volume(body(cylinder)) == pytest.approx(polygon * 9 * 10)
    ball = airspace.ellipsoid("e", (0, 0, 0), (1, 2, 3))
    assert volume(body(ball)) == pytest.approx(4 / 3 * np.pi * 6, rel=0.05)
    assert all(np.allclose(body(box).vertices.mean(axis=0), [2, 1, 3]) for _ in range(1))


def test_a_body_of_unlimited_height_reaches_from_floor_to_top():
    (solid,) = solids_of("c", airspace.cylinder("c", (1, 2), 3.0).shape, -1.0, 7.0)
    assert (solid.vertices[:, 2].min(), solid.vertices[:, 2].max()) == (-1.0, 7.0)


def test_a_tube_has_a_leg_between_all_its_corners_and_is_a_room():
    shape = airspace.tube("t", [(0, 0, 0), (5, 0, 0), (5, 5, 0)], 1.0).shape
    legs = solids_of("t", shape, 0.0, 1.0)
    assert len(legs) == 2
    assert all(leg.keep_in for leg in legs)


@given(lengths, lengths, lengths)
def test_a_box_hides_what_the_slabs_say(x, y, z):
    """Against the closed form: intervals of t where each coordinate lies within the box."""
    (solid,) = solids_of("b", airspace.box("b", (0, 0, 0), (20, 10, 6)).shape, 0.0, 1.0)
    ray = Camera(-1.0, 0.4).ray
    half = np.array([5.0, 10.0, 3.0])
    P = np.array([x, y, z])
    first, second = (-half - P) / ray, (half - P) / ray
    enter, leave = np.minimum(first, second).max(), np.maximum(first, second).min()
    expected = leave > max(enter, 1e-9)
    assert bool(solid.hides(P[None], ray)[0]) == expected


def test_the_faces_turned_to_the_viewer_of_a_box_are_three():
    (solid,) = solids_of("b", airspace.box("b", (0, 0, 0), (2, 2, 2)).shape, 0.0, 1.0)
    normals = np.array([normal for _, normal in solid.facing(Camera(-1.0, 0.4))])
    assert np.allclose(np.sort(normals, axis=0).sum(axis=0), [1, -1, 1])


def test_every_shape_of_the_airspace_is_known():
    for constraint in SURROUNDINGS:
        drawn = solids_of(constraint.name, constraint.shape, 0.0, 10.0)
        assert drawn or constraint.shape.kind in ("band", "half-space")


def test_front_rotors_point_north_at_yaw_zero_and_east_after_a_quarter_turn():
    craft = vehicles.load("hummingbird")
    north = craft_shape(craft, np.zeros(3), 1.0)
    east = craft_shape(craft, np.array([0, 0, np.pi / 2]), 1.0)
    assert np.all(north.arms[north.front, 1, 1] > 0)
    assert np.all(east.arms[east.front, 1, 0] > 0)
    assert np.all(north.discs.mean(axis=1)[:, 2] > 0)


def test_a_positive_roll_lowers_the_right_rotors():
    craft = vehicles.load("hummingbird")
    rolled = craft_shape(craft, np.array([0.3, 0, 0]), 1.0)
    right = np.asarray(craft.rotor_positions)[:, 1] > 0
    assert np.all(rolled.arms[right, 1, 2] < 0)
    assert np.all(rolled.arms[~right, 1, 2] > 0)


def test_the_drawn_craft_scales_and_its_span_includes_the_rotors():
    craft = vehicles.load("hummingbird")
    once, twice = (craft_shape(craft, np.zeros(3), scale) for scale in (1.0, 2.0))
    assert np.allclose(twice.discs, 2 * once.discs)
    hubs = np.linalg.norm(craft.rotor_positions, axis=1).max()
    assert span(craft) == pytest.approx(2 * (hubs + rotor_radius(craft)))


def test_the_ground_holds_the_path_and_the_bodies():
    scene = Scene(Reading(flight()))
    low, high = scene.stage.low, scene.stage.high
    assert np.all(scene.path >= low - 1e-9)
    assert np.all(scene.path <= high + 1e-9)
    for solid in scene.bodies:
        assert np.all(solid.vertices[:, :2] >= low[:2] - 1e-9)
        assert np.all(solid.vertices[:, :2] <= high[:2] + 1e-9)
