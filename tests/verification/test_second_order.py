"""Claim: the recursion tells whether a program curves upwards wherever it may move."""

from dataclasses import replace

import numpy as np
import pytest
from drone_on_rail import problem
from scipy.linalg import null_space

import skyknot as sk
from agreement.variants import PROBLEMS, SCHEMES
from skyknot.verification.critical_cone import CriticalCone, Stage
from skyknot.verification.curvature import measured
from skyknot.verification.evidence import Evidence


class Stages:
    """Stages drawn at random, with what the recursion asks of a cone."""

    def __init__(self, seed, shift):
        random = np.random.default_rng(seed)
        n, nv, count = 4, 3, 5
        self.n_stage, self.stages = n, []
        for k in range(count):
            H = random.normal(size=(n + nv, n + nv))
            N = random.normal(size=(n, n + nv))
            rows = random.integers(0, 3) + (3 if k == count - 1 else 0)
            D = random.normal(size=(rows, n + nv))
            if k == 0:
                D = np.concatenate([np.eye(n, n + nv)[: random.integers(0, n + 1)], D])
            D = D / np.linalg.norm(D, axis=1, keepdims=True)
            self.stages.append(Stage(H @ H.T + shift * np.eye(n + nv), N, D))


def dense_least(stages):
    """Return the least eigenvalue of the Hessian on the null space of all rows."""
    n = stages[0].N.shape[0]
    sizes = [stage.N.shape[1] - n for stage in stages]
    total = n + sum(sizes)
    sigma, column = np.eye(n, total), n
    H, rows = np.zeros((total, total)), []
    for stage, size in zip(stages, sizes, strict=True):
        both = np.concatenate([sigma, np.eye(size, total, column)])
        H += both.T @ stage.H @ both
        rows.append(stage.D @ both)
        sigma, column = stage.N @ both, column + size
    free = null_space(np.concatenate(rows))
    return np.linalg.eigvalsh(free.T @ H @ free)[0] if free.shape[1] else np.inf


@pytest.mark.parametrize("shift", [0.5, -1.0, -3.0, -6.0])
@pytest.mark.parametrize("seed", range(12))
def test_the_sign_is_that_of_the_dense_projected_hessian(seed, shift):
    cone = Stages(seed, shift)
    assert np.min(measured(cone).least) * dense_least(cone.stages) > 0


def evidence_of(solution):
    return Evidence(
        solution.problem, solution.trajectory, solution.record.parameters, solution.full_witness()
    )


@pytest.mark.parametrize("scheme", SCHEMES)
def test_points_move_as_the_scheme_does(scheme):
    """Steps of the linearised defects, against differences of the defects themselves."""
    solution = sk.solve(PROBLEMS["parameters"], SCHEMES[scheme])
    evidence = evidence_of(solution)
    cone = CriticalCone(evidence.program, evidence.state_sizes)
    direction = np.random.default_rng(3).normal(size=cone.moves.shape[3])
    moved, epsilon = cone.moves @ direction, 1e-4
    ahead = defects_at(evidence.program, epsilon * moved)
    behind = defects_at(evidence.program, -epsilon * moved)
    assert np.max(np.abs(moved[..., :2])) > 0.1
    assert np.max(np.abs(ahead - behind)) / (2 * epsilon) < 1e-6


def defects_at(program, change):
    """Return the defects with states, controls and globals moved by change (N, s, nx + nu + nq)."""
    w, (count, s) = program.witness, program.places.shape
    X, U = program.X + change[..., :2], program.U + change[..., 2:4]
    q = program.lagrangian.q
    program.lagrangian.q = q + change[0, 0, 4:]
    arrays = (X, U, program.places, w.weights, program.nu, w.path)
    flat = [each.reshape(count * s, *each.shape[2:]) for each in arrays]
    rates = program.lagrangian.first(*flat)[1].reshape(X.shape)
    program.lagrangian.q = q
    motion = np.einsum("k,ij,kjx->kix", program.fractions, w.A, rates)
    return np.einsum("ij,kjx->kix", w.C, X) + program.duration * motion


@pytest.mark.parametrize("name", PROBLEMS)
def test_optima_curve_upwards(name):
    check = sk.solve(PROBLEMS[name], sk.HermiteSimpson(8)).verify().checks["second order"]
    assert check.passed
    assert check.value == 0
    assert "not strict" not in check.worst


def test_a_saddle_that_is_stationary_is_seen():
    """u₂ = 0 is stationary whether ± u₂² is paid; only one of the two is a minimum."""

    def asked(sign):
        return sk.Problem(
            "saddle",
            ["x"],
            ["u", "w"],
            lambda x, u: [u[0]],
            1.0,
            initial=[0],
            final=[1],
            running_cost=lambda x, u: u[0] ** 2 + sign * u[1] ** 2,
        )

    bowl = sk.solve(asked(+1), sk.HermiteSimpson(6))
    saddle = replace(bowl, problem=asked(-1)).verify()
    assert saddle.checks["stationarity"].passed
    assert not saddle.checks["second order"].passed
    assert bowl.verify().checks["second order"].passed


def test_bang_bang_controls_are_not_judged_and_that_is_said():
    fastest = problem(rates=None, points=[], horizon=sk.Free(0.5, 4), running_cost=lambda x, u: 1.0)
    certificate = sk.solve(fastest, sk.HermiteSimpson(40)).verify()
    assert "second order" not in certificate.checks
    assert "Second order was not judged: the cost does not curve in a." in certificate.notes


def test_saturation_is_told_and_does_not_fail():
    tight = problem(rates=None, points=[], control_bounds=(-1.7, 1.7), horizon=1.7)
    check = sk.solve(tight, sk.HermiteSimpson(40)).verify().checks["saturation"]
    assert check.passed
    assert 5 < check.value < 95
    assert check.worst == f"a {check.value:.2g} %"
    loose = sk.solve(problem(), sk.HermiteSimpson(40)).verify().checks["saturation"]
    assert loose.value == 0
    assert loose.worst.startswith("a keeps ")
