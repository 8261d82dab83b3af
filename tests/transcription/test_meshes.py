"""Claim: meshes cover the horizon, point constraints get their nodes, bounds hold where asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import skyknot as sk
from skyknot.kernel.rows import RELAXATION
from skyknot.transcription.mesh import checked, uniform, with_nodes_at


def hill(**extras):
    """A double integrator whose free flight rises to 0.25 in the middle."""
    asked = {
        "name": "hill",
        "states": ["x", "v"],
        "controls": ["a"],
        "dynamics": lambda x, u: [x[1], u[0]],
        "horizon": 1.0,
        "initial": [0.0, 1.0],
        "final": [0.0, -1.0],
        "running_cost": lambda x, u: 0.5 * u[0] ** 2,
    }
    return sk.Problem(**(asked | extras))


def test_equal_segments_are_equal():
    np.testing.assert_allclose(uniform(4), [0, 0.25, 0.5, 0.75, 1])


@pytest.mark.parametrize("segments", [0, -3, 2.5, "many"])
def test_a_mesh_without_segments_is_refused(segments):
    with pytest.raises(sk.UserError, match="at least one segment") as caught:
        sk.HermiteSimpson(segments)
    assert caught.value.where == "segments"
    assert str(segments) in caught.value.found


@pytest.mark.parametrize(
    ("mesh", "complaint"),
    [
        ([0.0, 2.0], "does not cover the horizon"),
        ([0.1, 1.0], "does not cover the horizon"),
        ([0.0], "does not cover the horizon"),
        ([[0.0, 1.0]], "does not cover the horizon"),
        ([0.0, 0.6, 0.4, 1.0], "do not increase"),
        ([0.0, 0.5, 0.5, 1.0], "do not increase"),
        ([0.0, np.nan, 1.0], "do not increase"),
        ([], "does not cover the horizon"),
    ],
)
def test_a_malformed_mesh_is_refused(mesh, complaint):
    with pytest.raises(sk.UserError, match=complaint) as caught:
        sk.Trapezoid(mesh=mesh)
    assert caught.value.where == "mesh"


def test_ends_within_rounding_are_accepted():
    nodes = checked([0.0, 0.5, 1.0 - 1e-15])
    assert len(nodes) == 3


def test_a_place_that_is_a_node_adds_none():
    np.testing.assert_array_equal(with_nodes_at(uniform(4), [0.5, 0.25 + 1e-15]), uniform(4))


def test_a_place_between_nodes_adds_one():
    np.testing.assert_allclose(with_nodes_at(uniform(2), [0.3]), [0, 0.3, 0.5, 1])


def test_two_places_at_the_same_new_spot_add_one_node():
    assert len(with_nodes_at(uniform(2), [0.3, 0.3])) == 4
    assert len(with_nodes_at(uniform(2), [0.3, 0.1 + 0.2])) == 4


@pytest.mark.parametrize(
    "scheme",
    [
        sk.Euler(8),
        sk.Trapezoid(7),
        sk.HermiteSimpson(7),
        sk.HermiteSimpson(3),
        sk.Lobatto(3, 6),
        sk.Lobatto(1, 12, controls="discontinuous"),
        sk.Radau(3, 4),
        sk.Chebyshev(2, 7),
    ],
)
def test_point_constraints_hold_at_their_time(scheme):
    problem = hill(
        points=[
            sk.PointConstraint("gate", lambda x, u: x[0], at=0.4, lower=0.3, upper=0.3),
            sk.PointConstraint("slow", lambda x, u: x[1], at=0.8, upper=-1.2),
        ]
    )
    solution = sk.solve(problem, scheme, tolerance=1e-9)
    assert solution.success
    assert solution.state(0.4)[0] == pytest.approx(0.3, abs=1e-8)
    # inequalities are relaxed by a share of their bound, as in Wächter & Biegler (35)
    assert solution.state(0.8)[1] <= -1.2 * (1 - RELAXATION) + 1e-9
    assert np.any(np.abs(solution.times - 0.4) < 1e-12)


@pytest.mark.parametrize("at", [0.0, 1.0])
@pytest.mark.parametrize(
    "scheme",
    [
        sk.Euler(6),
        sk.Trapezoid(6),
        sk.HermiteSimpson(4, controls="hold"),
        sk.Lobatto(2, 5),
        sk.Radau(3, 3),
        sk.Radau(1, 6),
    ],
)
def test_point_constraints_reach_the_very_ends(scheme, at):
    problem = hill(
        initial=[None, None],
        final=[None, None],
        points=[
            sk.PointConstraint("here", lambda x, u: x[0] + x[1], at=at, lower=2.0, upper=2.0),
            sk.PointConstraint("there", lambda x, u: x[0], at=1 - at, lower=0.0, upper=0.0),
        ],
    )
    solution = sk.solve(problem, scheme, tolerance=1e-9)
    assert solution.success
    end = solution.states[-1 if at else 0]
    assert end.sum() == pytest.approx(2.0, abs=1e-8)


def test_enforce_nodes_frees_the_midpoints_and_enforce_points_binds_them():
    problem = hill(
        path=[sk.PathConstraint("roof", lambda x, u: x[0], upper=0.2)],
    )
    # Three segments put the top of the hill between nodes.
    loose = sk.solve(problem, sk.HermiteSimpson(3, enforce="nodes"), tolerance=1e-9)
    tight = sk.solve(problem, sk.HermiteSimpson(3), tolerance=1e-9)
    assert loose.midpoint_states[:, 0].max() > 0.2 + 1e-3
    assert tight.midpoint_states[:, 0].max() <= 0.2 + 1e-8
    assert loose.states[:, 0].max() <= 0.2 + 1e-8
    assert loose.objective < tight.objective


def test_state_bounds_follow_enforce_in_the_same_way():
    problem = hill(state_bounds=([None, None], [0.2, None]))
    for form in ("separated", "compressed"):
        loose = sk.solve(problem, sk.HermiteSimpson(3, form=form, enforce="nodes"), tolerance=1e-9)
        tight = sk.solve(problem, sk.HermiteSimpson(3, form=form), tolerance=1e-9)
        assert loose.midpoint_states[:, 0].max() > 0.2 + 1e-3
        assert tight.midpoint_states[:, 0].max() <= 0.2 + 1e-8


@pytest.mark.parametrize(
    ("choice", "value"),
    [("controls", "cubic"), ("form", "folded"), ("enforce", "never"), ("objective", "mean")],
)
def test_an_unknown_choice_is_refused_with_the_known_ones(choice, value):
    with pytest.raises(sk.UserError, match="does not know this choice") as caught:
        sk.HermiteSimpson(4, **{choice: value})
    assert caught.value.where == choice
    assert value in caught.value.found
    assert "or" in caught.value.expected


@pytest.mark.parametrize(
    "scheme",
    [sk.Lobatto(2, 4), sk.Lobatto(1, 7), sk.Radau(2, 3), sk.Radau(30, 1), sk.Chebyshev(2, 4)],
)
@pytest.mark.parametrize("solver", ["interior-point", "ipopt"])
def test_path_constraints_hold_at_every_point_of_longer_segments(scheme, solver):
    problem = hill(
        path=[
            sk.PathConstraint("roof", lambda x, u: x[0], upper=0.2),
            sk.PathConstraint("push", lambda x, u: u[0] + 0.1 * x[0], lower=-3.5),
        ],
    )
    solution = sk.solve(problem, scheme, solver, tolerance=1e-9)
    assert solution.success, solution.message
    inside = solution.trajectory.segments
    rows = np.concatenate([inside.interior_states.reshape(-1, 2), solution.states])
    assert rows[:, 0].max() <= 0.2 + 1e-8
    t = solution.times[:-1, None] + np.diff(solution.times)[:, None] * inside.control_points
    push = inside.control_values[..., 0].ravel() + 0.1 * solution.state(t.ravel() - 1e-13)[:, 0]
    assert push.min() >= -3.5 - 1e-7
    assert push.min() < -3.4 or rows[:, 0].max() > 0.2 - 1e-6
    # the uncollocated start of the first Radau segment is looked at too
    assert solution.controls[0, 0] >= -3.5 - 1e-7


def test_the_plain_sum_weighs_every_node_but_the_last_once():
    problem = hill(running_cost=lambda x, u: 1.0 + 0 * u[0])
    for scheme in (sk.Euler, sk.Trapezoid, sk.HermiteSimpson, sk.Lobatto, sk.Radau, sk.Chebyshev):
        assert sk.solve(problem, scheme(6, objective="sum")).objective == pytest.approx(6.0)
        assert sk.solve(problem, scheme(6)).objective == pytest.approx(1.0)


def test_the_plain_sum_is_refused_with_a_free_horizon():
    problem = hill(horizon=sk.Free(0.5, 2.0))
    with pytest.raises(sk.UserError, match="no meaning with a free horizon"):
        sk.solve(problem, sk.Euler(6, objective="sum"))


@pytest.mark.parametrize("scheme", [sk.Euler(5), sk.Trapezoid(5)])
def test_a_scheme_without_an_interior_state_has_no_compressed_form(scheme):
    with pytest.raises(sk.UserError, match="one explicit interior state") as caught:
        sk.solve(hill(), replace(scheme, form="compressed"), "ipopt")
    assert caught.value.where == "form"
