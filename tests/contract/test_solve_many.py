"""Claim: many instances at once are the same answers as one by one, on any number of threads."""

from __future__ import annotations

import sys
import threading

import casadi as ca
import numpy as np
import pytest

import skyknot as sk

SCHEME = sk.HermiteSimpson(12)


def cart(**extras):
    """Return a pendulum with a wall, four parameters and an end to reach."""
    asked = {
        "name": "pendulum",
        "states": [sk.State("angle", "rad", scale=1.0), sk.State("spin", "rad/s", scale=2.0)],
        "controls": [sk.Control("torque", "N m", scale=1.0)],
        "dynamics": lambda x, u, p: [x[1], -p.stiffness * ca.sin(x[0]) + u[0]],
        "horizon": 2.0,
        "initial": [0.0, 0.0],
        "final": [1.0, 0.0],
        "running_cost": lambda x, u, p: u[0] ** 2 + p.weight * x[1] ** 2,
        "control_bounds": ([-3.0], [3.0]),
        "path": [sk.PathConstraint("wall", lambda x, u, p: x[1] - p.fastest, upper=0.0)],
        "parameters": {
            "stiffness": 1.0,
            "weight": 0.1,
            "fastest": 0.9,
            "bias": sk.Free(-1.0, 1.0),
        },
    }
    return sk.Problem(**(asked | extras))


PENDULUM = cart()
# the fourth cannot be flown: the way takes an average speed of 0.5
VALUES = [
    {"stiffness": 0.5},
    {"stiffness": 2.0, "weight": 1.0},
    {},
    {"fastest": 0.3},
    {"fastest": 0.7},
    {"weight": 0.0, "stiffness": 0.2},
]
STARTS = np.array([[0.0, 0.0], [0.3, -0.2], [-1.0, 0.5], [1.0, 0.0], [0.5, 0.8]])


def assert_same(found, expected):
    """Assert that two solutions agree to the last bit."""
    assert found.status is expected.status
    assert found.iterations == expected.iterations
    assert found.objective == expected.objective
    assert found.kkt_residual == pytest.approx(expected.kkt_residual, rel=0, abs=0, nan_ok=True)
    for name in ("decision", "costates", "states", "controls", "times", "history", "gains"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name)
    for name, values in expected.multipliers.items():
        np.testing.assert_array_equal(found.multipliers[name], values, name)
    assert found.record.parameters == expected.record.parameters
    assert found.record.inputs_hash == expected.record.inputs_hash
    assert found.record.guess == expected.record.guess
    assert found.record.work == expected.record.work


@pytest.mark.parametrize("threads", [1, 2, 3, 8])
def test_parameters_give_what_each_alone_gives(threads):
    """One of them fails on the way, and leaves nothing behind in the workspace it used."""
    many = sk.solve_many(PENDULUM, parameters=VALUES, transcription=SCHEME, threads=threads)
    assert [solution.success for solution in many] == [True, True, True, False, True, True]
    for values, found in zip(VALUES, many, strict=True):
        fixed = PENDULUM.parameters | values
        assert_same(found, sk.solve(cart(parameters=fixed), SCHEME))


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("scheme", [SCHEME, sk.Euler(15), sk.HermiteSimpson(12, controls="hold")])
def test_initials_give_what_each_alone_gives(scheme, threads):
    many = sk.solve_many(PENDULUM, initials=STARTS, transcription=scheme, threads=threads)
    for start, found in zip(STARTS, many, strict=True):
        np.testing.assert_array_equal(found.states[0], start)
        assert_same(found, sk.solve(cart(initial=list(start)), scheme))


def test_initials_fix_what_the_problem_left_free():
    free = cart(initial=[(-0.1, 0.1), None])
    for start, found in zip(
        STARTS, sk.solve_many(free, initials=STARTS, transcription=SCHEME), strict=True
    ):
        assert_same(found, sk.solve(cart(initial=list(start)), SCHEME))


def test_guesses_give_what_each_alone_gives():
    solved = sk.solve(PENDULUM, SCHEME)
    slow = sk.Trajectory([0.0, 2.0], [[0.0, 0.5], [1.0, 0.5]], [[0.0], [0.1]])
    guesses = [None, slow, solved]
    many = sk.solve_many(PENDULUM, guesses=guesses, transcription=SCHEME, threads=2)
    for guess, found in zip(guesses, many, strict=True):
        assert_same(found, sk.solve(PENDULUM, SCHEME, guess=guess))
    assert [found.record.guess for found in many] == ["straight line", "user", "solution"]
    assert many[2].iterations < many[0].iterations


def test_lists_are_taken_together_entry_by_entry():
    values = VALUES[: len(STARTS)]
    many = sk.solve_many(PENDULUM, parameters=values, initials=STARTS, transcription=SCHEME)
    for value, start, found in zip(values, STARTS, many, strict=True):
        alone = cart(parameters=PENDULUM.parameters | value, initial=list(start))
        assert_same(found, sk.solve(alone, SCHEME))


