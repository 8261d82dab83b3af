"""Claim: optima that are only computed are found by a second family of schemes, and by shooting."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import skyknot as sk
from skyknot.bank import CATALOGUE, judged
from skyknot.bank.attitudes import SIGNS
from skyknot.bank.base import COMPUTED, Recipe
from skyknot.bank.judgement import answered

SECOND = {
    "van-der-pol": Recipe(sk.Radau(24, 8)),
    "van-der-pol-control": Recipe(sk.Radau(40, 4), accuracy=1e-6),
    "van-der-pol-limited": Recipe(sk.HermiteSimpson(80), accuracy=1e-7),
    "cart-pole": Recipe(sk.Radau(20, 8)),
    "hang-glider": Recipe(sk.Radau(60, 3), accuracy=1e-5, tolerance=1e-8),
    "orbit-raising": Recipe(sk.Radau(24, 8)),
    "reorientation": Recipe(sk.HermiteSimpson(40), accuracy=1e-5, tolerance=1e-9),
    "racing-quadrotor": Recipe(sk.HermiteSimpson(40), accuracy=1e-4, tolerance=1e-7),
    "racing-quadrotor-short": Recipe(sk.HermiteSimpson(40), accuracy=1e-4, tolerance=1e-7),
    "quadrotor-transfer": Recipe(sk.Radau(10, 8)),
    "quadrotor-transfer-in-drag": Recipe(sk.Radau(10, 8)),
    "quadrotor-step": Recipe(sk.Radau(10, 8)),
    "quadrotor-step-small": Recipe(sk.Radau(10, 8)),
    "quadrotor-step-tiny": Recipe(sk.Radau(10, 8)),
    "planar-quadrotor": Recipe(sk.HermiteSimpson(40), accuracy=1e-5, tolerance=1e-8),
    "lateral-minimum-time": Recipe(sk.HermiteSimpson(40), accuracy=1e-4, tolerance=1e-7),
}


FLOWN = {"goddard", "reorientation"}


def test_every_computed_optimum_is_found_a_second_time():
    computed = [name for name, make in CATALOGUE.items() if make().kind == COMPUTED]
    assert set(SECOND) | FLOWN == set(computed)
    for name in SECOND:
        first, second = CATALOGUE[name]().recipe.scheme, SECOND[name].scheme
        assert first.table.name != second.table.name


@pytest.mark.parametrize("name", SECOND)
def test_a_second_scheme_finds_the_computed_optimum(name):
    reference = replace(CATALOGUE[name](), recipe=SECOND[name], switches=())
    assert judged(name, reference).complaint == ""


def test_the_arcs_of_the_reorientation_bring_the_body_round():
    """Flown with another integrator from rest: half a turn about z, at rest again."""
    reference = CATALOGUE["reorientation"]()
    times = [0.0, *reference.switches, reference.optimum]
    x = np.array([1.0, 0, 0, 0, 0, 0, 0])
    for (begin, end), torque in zip(pairwise(times), SIGNS, strict=True):

        def rates(t, x, torque=torque):
            q0, q, w = x[0], x[1:4], x[4:]
            turning = 0.5 * np.array([-q @ w, *(q0 * w + np.cross(q, w))])
            return np.concatenate([turning, torque])

        x = solve_ivp(rates, (begin, end), x, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    np.testing.assert_allclose(x, [0, 0, 0, 1, 0, 0, 0], atol=1e-9)
    assert reference.optimum < 2 * np.sqrt(np.pi)


# The rocket's arcs, written down anew: height h of COPS, c exhaust speed, D drag.
C = 0.5


def drag_of(x):
    return 310 * x[1] ** 2 * np.exp(-500 * (x[0] - 1))


def rocket(x, thrust):
    return np.array([x[1], (thrust - drag_of(x)) / x[2] - 1 / x[0] ** 2, -thrust / C])


def surface(x):
    """Zero on singular arcs: D (1 + v/c) = m g."""
    return drag_of(x) * (1 + x[1] / C) - x[2] / x[0] ** 2


def holding(x):
    """Return the thrust that stays on the surface: its gradient is at right angles to the rates."""
    h, v, m = x
    D = drag_of(x)
    gradient = np.array(
        [-500 * D * (1 + v / C) + 2 * m / h**3, 2 * D / v * (1 + v / C) + D / C, -1 / h**2]
    )
    drift = rocket(x, 0.0)
    return -gradient @ drift / (gradient @ (rocket(x, 1.0) - drift))


def fly_until(reached, law, x):
    def event(t, x):
        return reached(x)

    event.terminal = True
    settings = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
    flown = solve_ivp(lambda t, x: rocket(x, law(x)), (0, 1), x, events=event, **settings)
    return flown.t[-1], flown.y[:, -1]


def test_the_three_arcs_of_the_rocket_reach_the_height():
    """Full thrust to the singular surface, along it until the fuel is spent, up to rest."""
    reference = CATALOGUE["goddard"]()
    first, x = fly_until(surface, lambda x: 3.5, np.array([1.0, 1e-12, 1.0]))
    second, x = fly_until(lambda x: x[2] - 0.6, holding, x)
    third, x = fly_until(lambda x: x[1], lambda x: 0.0, x)
    assert -100 * (x[0] - 1) == pytest.approx(reference.optimum, abs=1e-8)
    np.testing.assert_allclose([first, first + second], reference.switches, atol=1e-9)
    answer = answered(reference)
    assert answer.duration == pytest.approx(first + second + third, abs=1e-3 * third)
