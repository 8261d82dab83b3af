"""Claim: a proof between the nodes holds everywhere, and thin obstacles do not slip through."""

from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import skyknot as sk
from skyknot.problem import airspace
from skyknot.problem.constraints import PathConstraint
from skyknot.verification import certify
from skyknot.verification.enclosures import Margin, Path
from skyknot.verification.equations import Equations
from skyknot.verification.evidence import Evidence
from skyknot.verification.guarantee import carried, drift_of

SHAPES = {
    "cylinder": airspace.cylinder("c", (0.3, 0.2), 0.4),
    "sphere": airspace.sphere("s", (0.1, 0.2, -0.3), 0.5, clearance=0.1),
    "ellipsoid": airspace.ellipsoid("e", (0.1, 0.2, -0.3), (0.5, 0.2, 0.9), clearance=0.1),
    "box": airspace.box("b", (0.1, 0.2, -0.3), (0.5, 0.2, 0.9), yaw=0.4, clearance=0.1),
    "half space": airspace.half_space("h", (1, 2, 3), 0.2),
    "corridor": airspace.corridor("k", (0, 0, 0), (1, 1, -1), 0.4),
    "tube": airspace.tube("t", [(0, 0, 0), (1, 0, 0), (1, 1, -1)], 0.4),
    "altitude": airspace.altitude_band("a", 0.0, 0.5),
    "speed": airspace.speed_limit("v", 0.7),
    "tilt": airspace.tilt_limit("i", 0.6),
    "ramp": PathConstraint("ramp", lambda x, u, t: x[0] - ca.sin(3 * t), upper=0.2),
}
ZERO = np.zeros(8)


def asked(entry):
    """Eight free states: position, velocity, two angles."""
    names = ["x", "y", "z", "vx", "vy", "vz", "phi", "theta"]
    return sk.Problem("free", names, ["u"], lambda x, u: [0 * u[0]] * 8, 1.0, path=[entry])


@pytest.mark.parametrize("degree", [1, 3, 12])
@pytest.mark.parametrize("name", SHAPES)
def test_the_proof_lies_below_every_sample_and_close_to_the_least(name, degree):
    random = np.random.default_rng(degree)
    decay = 0.6 ** np.arange(degree + 1)
    C = 0.6 * decay[None, :, None] * random.normal(size=(6, degree + 1, 8))
    path = Path(C, np.linspace(0, 1, 7))
    entry, slack = SHAPES[name], 1e-3
    problem = asked(entry)
    tau = np.linspace(0, 1, 4001)
    X = np.stack([np.polynomial.chebyshev.chebval(2 * tau - 1, c).T for c in C])
    for bound, sign in ((entry.lower, 1.0), (entry.upper, -1.0)):
        if bound is None:
            continue
        margin = Margin(Equations(problem, {}), 0, bound, sign)
        proved = margin.least(path, enough=np.inf, slack=slack)
        for k in range(6):
            least = margin.values(X[k], (k + tau) / 6).min()
            assert proved[k] <= least + 1e-12
            assert proved[k] >= least - 1.1 * slack


def straight(speed=20.0, segments=10):
    """Fly straight along x, with no obstacle in the problem that was solved."""
    return sk.Problem(
        "past a pole",
        ["x", "y"],
        ["u"],
        lambda x, u: [speed + 0 * u[0], 0],
        segments * 0.1,
        initial=[0, 0],
    )


def with_pole(place, radius):
    problem = straight()
    problem.path = (airspace.cylinder("pole", (place, 0.0), radius),)
    return problem


def test_a_thin_obstacle_between_two_samples_is_caught():
    """Samples lie 17 cm apart; a pole of 5 cm stands in the middle between two of them."""
    trajectory = sk.solve(straight(), sk.HermiteSimpson(10)).trajectory
    checks = certify(with_pole(9.0, 0.05), trajectory).checks
    assert checks["path"].passed
    assert checks["path between nodes"].passed
    assert not checks["path guaranteed"].passed
    assert checks["path guaranteed"].value == pytest.approx(0.05, abs=1e-3)
    assert checks["path guaranteed"].worst == "pole at 0.4 s"


def test_the_same_pole_beside_the_way_is_proved_to_be_missed():
    trajectory = sk.solve(straight(), sk.HermiteSimpson(10)).trajectory
    problem = with_pole(9.0, 0.05)
    problem.path = (airspace.cylinder("pole", (9.0, 0.06), 0.05),)
    checks = certify(problem, trajectory).checks
    assert checks["path guaranteed"].value == 0
    assert checks["path guaranteed"].passed


def test_the_error_of_the_dynamics_within_a_segment_is_added():
    """x' = t by Euler: the flight leaves the straight line by h²/2, and so may leave the bound."""
    wall = PathConstraint("wall", lambda x, u: x[0], upper=10.0, unit="m")
    problem = sk.Problem(
        "clock", ["x"], ["u"], lambda x, u, t: [t + 0 * u[0]], 1.0, initial=[0], path=[wall]
    )
    trajectory = sk.solve(problem, sk.Euler(10)).trajectory
    drift = carried(Evidence(problem, trajectory, {}))
    assert np.allclose(drift, 0.005)
    end = trajectory.states[-1, 0]
    problem.path = (PathConstraint("wall", wall.function, upper=end + 0.001, unit="m"),)
    check = certify(problem, trajectory).checks["path guaranteed"]
    assert check.value == pytest.approx(0.004, abs=1e-6)