def test_a_vehicle_gives_the_same_to_the_bit_on_any_number_of_threads():
    problem = sk.missions.load("report_transfer_constrained").problem
    starts = np.zeros((6, 12))
    starts[:, :3] = np.random.default_rng(3).uniform(-1, 1, (6, 3))
    runs = [
        sk.solve_many(problem, initials=starts, transcription=sk.HermiteSimpson(30), threads=t)
        for t in (1, 2, 5)
    ]
    alone = [
        sk.solve(problem.varied(initial=start.tolist()), sk.HermiteSimpson(30))
        for start in starts[:2]
    ]
    assert all(solution.success for solution in runs[0])
    for run in (*runs[1:], alone):
        for found, expected in zip(run, runs[0], strict=False):
            assert_same(found, expected)


def test_any_solver_serves():
    ours = sk.solve_many(PENDULUM, parameters=VALUES[:2], transcription=SCHEME, tolerance=1e-8)
    theirs = sk.solve_many(
        PENDULUM, parameters=VALUES[:2], transcription=SCHEME, tolerance=1e-8, solver="ipopt"
    )
    for a, b in zip(ours, theirs, strict=True):
        assert b.record.solver == "ipopt"
        assert a.objective == pytest.approx(b.objective, rel=1e-6)


def test_settings_of_the_solver_hold_for_every_instance():
    many = sk.solve_many(
        PENDULUM,
        initials=STARTS[1:3],
        transcription=SCHEME,
        solver={"name": "interior-point", "max_iterations": 1},
    )
    assert {solution.status for solution in many} == {sk.Status.ITERATION_LIMIT}


def test_an_instance_remembers_its_own_problem():
    found = sk.solve_many(PENDULUM, parameters=VALUES[:2], transcription=SCHEME)[1]
    assert found.problem.parameters["stiffness"] == 2.0
    assert found.record.parameters["stiffness"] == 2.0
    assert PENDULUM.parameters["stiffness"] == 1.0


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_an_error_is_raised_and_no_thread_begins_another_instance(threads, monkeypatch):
    begun = []

    def answered(task, *_):
        begun.append(task.problem.initial_lower[0])
        raise RuntimeError("out of paper")

    monkeypatch.setattr(sys.modules["skyknot.solve_many"], "answered", answered)
    starts = np.linspace([0.0, 0.0], [1.0, 0.0], 50)
    with pytest.raises(RuntimeError, match="out of paper"):
        sk.solve_many(PENDULUM, initials=starts, transcription=SCHEME, threads=threads)
    assert 1 <= len(begun) <= threads


def test_no_instances_give_no_solutions():
    assert sk.solve_many(PENDULUM, parameters=[]) == []


REFUSED = {
    "no list": ({}, "do not say how many", "no list"),
    "lengths": ({"parameters": [{}], "guesses": [None, None]}, "how many", "1 parameters, 2"),
    "name": ({"parameters": [{}, {"mass": 1.0}]}, "no parameter of this name", "mass"),
    "free": ({"parameters": [{"bias": 0.5}]}, "no parameter of this name", "bias"),
    "value": ({"parameters": [{"weight": np.nan}]}, "not a finite number", "nan"),
    "shape": ({"initials": [[0.0, 0.0, 0.0]]}, "not a table", "shape (1, 3)"),
    "hole": ({"initials": [[0.0, None]]}, "not a table", "shape (1, 2)"),
    "outside": ({"initials": [[0.0, 0.0], [9.0, 0.0]]}, "outside its bounds", "9"),
    "guess": ({"guesses": ["straight"]}, "guess has the wrong type", "str"),
    "threads": ({"parameters": [{}], "threads": 0}, "threads must be 1 or more", "0"),
}


@pytest.mark.parametrize(("arguments", "what", "found"), REFUSED.values(), ids=REFUSED)
def test_a_wrong_argument_is_refused_by_name_before_anything_is_solved(arguments, what, found):
    problem = cart(state_bounds=([-4.0, None], [4.0, None]))
    with pytest.raises(sk.UserError, match=what) as caught:
        sk.solve_many(problem, transcription=SCHEME, **arguments)
    assert found in caught.value.found
    entry = {"name": "parameters[1]", "outside": "initials[1]", "guess": "guesses[0]"}
    for case, place in entry.items():
        if REFUSED[case][0] is arguments:
            assert caught.value.where.startswith(place)


def test_casadi_is_left_alone_once_threads_share_the_problem(monkeypatch):
    """It works without the interpreter's lock on reference counts that two threads destroy."""
    threads = []

    def watched(function):
        def call(*arguments, **named):
            threads.append(threading.current_thread())
            return function(*arguments, **named)

        return call

    for name in ("cse", "jacobian", "gradient", "hessian"):
        monkeypatch.setattr(ca, name, watched(getattr(ca, name)))
    for name in ("__call__", "call", "serialize", "__hash__"):
        monkeypatch.setattr(ca.Function, name, watched(getattr(ca.Function, name)))
    sk.solve_many(PENDULUM, initials=STARTS, transcription=SCHEME, threads=2)
    assert set(threads) == {threading.main_thread()}
