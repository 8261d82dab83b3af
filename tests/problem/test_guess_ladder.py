"""Claim: without a user's guess, the ladder finds a start that fits ends, bounds and vehicle."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from skyknot.models import Allocation, Vehicle
from skyknot.problem.guess import flat_lift, flat_lifts, ladder


def craft(**changes):
    numbers = {
        "name": "sample",
        "title": "Craft of the tests",
        "kind": "small",
        "mass": 1.2,
        "inertia": (0.012, 0.012, 0.022),
        "gravity": 9.81,
        "allocation": Allocation.x(0.25, 0.02),
        "thrust_min": 0.1,
        "thrust_max": 9.0,
    }
    return Vehicle(**(numbers | changes))


def flight(by_rotors=False, vehicle=None, **changes):
    vehicle = vehicle or craft()
    model = vehicle.rotor_model() if by_rotors else vehicle.wrench_model()
    asked = {
        "name": "flight",
        "states": list(model.state_names),
        "controls": list(model.control_names),
        "dynamics": model.dynamics,
        "horizon": 3.0,
        "initial": [0.0] * 12,
        "final": [4.0, -2.0, -1.0, 0, 0, 0, 0, 0, 0.7, 0, 0, 0],
        "running_cost": lambda x, u: u[0] ** 2,
        "state_bounds": model.state_bounds,
        "control_bounds": model.control_bounds,
        "vehicle": vehicle,
    }
    return sk.Problem(**(asked | changes))


def plain(**changes):
    asked = {
        "name": "plain",
        "states": ["x", "v"],
        "controls": ["a"],
        "dynamics": lambda x, u: [x[1], u[0]],
        "horizon": 2.0,
    }
    return sk.Problem(**(asked | changes))


@pytest.mark.parametrize("by_rotors", [False, True])
def test_a_vehicle_gets_the_flat_lift_which_is_nearly_flyable(by_rotors):
    problem = flight(by_rotors)
    guess, rung = sk.initial_guess(problem)
    assert rung == "flat lift"
    assert guess.controls.shape[1] == problem.nu
    np.testing.assert_allclose(guess.states[0], problem.initial_lower, atol=1e-9)
    np.testing.assert_allclose(guess.states[-1], problem.final_lower, atol=1e-9)
    # The lift solves the dynamics: its only error is that of reading 41 points.
    slope = np.gradient(guess.states, guess.times, axis=0, edge_order=2)
    rates = [
        np.asarray(ca.evalf(ca.vertcat(*problem.dynamics(ca.SX(x), ca.SX(u))))).ravel()
        for x, u in zip(guess.states, guess.controls, strict=True)
    ]
    np.testing.assert_allclose(slope[2:-2], np.array(rates)[2:-2], atol=0.15)


@pytest.mark.parametrize("by_rotors", [False, True])
@pytest.mark.parametrize("steep", [False, True])
def test_many_lifts_at_once_are_those_of_one_by_one_to_the_bit(by_rotors, steep):
    """One of them stands still; and one too steep leaves the others theirs."""
    problem = flight(by_rotors)
    starts = np.zeros((70, 12))
    starts[:, :3] = np.random.default_rng(2).uniform(-1, 1, (70, 3))
    starts[:, 8] = np.linspace(-1, 1, 70)
    starts[3] = problem.final_lower
    if steep:
        starts[66, 0] = 1e4
    flights = [problem.varied(initial=start.tolist()) for start in starts]
    for i, (found, each) in enumerate(zip(flat_lifts(flights), flights, strict=True)):
        alone = flat_lift(each)
        assert (found is None) == (alone is None) == (i == 3 or (steep and i == 66))
        if found is not None and alone is not None:
            np.testing.assert_array_equal(found.times, alone.times)
            np.testing.assert_array_equal(found.states, alone.states)
            np.testing.assert_array_equal(found.controls, alone.controls)


def test_a_vehicle_that_does_not_move_gets_the_straight_line_at_hover():
    problem = flight(final=[0.0] * 12)
    guess, rung = sk.initial_guess(problem)
    assert rung == "straight line"
    np.testing.assert_allclose(guess.controls, np.tile(problem.vehicle.hover, (2, 1)))


def test_hover_by_rotors_shares_the_weight():
    guess, _ = sk.initial_guess(flight(by_rotors=True, final=[0.0] * 12))
    np.testing.assert_allclose(guess.controls, 1.2 * 9.81 / 4)


def test_the_lift_starts_and_ends_level_and_at_rest():
    guess, _ = sk.initial_guess(flight())
    ends = guess.states[[0, -1]]
    np.testing.assert_allclose(ends[:, [3, 4, 5, 6, 7, 9, 10, 11]], 0, atol=1e-9)
    np.testing.assert_allclose(guess.controls[[0, -1], 0], craft().weight)


def test_the_target_serves_where_the_end_is_free():
    problem = flight(final=None, target=[4.0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])
    guess, rung = sk.initial_guess(problem)
    assert rung == "flat lift"
    assert guess.states[-1, 0] == pytest.approx(4.0)


def test_the_guess_respects_the_bounds():
    vehicle = craft()
    lower, upper = vehicle.state_bounds
    lower[3:6], upper[3:6] = -1.0, 1.0
    guess, _ = sk.initial_guess(flight(vehicle=vehicle, state_bounds=(lower, upper)))
    assert np.abs(guess.states[:, 3:6]).max() <= 1.0


def test_without_a_vehicle_states_run_straight_between_the_ends():
    guess, rung = sk.initial_guess(plain(initial=[1.0, 0.0], final=[3.0, None]))
    assert rung == "straight line"
    np.testing.assert_allclose(guess.state([0.0, 1.0, 2.0]), [[1, 0], [2, 0], [3, 0]])


@pytest.mark.parametrize(
    ("ends", "first", "last"),
    [
        ({"initial": [1.0, 2.0]}, [1, 2], [1, 2]),
        ({"final": [1.0, 2.0]}, [1, 2], [1, 2]),
        ({}, [0, 0], [0, 0]),
        ({"final": [(2.0, 4.0), (None, 5.0)]}, [3, 0], [3, 0]),
        ({"initial": [0.0, 0.0], "target": [5.0, 1.0]}, [0, 0], [5, 1]),
        ({"state_bounds": (2.0, 4.0)}, [2, 2], [2, 2]),
    ],
)
def test_unknown_ends_take_the_nearest_known(ends, first, last):
    guess, _ = sk.initial_guess(plain(**ends))
    np.testing.assert_allclose(guess.states, [first, last])


def test_controls_rest_at_the_allowed_value_nearest_zero():
    guess, _ = sk.initial_guess(plain(control_bounds=(0.5, 2.0)))
    np.testing.assert_allclose(guess.controls, 0.5)


def test_a_free_horizon_starts_at_its_own_start():
    guess, _ = sk.initial_guess(plain(horizon=sk.Free(1.0, 9.0)))
    assert guess.duration == 3.0


def test_the_solution_tells_which_rung_it_started_from():
    problem = plain(initial=[0.0, 0.0], final=[1.0, 0.0], running_cost=lambda x, u: u[0] ** 2)
    first = sk.solve(problem, sk.Trapezoid(5))
    assert first.record.guess == "straight line"
    assert sk.solve(problem, sk.Trapezoid(5), guess=first).record.guess == "solution"
    assert sk.solve(problem, sk.Trapezoid(5), guess=first.trajectory).record.guess == "user"


def past_a_tower(**extras):
    """Return a point that must pass a tower standing on the straight way."""
    asked = {
        "states": ["x", "y", "z", "vx", "vy", "vz"],
        "controls": ["ax", "ay", "az"],
        "dynamics": lambda x, u: [x[3], x[4], x[5], u[0], u[1], u[2]],
        "horizon": 5.0,
        "initial": [0.0] * 6,
        "final": [10.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        "running_cost": lambda x, u: u[0] ** 2 + u[1] ** 2 + u[2] ** 2,
        "path": [sk.cylinder("tower", (5.0, 0.0), 1.0)],
    }
    return sk.Problem("past a tower", **(asked | extras))


def test_the_ladder_goes_round_and_over_drawn_obstacles():
    rungs = {name: guess for guess, name in ladder(past_a_tower())}
    assert list(rungs) == [
        "straight line",
        "line bowed left",
        "line bowed right",
        "line bowed over",
    ]
    middle = {name: guess.state(2.5) for name, guess in rungs.items()}
    assert middle["line bowed left"][1] == pytest.approx(3.0)
    assert middle["line bowed right"][1] == pytest.approx(-3.0)
    assert middle["line bowed over"][2] == pytest.approx(-3.0)


def test_a_failed_start_is_followed_by_the_next_rung():
    blocked = past_a_tower(control_bounds=(-0.1, 0.1))
    solution = sk.solve(blocked, sk.HermiteSimpson(10))
    assert not solution.success
    assert "4 starts of the guess ladder were tried" in solution.message