def test_an_error_grows_with_the_dynamics_it_moves_in():
    """x' = 5 x by Euler: the error within a segment is carried on by exp(5 h)."""
    problem = sk.Problem("growth", ["x"], ["u"], lambda x, u: [5 * x[0]], 1.0, initial=[1])
    trajectory = sk.solve(problem, sk.Euler(20)).trajectory
    h, x = 0.05, trajectory.states[:-1, 0]
    residual = 25 * x * h**2 / 2  # ∫ |5 x_k − 5 x_k (1 + 5 t)| dt
    drift = carried(Evidence(problem, trajectory, {}))[:, 0]
    assert np.allclose(drift, residual * np.exp(5 * h), rtol=2e-3)
    exact = x * np.exp(5 * h) - trajectory.states[1:, 0]
    assert np.all(drift > exact)


FLIERS = {
    "pendulum": lambda x, u, t: [x[1], -ca.sin(x[0]) + u[0] + 0.2 * ca.cos(3 * t)],
    "drag": lambda x, u, t: [x[1], u[0] - 0.4 * x[1] * ca.sqrt(x[1] ** 2 + 0.01)],
    "unstable": lambda x, u, t: [x[1], 4 * x[0] + u[0] * x[1]],
}


@pytest.mark.parametrize("scheme", [sk.Euler(30), sk.HermiteSimpson(10), sk.Lobatto(2, points=7)])
@pytest.mark.parametrize("name", FLIERS)
def test_a_flight_stays_within_the_drift_proved(name, scheme):
    """Flown by SciPy from every node, measured against the polynomial at 200 times a segment."""
    rates = FLIERS[name]
    problem = sk.Problem(
        name,
        ["x", "v"],
        ["u"],
        lambda x, u, t: rates(x, u, t),
        2.0,
        initial=[0, 0.5],
        final=[1, None],
        running_cost=lambda x, u: u[0] ** 2,
    )
    evidence = Evidence(problem, sk.solve(problem, scheme).trajectory, {})
    proved, said = drift_of(evidence)
    assert said == "proved too"
    for k, (start, end) in enumerate(pairwise(evidence.times)):
        t = np.linspace(start, end - 1e-12, 200)
        flown = solve_ivp(
            lambda s, y: [float(each) for each in rates(y, evidence.trajectory.control(s), s)],
            (start, end),
            evidence.trajectory.states[k],
            "DOP853",
            t,
            rtol=1e-11,
            atol=1e-13,
        )
        apart = np.max(np.abs(flown.y.T - evidence.trajectory.state(t)), axis=0)
        assert np.all(apart <= proved[k] + 1e-11)
    sharp = np.max(np.sum(carried(evidence), axis=1))
    assert np.max(np.sum(proved, axis=1)) < 50 * sharp + 1e-3


def test_dynamics_without_interval_arithmetic_are_sampled_and_that_is_said():
    problem = with_pole(50.0, 0.05)
    problem.dynamics = lambda x, u: [20.0 + 1e-9 * ca.if_else(x[0] > 3, u[0], x[1]), 0]
    evidence = Evidence(problem, sk.solve(straight(), sk.HermiteSimpson(10)).trajectory, {})
    drift, said = drift_of(evidence)
    assert said.startswith("sampled only (CasADi operation")
    np.testing.assert_array_equal(drift, carried(evidence))


def test_a_proof_that_does_not_close_is_sampled_and_that_is_said():
    """A segment so long that no box holds the flight."""
    problem = sk.Problem(
        "blow up", ["x"], ["u"], lambda x, u: [x[0] ** 2 + 0 * u[0]], 0.9, initial=[1.0]
    )
    trajectory = sk.Trajectory([0, 0.9], [[1.0], [10.0]], [[0], [0]])
    drift, said = drift_of(Evidence(problem, trajectory, {}))
    assert said == "sampled only in 1 segments"
    assert np.all(np.isfinite(drift))


def test_a_constraint_without_interval_arithmetic_is_named():
    strange = PathConstraint("strange", lambda x, u: ca.if_else(x[0] > 3, x[0], x[1]), upper=1e3)
    problem = with_pole(50.0, 0.05)
    problem.path = (*problem.path, strange)
    trajectory = sk.solve(straight(), sk.HermiteSimpson(10)).trajectory
    check = certify(problem, trajectory).checks["path guaranteed"]
    assert check.passed
    assert "without a proof for want of interval arithmetic: strange" in check.how


def test_constraints_on_controls_are_left_to_their_averages():
    effort = PathConstraint("effort", lambda x, u: u[0], upper=1.0)
    problem = straight()
    problem.path = (effort,)
    trajectory = sk.solve(straight(), sk.HermiteSimpson(10)).trajectory
    checks = certify(problem, trajectory).checks
    assert "path between nodes" in checks
    assert "path guaranteed" not in checks
