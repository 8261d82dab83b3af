"""Claim: parameters are inputs of the finite program, and their values are all that tells apart."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from skyknot.problem.guess import initial_guess
from skyknot.solvers.interior_point import InteriorPoint, Prepared
from skyknot.solvers.ipopt import Ipopt

SCHEMES = {
    "hermite-simpson": sk.HermiteSimpson(12),
    "linear": sk.HermiteSimpson(12, controls="linear"),
    "trapezoid": sk.Trapezoid(20),
    "euler": sk.Euler(20),
}
VALUES = {"damping": 0.3, "weight": 2.0, "wall": 0.6, "end": 5.0}


def pendulum(damping, weight, wall, end, horizon):
    """Return a pendulum that reads a parameter in every callable."""
    return sk.Problem(
        "pendulum",
        ["angle", "spin"],
        ["torque"],
        lambda x, u, p: [x[1], -ca.sin(x[0]) - p.damping * x[1] + u[0]],
        horizon=horizon,
        initial=[0.0, 0.0],
        running_cost=lambda x, u, p: p.weight * u[0] ** 2 + (0.1 if horizon != 2.0 else 0.0),
        terminal_cost=lambda x, tf, p: p.end * (x[0] - 1.0) ** 2 + p.boost * x[1] ** 2,
        path=[sk.PathConstraint("wall", lambda x, u, p: x[1] - p.wall, upper=0.0)],
        control_bounds=([-2.0], [2.0]),
        parameters={
            "damping": damping,
            "boost": sk.Free(1.0, 2.0),
            "weight": weight,
            "wall": wall,
            "end": end,
        },
    )


@pytest.mark.parametrize("horizon", [2.0, sk.Free(1.0, 4.0, 2.0)], ids=["fixed", "free"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_one_program_serves_all_values(scheme, horizon):
    """The program made for some values, given others, solves as the program made for those."""
    first = pendulum(**VALUES, horizon=horizon)
    other = {"damping": 0.05, "weight": 0.5, "wall": 0.8, "end": 9.0}
    second = pendulum(**other, horizon=horizon)
    transcription = SCHEMES[scheme]
    made = transcription.program(first, initial_guess(first)[0])
    moved = made.with_parameters(np.array([other[name] for name in made.parameter_names]))
    expected = sk.solve(second, transcription, tolerance=1e-9)
    assert expected.success
    for solver in (InteriorPoint(), Ipopt()):
        found = solver.solve(moved, 1e-9)
        assert found.status.success
        np.testing.assert_allclose(found.z, expected.decision, atol=2e-5)
    unmoved = InteriorPoint().solve(made, 1e-9)
    assert np.max(np.abs(unmoved.z - expected.decision)) > 1e-2


def test_one_workspace_serves_all_values():
    """Prepared once, the native room is told the values with every solve."""
    problem = pendulum(**VALUES, horizon=2.0)
    program = sk.HermiteSimpson(12).program(problem, initial_guess(problem)[0])
    prepared = Prepared(program)
    values = np.array([0.05, 0.5, 0.8, 9.0])
    other = prepared.at(program.with_parameters(values))
    found = other.solve(InteriorPoint(), program.start, 1e-9)
    expected = InteriorPoint().solve(program.with_parameters(values), 1e-9)
    np.testing.assert_array_equal(found.z, expected.z)


def test_the_point_function_at_the_parameters_takes_no_parameters():
    problem = pendulum(**VALUES, horizon=2.0)
    program = sk.HermiteSimpson(3).program(problem, initial_guess(problem)[0])
    _, F, _ = program.point([0.2, 1.0], [0.5], [1.5], 0.0)
    expected = 2.0 * np.array([1.0, -np.sin(0.2) - 0.3 + 0.5])
    np.testing.assert_allclose(np.asarray(F).ravel(), expected, rtol=1e-14)
