"""Claim: every model of the room keeps the numbered contract of its base."""

from __future__ import annotations

import inspect

import casadi
import newton_euler
import numpy as np
import pytest
from craft import random_state, random_wrench, sample_vehicle

from skyknot.models import Model

DRAG = (0.3, 0.2, 0.5)
WIND = (4.0, -2.0, 1.0)
MODELS = {
    "wrench": lambda: sample_vehicle().wrench_model(),
    "wrench, drag, wind": lambda: sample_vehicle(drag=DRAG).wrench_model().with_wind(WIND),
    "rotors": lambda: sample_vehicle().rotor_model(),
    "rotors, drag, wind": lambda: sample_vehicle(drag=DRAG).rotor_model().with_wind(WIND),
    "translational yaw": lambda: sample_vehicle().translational_yaw_model(),
}


@pytest.fixture(params=MODELS, name="model")
def each_model(request):
    return MODELS[request.param]()


def random_point(model, seed):
    random = np.random.default_rng(seed)
    if len(model.state_names) == 12:
        u = random_wrench(random)
        return random_state(random), u if model.control_names[0] == "T" else random.uniform(1, 8, 4)
    return random.normal(size=7), random.normal(size=4)


def leaves(parent):
    for child in parent.__subclasses__():
        yield child
        yield from leaves(child)


def test_every_leaf_of_the_room_is_under_this_contract():
    assert {type(build()) for build in MODELS.values()} == set(leaves(Model))


def test_casadi_jacobian_agrees_with_complex_step(model):
    nx, nu = len(model.state_names), len(model.control_names)
    x, u = casadi.SX.sym("x", nx), casadi.SX.sym("u", nu)
    f = casadi.vertcat(*model.dynamics(x, u))
    jacobian = casadi.Function("jacobian", [x, u], [casadi.jacobian(f, casadi.vertcat(x, u))])
    for seed in range(5):
        point = random_point(model, seed)
        expected = newton_euler.complex_step_jacobian(
            lambda w: model.dynamics(w[:nx], w[nx:]), np.concatenate(point)
        )
        np.testing.assert_allclose(jacobian(*point).full(), expected, rtol=1e-10, atol=1e-10)


def test_wrench_jacobian_agrees_with_independent_matrices():
    vehicle = sample_vehicle(drag=DRAG)
    model = vehicle.wrench_model().with_wind(WIND)
    point = np.concatenate(random_point(model, 11))
    body = (vehicle.mass, vehicle.inertia, vehicle.gravity, DRAG, WIND)
    expected = newton_euler.complex_step_jacobian(
        lambda w: newton_euler.derivative(w[:12], w[12:], *body), point
    )
    found = newton_euler.complex_step_jacobian(lambda w: model.dynamics(w[:12], w[12:]), point)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("kind", [casadi.SX, casadi.MX])
def test_symbols_numbers_and_casadi_matrices_give_the_same_values(model, kind):
    nx, nu = len(model.state_names), len(model.control_names)
    x, u = kind.sym("x", nx), kind.sym("u", nu)
    f = casadi.Function("f", [x, u], [casadi.vertcat(*model.dynamics(x, u))])
    point = random_point(model, 3)
    plain = np.array(model.dynamics(*point), dtype=float)
    listed = np.array(model.dynamics(*(entry.tolist() for entry in point)), dtype=float)
    dense = casadi.vertcat(*model.dynamics(*(casadi.DM(entry) for entry in point)))
    for found in (f(*point).full().ravel(), listed, dense.full().ravel()):
        np.testing.assert_allclose(found, plain, rtol=1e-13, atol=1e-13)


def test_names_and_units_match_the_sizes_and_are_unique(model):
    x, u = random_point(model, 0)
    assert len(model.state_names) == len(set(model.state_names)) == len(x)
    assert len(model.control_names) == len(set(model.control_names)) == len(u)
    assert len(model.state_units) == len(model.dynamics(x, u)) == len(x)
    assert len(model.control_units) == len(u)
    assert model.frame == "NED"
    assert "deg" in model.singularity_note
    assert model.name


def test_dynamics_take_exactly_state_and_control(model):
    assert list(inspect.signature(model.dynamics).parameters) == ["x", "u"]


def test_trim_is_an_equilibrium_in_still_air_inside_the_bounds(model):
    still = model.with_wind([0, 0, 0]) if hasattr(model, "with_wind") else model
    rates = np.array(still.dynamics(model.trim_state, model.trim_control), dtype=float)
    np.testing.assert_allclose(rates, 0.0, atol=1e-13)
    lower, upper = model.control_bounds
    assert np.all(np.isfinite(lower))
    assert np.all(np.isfinite(upper))
    assert np.all(lower < model.trim_control)
    assert np.all(model.trim_control < upper)
    below, above = model.state_bounds
    assert np.all(below <= model.trim_state)
    assert np.all(model.trim_state <= above)


def test_scales_are_positive_and_no_smaller_than_trim(model):
    assert model.state_scales.shape == (len(model.state_names),)
    assert model.control_scales.shape == (len(model.control_names),)
    assert np.all(model.state_scales > 0)
    assert np.all(np.isfinite(model.state_scales))
    assert np.all(model.control_scales > 0)
    assert np.all(model.control_scales >= np.abs(model.trim_control))


def test_rotors_share_the_weight_equally_at_hover(model):
    vehicle = sample_vehicle()
    expected = vehicle.mass * vehicle.gravity / 4
    np.testing.assert_allclose(model.rotor_thrusts(model.trim_control), expected, rtol=1e-12)
    many = model.rotor_thrusts(np.tile(model.trim_control, (3, 2, 1)))
    assert many.shape == (3, 2, 4)


def test_bounds_are_copies_nobody_can_spoil(model):
    model.control_bounds[1][:] = -99.0
    model.state_bounds[1][:] = -99.0
    assert np.all(model.control_bounds[1] > -99.0)
    assert np.all(model.state_bounds[1] > -99.0)


def test_pitch_is_kept_off_the_singularity_and_roll_is_free():
    lower, upper = sample_vehicle().state_bounds
    assert upper[7] == pytest.approx(np.deg2rad(85.0))
    assert lower[7] == pytest.approx(-np.deg2rad(85.0))
    assert np.isinf(upper[6])
    assert "85 deg" in sample_vehicle().wrench_model().singularity_note
