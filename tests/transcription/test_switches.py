"""Claim: switches of the controls are found where they are, from a mesh that straddles them."""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot.transcription.pointwise import PointFunctions
from skyknot.transcription.switches import switches

POSITION, SPEED = 1.0, 0.5
HALF = np.sqrt(POSITION + SPEED**2 / 2)
SWITCH, DURATION = SPEED + HALF, SPEED + 2 * HALF
"""Least time to the origin with |a| ≤ 1: brake, then push (Bryson & Ho, Applied Optimal Control,
section 3.9: the switching curve x = −v|v|/2)."""


def least_time(**extras):
    asked = {
        "name": "to the origin in least time",
        "states": ["x", "v"],
        "controls": ["a"],
        "dynamics": lambda x, u: [x[1], u[0]],
        "horizon": sk.Free(0.5, 10.0, guess=3.0),
        "initial": [POSITION, SPEED],
        "final": [0.0, 0.0],
        "terminal_cost": lambda x, tf: tf,
        "control_bounds": ([-1.0], [1.0]),
    }
    return sk.Problem(**(asked | extras))


def clipped(bound):
    """Return a problem whose control is a ramp cut off at a bound: 6 − 12 t without one."""
    return sk.Problem(
        name="clipped ramp",
        states=["x", "v"],
        controls=["a"],
        dynamics=lambda x, u: [x[1], u[0]],
        horizon=1.0,
        initial=[0.0, 0.0],
        final=[1.0, 0.0],
        running_cost=lambda x, u: u[0] ** 2,
        control_bounds=([-bound], [bound]),
    )


def found(problem, scheme, tolerance=1e-8):
    solution = sk.solve(problem, scheme, tolerance=tolerance)
    assert solution.success, solution.message
    functions = PointFunctions.of(problem)
    return switches(
        problem, solution.trajectory, solution.costates, solution.record.parameters, functions
    ), solution


@pytest.mark.parametrize(
    ("controls", "share"), [("quadratic", 0.2), ("linear", 1.0), ("hold", 1.0)]
)
@pytest.mark.parametrize("segments", [11, 20])
def test_a_bang_bang_switch_is_found_to_a_share_of_its_segment(controls, share, segments):
    places, solution = found(least_time(), sk.HermiteSimpson(segments, controls=controls))
    assert solution.trajectory.duration == pytest.approx(DURATION, rel=1e-2)
    assert len(places) == 2
    for switch in places:
        assert switch.jump
        assert switch.control == 0
        assert switch.place == pytest.approx(SWITCH / DURATION, abs=share / segments)


@pytest.mark.parametrize("scheme", [sk.HermiteSimpson, sk.Trapezoid])
def test_a_ramp_meets_its_bounds_where_the_closed_form_says(scheme):
    """A ramp of slope −2b/w between bounds ±b, b = 5: 1 = b/4 − b w²/12 for its width w."""
    bound = 5.0
    width = np.sqrt(12 * (bound / 4 - 1.0) / bound)
    places, _ = found(clipped(bound), scheme(23))
    assert [switch.jump for switch in places] == [False, False]
    assert places[0].place == pytest.approx(0.5 - width / 2, abs=5e-3)
    assert places[1].place == pytest.approx(0.5 + width / 2, abs=5e-3)


def test_the_bracket_is_what_the_controls_alone_tell():
    places, solution = found(least_time(), sk.HermiteSimpson(20))
    for switch in places:
        low, high = switch.bracket
        assert low < high
        values = solution.control(np.array([low, high]) * solution.trajectory.duration)[:, 0]
        assert np.max(np.abs(values)) > 0.99


def test_a_control_that_never_meets_a_bound_has_no_switches():
    places, _ = found(clipped(50.0), sk.HermiteSimpson(10))
    assert places == []


def test_a_control_without_bounds_has_no_switches():
    problem = least_time(
        horizon=2.0, control_bounds=None, terminal_cost=None, running_cost=lambda x, u: u[0] ** 2
    )
    places, _ = found(problem, sk.HermiteSimpson(10))
    assert places == []
