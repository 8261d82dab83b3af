"""Claim: the structured projection is the least-distance step inside defects and bounds.

The other road is dense: the same quadratic program, its matrices column by column, solved by the
active-set method of CasADi (qrqp).
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from skyknot import missions
from skyknot.solvers.bounded_projection import BoundedProjection
from skyknot.solvers.interior_projection import interior_projection
from skyknot.solvers.metric import Metric

REGULARISATION = 1e-3


class System:
    """A frozen metric of the report's transfer on a few segments, and its matrices."""

    def __init__(self) -> None:
        mission = missions.load("report_transfer")
        self.metric = Metric(sk.HermiteSimpson(8).program(mission.problem, mission.guess))
        metric = self.metric
        point = metric.differentiate(metric.start)
        metric.freeze()
        assert metric.factor(metric.fixed, REGULARISATION)
        self.w, self.r, self.d = point.w, point.gradient, point.defects
        self.free = np.flatnonzero(metric.here & ~metric.fixed)
        columns = [metric.product(np.eye(len(self.w))[i]) for i in self.free]
        self.M = np.array([Mv[self.free] for Mv, _ in columns]).T
        self.A = np.array([Av.ravel() for _, Av in columns]).T
        self.exact = self._dense()

    def _dense(self) -> tuple[np.ndarray, np.ndarray]:
        """Return step and multipliers of the dense quadratic program."""
        sparsities = {"h": ca.DM(self.M).sparsity(), "a": ca.DM(self.A).sparsity()}
        quiet = {"print_iter": False, "print_header": False, "print_info": False}
        solver = ca.conic("projection", "qrqp", sparsities, quiet)
        low, high = self.metric.lower - self.w, self.metric.upper - self.w
        found = solver(
            h=self.M,
            a=self.A,
            g=self.r[self.free],
            lba=-self.d.ravel(),
            uba=-self.d.ravel(),
            lbx=low[self.free],
            ubx=high[self.free],
        )
        return np.array(found["x"]).ravel(), np.array(found["lam_a"]).ravel()


@pytest.fixture(scope="module")
def system():
    return System()


def test_the_matrices_are_those_of_the_program(system):
    ahead = system.metric.evaluate(system.w + 1e-6 * np.eye(len(system.w))[system.free[40]])[1]
    behind = system.metric.evaluate(system.w - 1e-6 * np.eye(len(system.w))[system.free[40]])[1]
    np.testing.assert_allclose(system.A[:, 40], (ahead - behind).ravel() / 2e-6, atol=1e-8)
    np.testing.assert_allclose(system.M, system.M.T, atol=1e-10)
    assert np.linalg.eigvalsh(system.M).min() > 0


def test_the_projection_agrees_with_a_dense_active_set_method(system):
    step, multipliers = system.exact
    projection = BoundedProjection(system.metric, REGULARISATION)
    found = projection.project(system.w, system.r, system.d)
    assert found is not None
    assert found.share == 1.0
    assert np.count_nonzero(projection.active) > 2
    np.testing.assert_allclose(found.step[system.free], step, atol=1e-9)
    largest = np.abs(multipliers).max()
    np.testing.assert_allclose(found.multipliers.ravel(), multipliers, atol=1e-9 * largest)


def test_the_interior_point_finds_the_same_step_and_active_set(system):
    metric = system.metric
    low, high = metric.lower - system.w, metric.upper - system.w
    found = interior_projection(metric, system.r, system.d, low, high, REGULARISATION)
    assert found is not None
    np.testing.assert_allclose(found.step[system.free], system.exact[0], atol=1e-4)
    projection = BoundedProjection(metric, REGULARISATION)
    settled = projection.project(system.w, system.r, system.d)
    assert settled is not None
    np.testing.assert_array_equal(found.active, projection.active)


def test_the_second_projection_needs_no_factorisation(system):
    metric = system.metric
    projection = BoundedProjection(metric, REGULARISATION)
    projection.project(system.w, system.r, system.d)
    before = dict(metric.work)
    projection.project(system.w, 1.001 * system.r, system.d)
    assert metric.work["factorisations"] == before["factorisations"]
    assert metric.work["solves"] == before["solves"] + 1


def hauled(push: float) -> tuple[Metric, BoundedProjection]:
    """Return 0.8 m in 1 s, rest to rest, with a bounded push: reaches push / 4."""
    problem = sk.Problem(
        "hauled",
        ["height", "speed"],
        ["push"],
        lambda x, u: [x[1], u[0]],
        horizon=1.0,
        initial=[1.0, 0.0],
        final=[0.2, 0.0],
        running_cost=lambda x, u: u[0] ** 2,
        control_bounds=(-push, push),
    )
    line = sk.Trajectory([0.0, 1.0], [[1.0, 0.0], [0.2, 0.0]], [[0.0], [0.0]])
    metric = Metric(sk.HermiteSimpson(20).program(problem, line))
    return metric, BoundedProjection(metric, REGULARISATION)


@pytest.mark.parametrize(("push", "share"), [(3.3, 1.0), (1.1, 0.3), (0.1, 0.03)])
def test_defects_out_of_reach_are_removed_in_the_part_that_is_within(push, share):
    metric, projection = hauled(push)
    point = metric.differentiate(metric.start)
    metric.freeze()
    found = projection.project(point.w, point.gradient, point.defects)
    assert found is not None
    assert found.share == share
    removed = metric.product(found.step)[1]
    np.testing.assert_allclose(removed, -share * point.defects, atol=1e-8)


def test_a_projection_that_does_not_exist_is_told():
    metric, projection = hauled(0.001)
    point = metric.differentiate(metric.start)
    metric.freeze()
    assert projection.project(point.w, point.gradient, point.defects) is None
