"""Claim: multipliers survive a change of mesh, and a warm start with them saves iterations."""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot.kernel.evaluation import evaluate, gradient
from skyknot.kernel.program import Multipliers
from skyknot.problem.guess import straight_line
from skyknot.transcription.inheritance import inherited

SCHEMES = {
    "euler": sk.Euler,
    "trapezoid": sk.Trapezoid,
    "hermite-simpson": sk.HermiteSimpson,
    "linear": lambda **mesh: sk.HermiteSimpson(controls="linear", **mesh),
    "hold": lambda **mesh: sk.HermiteSimpson(controls="hold", **mesh),
}
GRADED = np.linspace(0.0, 1.0, 61) ** 1.3


def cart(**extras):
    """Return a smooth problem whose speed limit is active in the middle of the flight."""
    asked = {
        "name": "cart",
        "states": ["x", "v"],
        "controls": ["a"],
        "dynamics": lambda x, u: [x[1], u[0]],
        "horizon": 2.0,
        "initial": [0.0, 0.0],
        "final": [1.0, 0.0],
        "running_cost": lambda x, u: u[0] ** 2,
        "path": [sk.PathConstraint("speed", lambda x, u: x[1], upper=0.7)],
    }
    return sk.Problem(**(asked | extras))


def handed_over(make, problem, mesh=GRADED):
    """Return the program on a new mesh, and what it inherits from 40 equal segments."""
    scheme = make(segments=40)
    solution = sk.solve(problem, scheme)
    assert solution.success, solution.message
    old = scheme.program(problem, solution.trajectory)
    new = make(mesh=mesh).program(problem, solution.trajectory)
    points = scheme.table.points
    return old, new, inherited(old, Multipliers(**solution.multipliers), new, points), solution


@pytest.mark.parametrize("name", SCHEMES)
def test_the_same_mesh_inherits_the_same_numbers(name):
    mesh = np.linspace(0.0, 1.0, 41)
    problem = cart(control_bounds=([-2.0], [1.6]), rates=([-9.0], [9.0]))
    _, _, carried, solution = handed_over(SCHEMES[name], problem, mesh)
    for part in ("defects", "rates", "bounds"):
        numbers = solution.multipliers[part]
        np.testing.assert_allclose(getattr(carried, part), numbers, atol=1e-9, err_msg=part)
    # of rows that say the same (two segments at one node) only the sum means something
    assert np.sum(carried.path) == pytest.approx(np.sum(solution.multipliers["path"]))


@pytest.mark.parametrize("name", SCHEMES)
def test_what_is_inherited_nearly_satisfies_the_new_optimality_conditions(name):
    problem = cart(control_bounds=([-2.0], [1.6]))
    _, new, carried, _ = handed_over(SCHEMES[name], problem)
    values = evaluate(new, new.start)
    with_them, without = (
        np.sum(np.abs(gradient(new, values, multipliers)))
        for multipliers in (carried, new.empty_multipliers())
    )
    assert with_them < 0.5 * without


def test_the_total_force_of_an_active_constraint_does_not_depend_on_the_mesh():
    old, new, carried, solution = handed_over(sk.HermiteSimpson, cart())
    assert np.sum(carried.path) == pytest.approx(np.sum(solution.multipliers["path"]), rel=0.05)
    assert len(old.point_time) != len(new.point_time)


def test_a_waypoint_keeps_its_number():
    gate = sk.PointConstraint("gate", lambda x, u: x[0], at=0.25, lower=0.2, upper=0.2)
    problem = cart(path=[], points=[gate])
    _, new, carried, solution = handed_over(sk.HermiteSimpson, problem)
    (row,) = np.flatnonzero(carried.path[:, 0])
    assert new.point_time[row] == pytest.approx(0.25)
    assert carried.path[row, 0] == pytest.approx(np.sum(solution.multipliers["path"]))


def test_a_free_duration_keeps_its_multiplier():
    problem = cart(horizon=sk.Free(1.0, 1.9), path=[])
    _, new, carried, solution = handed_over(sk.HermiteSimpson, problem)
    (numbers,) = carried.bounds[new.layout.global_positions]
    assert numbers == pytest.approx(solution.multipliers["bounds"][-1])
    assert abs(numbers) > 1e-3


def test_programs_of_two_meshes_share_their_functions():
    problem = cart()
    guess = straight_line(problem)
    first = sk.HermiteSimpson(10).program(problem, guess)
    from_first = sk.HermiteSimpson(20).program_of(
        sk.transcription.pointwise.PointFunctions(
            first.parametric_point, first.parametric_terminal
        ),
        problem,
        guess,
    )
    assert from_first.parametric_point is first.parametric_point
    assert from_first.segments == 20
