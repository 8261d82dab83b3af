"""Claim: the peers solve what the table says they solve."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from skyknot.bench.measurement import contest, pose_of
from skyknot.bench.peers import ALL, Fatrop, IpoptMapped, Own, Pose
from skyknot.bench.shooting import shooting_program


def glider(**extras):
    """Return a double integrator with drag, a path constraint and a waypoint."""
    asked = {
        "name": "glider",
        "states": ["x", "v"],
        "controls": ["a"],
        "dynamics": lambda x, u: [x[1], u[0] - 0.1 * x[1] ** 2],
        "horizon": 2.0,
        "initial": [0.0, (-0.1, 0.1)],
        "final": [1.0, (0.0, 0.2)],
        "running_cost": lambda x, u, t: u[0] ** 2 + 0.1 * t * x[0],
        "terminal_cost": lambda x, tf: x[1] ** 2,
        "control_bounds": ([-3.0], [3.0]),
        "path": [
            sk.PathConstraint("speed", lambda x, u: x[1], upper=0.7),
            sk.PathConstraint("power", lambda x, u: x[1] * u[0], upper=0.5),
        ],
        "points": [sk.PointConstraint("gate", lambda x, u: x[0], at=0.5, upper=0.4)],
    }
    return sk.Problem(**(asked | extras))


PROBLEMS = {
    "fixed horizon": glider(),
    "free horizon": glider(
        horizon=sk.Free(0.5, 6.0, 2.0), running_cost=lambda x, u: 0.2 + u[0] ** 2
    ),
}


def pose(problem, segments=24):
    return Pose(problem, sk.HermiteSimpson(segments), sk.initial_guess(problem)[0], 1e-8)


def ipopt_on(program):
    options = {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "ipopt.tol": 1e-9}
    solver = ca.nlpsol("witness", "ipopt", program.graph, options)
    return solver(
        x0=program.start,
        lbx=program.lower,
        ubx=program.upper,
        lbg=program.g_lower,
        ubg=program.g_upper,
    )


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_fatrop_finds_the_optimum_of_its_shooting_program(problem):
    answer = Fatrop(pose(problem)).solve()
    guess = sk.initial_guess(problem)[0]
    expected = float(ipopt_on(shooting_program(problem, 24, guess))["f"])
    assert answer.success
    assert answer.objective == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_the_shooting_program_nears_the_same_continuous_optimum(problem):
    """Of first order, for the plain sum: the difference halves with the segments."""
    best = sk.solve(problem, sk.HermiteSimpson(60), tolerance=1e-9).objective
    guess = sk.initial_guess(problem)[0]
    errors = [
        abs(float(ipopt_on(shooting_program(problem, N, guess))["f"]) - best) for N in (30, 60, 120)
    ]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.03 * best


def test_the_shooting_program_keeps_every_limit():
    problem = PROBLEMS["fixed horizon"]
    found = np.asarray(ipopt_on(shooting_program(problem, 24, sk.initial_guess(problem)[0]))["x"])
    stages = found[: 24 * 3].reshape(24, 3)
    x, v, a = stages.T
    assert x[0] == pytest.approx(0.0, abs=1e-7)
    assert found[-2, 0] == pytest.approx(1.0, abs=1e-7)
    assert -0.1 - 1e-7 <= v[0] <= 0.1 + 1e-7
    assert 0.0 - 1e-7 <= found[-1, 0] <= 0.2 + 1e-7
    assert v.max() <= 0.7 + 1e-7
    assert (v * a).max() <= 0.5 + 1e-7
    assert x[12] <= 0.4 + 1e-7


def test_rate_bounds_cannot_be_shot():
    problem = glider(rates=[1.0])
    with pytest.raises(sk.UserError, match="no rate bounds") as caught:
        shooting_program(problem, 5, sk.initial_guess(problem)[0])
    assert caught.value.found == "rate bounds"


def test_own_and_ipopt_solve_the_identical_program():
    asked = pose(PROBLEMS["free horizon"])
    own, ipopt = Own(asked).solve(), IpoptMapped(asked).solve()
    assert own.success
    assert ipopt.success
    assert own.objective == pytest.approx(ipopt.objective, rel=1e-6)


def test_a_contestant_that_cannot_be_built_is_told_and_the_others_go_on():
    found = contest("glider", pose(glider(rates=[5.0]), 6), ["own", "fatrop"], 2, 10.0)
    assert "no rate bounds" in found.timings["fatrop"].refusal
    assert np.isnan(found.ratio("fatrop"))
    assert len(found.timings["own"].wall) == len(found.timings["own"].cpu) == 2
    assert found.timings["own"].answer.success


def test_a_contestant_out_of_budget_retires():
    found = contest("glider", pose(glider(), 6), ["own"], 50, 1e-9)
    assert len(found.timings["own"].wall) == 1


def test_a_library_mission_is_posed_as_it_is_solved():
    asked = pose_of("yaw_point_transfer", 9)
    assert asked.scheme.segments == 9
    mission = sk.missions.load("yaw_point_transfer")
    even = {"transcription": sk.HermiteSimpson(9), "accuracy": None}
    settings = mission.settings() | even
    assert Own(asked).solve().iterations == sk.solve(mission.problem, **settings).iterations


def test_every_form_goes_by_its_own_name():
    assert all(form.name == name for name, form in ALL.items())
