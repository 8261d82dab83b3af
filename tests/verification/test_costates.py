"""Claim: costates and Hamiltonian are measured against the continuous conditions."""

from dataclasses import replace

import numpy as np
import pytest

import skyknot as sk
from agreement.variants import PROBLEMS
from skyknot.verification import Limits, hamiltonian
from skyknot.verification.costates import costate_equation
from skyknot.verification.evidence import Evidence


def least_energy(**changes):
    """x'' = u from rest to rest, 1 m in 1 s: u = 6 − 12 t, p = (−12, 12 t − 6), H = −18."""
    asked = {
        "name": "least energy",
        "states": ["x", "v"],
        "controls": ["u"],
        "dynamics": lambda x, u: [x[1], u[0]],
        "horizon": 1.0,
        "initial": [0, 0],
        "final": [1, 0],
        "running_cost": lambda x, u: 0.5 * u[0] ** 2,
    }
    return sk.Problem(**(asked | changes))


def evidence_of(solution, **witness_changes):
    witness = replace(solution.full_witness(), **witness_changes)
    return Evidence(solution.problem, solution.trajectory, solution.record.parameters, witness)


@pytest.fixture(scope="module")
def energy():
    return sk.solve(least_energy(), sk.HermiteSimpson(10), tolerance=1e-9)


@pytest.fixture(scope="module")
def ceiling():
    """Bryson and Denham's problem: the state touches its bound from t = 1/3 to 2/3."""
    asked = least_energy(initial=[0, 1], final=[0, -1], state_bounds=([None, None], [1 / 9, None]))
    return sk.solve(asked, sk.HermiteSimpson(30))


def test_costates_and_hamiltonian_of_the_closed_form(energy):
    adjoint = evidence_of(energy).adjoint
    tau = np.array([0.0, 0.3, 1.0])
    t = energy.times[:-1, None] + 0.1 * tau
    known = np.stack([np.full_like(t, -12.0), 12 * t - 6], axis=2)
    assert np.allclose(adjoint.at(tau), known, atol=1e-6)
    H, size = hamiltonian._of_segments(evidence_of(energy).program)
    assert np.allclose(H, -18, atol=1e-5)
    assert size > 18


def test_the_jump_of_a_costate_at_a_state_bound_is_accounted_for(ceiling):
    """The costate of x jumps twice; without its multipliers the equation would not hold."""
    checks = ceiling.verify().checks
    assert checks["costate equation"].passed
    assert checks["Hamiltonian"].passed
    first, before = evidence_of(ceiling).adjoint.ends
    assert np.max(np.abs(first[1:] - before[:-1])) > 1
    without = np.zeros_like(ceiling.witness.state_bounds)
    bare = evidence_of(ceiling, state_bounds=without)
    assert not costate_equation(bare, Limits()).passed


def test_a_free_end_asks_for_the_slope_of_the_end_cost():
    asked = least_energy(final=[None, None], terminal_cost=lambda x, tf: 3 * (x[0] - 1) ** 2)
    solution = sk.solve(asked, sk.HermiteSimpson(10))
    check = solution.verify().checks["transversality"]
    assert check.passed
    assert abs(solution.costates[-1, 0]) > 1
    moved = replace(solution, costates=solution.costates + 1e-3)
    assert not moved.verify().checks["transversality"].passed
    assert not moved.verify().checks["costates"].passed


def test_with_both_ends_fixed_there_is_no_transversality(energy):
    assert "transversality" not in energy.verify().checks


def test_a_free_horizon_asks_for_a_hamiltonian_of_zero():
    asked = least_energy(horizon=sk.Free(0.5, 4.0), running_cost=lambda x, u: 1 + 0.5 * u[0] ** 2)
    solution = sk.solve(asked, sk.HermiteSimpson(20))
    check = solution.verify().checks["Hamiltonian"]
    assert check.value < 1e-5
    H, _ = hamiltonian._of_segments(evidence_of(solution).program)
    assert np.allclose(H, 0, atol=1e-5)


def test_a_problem_that_depends_on_time_has_no_constant_hamiltonian():
    solution = sk.solve(PROBLEMS["timed path"], sk.HermiteSimpson(8))
    assert "Hamiltonian" not in solution.verify().checks


def test_a_control_that_is_not_least_is_priced(energy):
    """With a weight of ½, a control off by 0.3 costs 0.045 a second above the least."""
    segments = energy.trajectory.segments
    off = replace(segments, control_values=segments.control_values + 0.3)
    worse = replace(energy, trajectory=replace(energy.trajectory, segments=off))
    check = worse.verify().checks["minimum principle"]
    assert check.value == pytest.approx(0.045, rel=1e-4)
    assert energy.verify().checks["minimum principle"].value < 1e-8


def test_a_hamiltonian_that_is_not_quadratic_is_sampled():
    """ℓ = u⁴/4 + u²/2 is convex in u: the answer is the least."""
    asked = least_energy(
        running_cost=lambda x, u: 0.25 * u[0] ** 4 + 0.5 * u[0] ** 2, control_bounds=(-9, 9)
    )
    good = sk.solve(asked, sk.HermiteSimpson(20)).verify().checks["minimum principle"]
    assert good.passed
    assert "samples" in good.how


def test_controls_that_mix_in_the_hamiltonian_are_minimised_together():
    R = np.array([[[2.0, 1.0], [1.0, 2.0]]])
    b = np.array([[3.0, 0.0]])
    wide = np.full((1, 2), 10.0)
    gap = hamiltonian._box_gaps(b, R, -wide, wide)
    assert gap[0] == pytest.approx(0.5 * b[0] @ np.linalg.solve(R[0], b[0]), rel=1e-6)
    tight = hamiltonian._box_gaps(b, R, np.array([[-1.0, 0.0]]), np.array([[0.0, 0.0]]))
    assert tight[0] == pytest.approx(2.0)
