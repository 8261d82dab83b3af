"""Claim: every scheme converges at its own order; the orders hold to ±0.15 over three meshes.

Legend: N segments, h = T/N, p costate, λ raw multiplier of a defect. Orders are the slope of a
line through log error against log N.

Lobatto IIIA with three points (Hermite–Simpson) has order 4 for states, and its discrete adjoint is
Lobatto IIIB: the transformed adjoint has order 4 too, raw controls and raw multipliers only 2
(Hager, Numer. Math. 87 (2000) 247–282; Hairer, Lubich & Wanner, Geometric Numerical Integration).
"""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot import bank as problems

SCHEMES = {
    "euler": (sk.Euler, {}, 1, (160, 320, 640)),
    "trapezoid": (sk.Trapezoid, {}, 2, (20, 40, 80)),
    "hermite-simpson": (sk.HermiteSimpson, {}, 4, (10, 20, 40)),
    "hermite-simpson compressed": (sk.HermiteSimpson, {"form": "compressed"}, 4, (10, 20, 40)),
    "hermite-simpson averaged": (sk.HermiteSimpson, {"controls": "linear"}, 4, (10, 20, 40)),
}
SMOOTH = {"hager": problems.hager, "garg": problems.garg}
# Garg's states fall within a fifth of the horizon, so the asymptotic range starts later.
FINER = {"hager": 1, "garg": 4}


def solved(case, scheme, N):
    make, choices, _, _ = SCHEMES[scheme]
    reference = SMOOTH[case]()
    solution = sk.solve(
        reference.problem,
        make(N, **choices),
        solver="ipopt",
        guess=reference.guess,
        tolerance=1e-12,
    )
    assert solution.success, solution.message
    return reference, solution


def observed_order(meshes, errors):
    return -np.polyfit(np.log(meshes), np.log(errors), 1)[0]


def errors_of(case, scheme, measure):
    meshes = [FINER[case] * N for N in SCHEMES[scheme][3]]
    return meshes, [measure(*solved(case, scheme, N)) for N in meshes]


def state_error(reference, solution):
    return np.abs(solution.states - reference.state(solution.times)).max()


def objective_error(reference, solution):
    return abs(solution.objective - reference.optimum)


def costate_error(reference, solution):
    return np.abs(solution.costates - reference.costate(solution.times)).max()


def control_error(reference, solution):
    inner = slice(1, -1)
    return np.abs(solution.controls - reference.control(solution.times))[inner].max()


@pytest.mark.parametrize("case", SMOOTH)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("measure", [state_error, objective_error, costate_error])
def test_states_objective_and_costates_converge_at_the_claimed_order(case, scheme, measure):
    order = SCHEMES[scheme][2]
    assert observed_order(*errors_of(case, scheme, measure)) == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize(
    ("scheme", "order"), [("euler", 1), ("trapezoid", 2), ("hermite-simpson", 2)]
)
def test_raw_controls_at_inner_nodes_have_at_most_order_two(scheme, order):
    assert observed_order(*errors_of("hager", scheme, control_error)) == pytest.approx(
        order, abs=0.15
    )


def test_raw_midpoint_controls_have_order_two_and_half_the_error_of_the_nodes():
    def middle(reference, solution):
        t = 0.5 * (solution.times[1:] + solution.times[:-1])
        return np.abs(solution.midpoint_controls - reference.control(t)).max()

    meshes, errors = errors_of("hager", "hermite-simpson", middle)
    nodes = errors_of("hager", "hermite-simpson", control_error)[1]
    assert observed_order(meshes, errors) == pytest.approx(2, abs=0.15)
    # +h²/24 λ̈ at midpoints against −h²/12 λ̈ at nodes
    assert nodes[-1] / errors[-1] == pytest.approx(2, abs=0.15)


def test_the_raw_multiplier_is_a_second_order_estimate_at_the_midpoint():
    def raw(reference, solution):
        middle = 0.5 * (solution.times[1:] + solution.times[:-1])
        return np.abs(solution.multipliers["defects"][:, -1] - reference.costate(middle)).max()

    assert observed_order(*errors_of("hager", "hermite-simpson", raw)) == pytest.approx(2, abs=0.15)


def test_between_nodes_the_interpolant_has_order_three():
    """Rates carry the O(h²) saw-tooth of the raw controls; over part of a segment that is O(h³)."""

    def between(reference, solution):
        t = np.linspace(0, solution.times[-1], 997)
        return np.abs(solution.state(t) - reference.state(t)).max()

    order = observed_order(*errors_of("hager", "hermite-simpson", between))
    assert order == pytest.approx(3, abs=0.15)


def test_the_full_quadrotor_converges_at_order_four():
    reference = problems.quadrotor_transfer()
    meshes = (10, 20, 40)
    errors = [
        sk.solve(
            reference.problem, sk.HermiteSimpson(N), guess=reference.guess, tolerance=1e-10
        ).objective
        - reference.optimum
        for N in meshes
    ]
    assert observed_order(meshes, errors) == pytest.approx(4, abs=0.15)


def test_bang_bang_limits_the_order_to_two():
    reference = problems.minimum_time()
    # switch at two thirds: these meshes never put a node on it, always the same share past one
    meshes = (10, 40, 160)
    errors = [
        sk.solve(reference.problem, sk.HermiteSimpson(N), tolerance=1e-10).objective
        - reference.optimum
        for N in meshes
    ]
    assert observed_order(meshes, errors) == pytest.approx(2, abs=0.15)
