"""Claim: what is read between the nodes is what the scheme solved."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from skyknot.trajectory import integral_basis, lagrange_basis

PENDULUM = sk.Problem(
    "pendulum",
    ["angle", "spin"],
    ["torque"],
    lambda x, u: [x[1], -ca.sin(x[0]) + u[0]],
    horizon=2.0,
    initial=[0.0, 0.0],
    final=[1.0, 0.0],
    running_cost=lambda x, u: u[0] ** 2,
)
MESH = np.array([0.0, 0.1, 0.35, 0.6, 0.7, 1.0])
SCHEMES = {
    "euler": sk.Euler(mesh=MESH),
    "trapezoid": sk.Trapezoid(mesh=MESH),
    "trapezoid, hold": sk.Trapezoid(mesh=MESH, controls="hold"),
    "hermite-simpson": sk.HermiteSimpson(mesh=MESH),
    "compressed": sk.HermiteSimpson(mesh=MESH, form="compressed"),
    "linear": sk.HermiteSimpson(mesh=MESH, controls="linear"),
    "hold": sk.HermiteSimpson(mesh=MESH, controls="hold"),
    "lobatto": sk.Lobatto(mesh=MESH, points=4),
    "lobatto, discontinuous": sk.Lobatto(mesh=MESH, points=5, controls="discontinuous"),
    "radau": sk.Radau(mesh=MESH, points=3),
    "radau, one point": sk.Radau(mesh=MESH, points=1),
    "chebyshev": sk.Chebyshev(mesh=MESH, points=6),
}
POLYNOMIAL = ("lobatto", "lobatto, discontinuous", "radau", "chebyshev")


@pytest.fixture(scope="module", params=SCHEMES)
def solved(request):
    solution = sk.solve(PENDULUM, SCHEMES[request.param], tolerance=1e-12)
    assert solution.success
    return request.param, solution


def rate(x, u):
    return np.stack([x[..., 1], -np.sin(x[..., 0]) + u[..., 0]], axis=-1)


def test_nodes_are_read_exactly(solved):
    name, solution = solved
    np.testing.assert_allclose(solution.state(solution.times), solution.states, atol=1e-13)
    if name == "radau":  # its value at a node is that of the segment before
        found = solution.control(np.append(0.0, solution.times[1:] - 1e-12))
        np.testing.assert_allclose(found, solution.controls, atol=1e-9)
    else:
        np.testing.assert_allclose(solution.control(solution.times)[:-1], solution.controls[:-1])
    np.testing.assert_allclose(solution.times, 2 * MESH)


def test_states_are_continuous_across_nodes(solved):
    _, solution = solved
    inner = solution.times[1:-1]
    before, after = solution.state(inner - 1e-9), solution.state(inner + 1e-9)
    np.testing.assert_allclose(before, after, atol=1e-7)


def test_the_state_is_the_integral_of_its_own_rate(solved):
    _, solution = solved
    t = np.linspace(0.0, 2.0, 400)[1:-1] + 1e-4
    step = 1e-6
    slope = (solution.state(t + step) - solution.state(t - step)) / (2 * step)
    away = np.abs(t[:, None] - solution.times).min(axis=1) > 2 * step
    np.testing.assert_allclose(slope[away], solution.trajectory.state_rate(t)[away], atol=1e-7)


def test_midpoints_are_what_the_scheme_solved_for(solved):
    name, solution = solved
    middle = 0.5 * (solution.times[1:] + solution.times[:-1])
    np.testing.assert_allclose(solution.state(middle), solution.midpoint_states, atol=1e-12)
    np.testing.assert_allclose(solution.control(middle), solution.midpoint_controls)
    if name in ("hermite-simpson", "compressed", "linear", "hold"):
        expected = rate(solution.midpoint_states, solution.midpoint_controls)
        np.testing.assert_allclose(solution.trajectory.state_rate(middle), expected, atol=1e-10)


def test_interior_points_are_what_a_longer_scheme_solved_for(solved):
    name, solution = solved
    inside = solution.trajectory.segments
    h = np.diff(solution.times)[:, None]
    for places, values, read in (
        (inside.interior_points, inside.interior_states, solution.state),
        (inside.rate_points[inside.rate_points < 1], inside.rates, solution.trajectory.state_rate),
    ):
        t = (solution.times[:-1, None] + h * places).ravel()
        expected = values[:, : len(places)].reshape(len(t), 2)
        np.testing.assert_allclose(read(t), expected, atol=1e-10)
    if name in POLYNOMIAL:
        inner = inside.rate_points < 1
        t = (solution.times[:-1, None] + h * inside.rate_points[inner]).ravel()
        expected = rate(solution.state(t), solution.control(t))
        np.testing.assert_allclose(solution.trajectory.state_rate(t), expected, atol=1e-9)


def test_controls_follow_their_parametrisation(solved):
    name, solution = solved
    if name in POLYNOMIAL:
        values = solution.trajectory.segments.control_values[2, :, 0]
        tau = np.linspace(0, 1, len(values) + 3)[1:-1]
        t = solution.times[2] + tau * (solution.times[3] - solution.times[2])
        fit = np.polyfit(tau, solution.control(t)[:, 0], len(values) - 1)
        points = solution.trajectory.segments.control_points
        np.testing.assert_allclose(np.polyval(fit, points), values, atol=1e-9)
        return
    k, tau = 2, np.array([0.2, 0.9])
    t = solution.times[k] + tau * (solution.times[k + 1] - solution.times[k])
    left, right = solution.controls[k, 0], solution.controls[k + 1, 0]
    middle = solution.midpoint_controls[k, 0]
    parametrisation = SCHEMES[name].controls
    expected = {
        "hold": np.full(2, left),
        "linear": left + tau * (right - left),
        "quadratic": left * (1 - tau) * (1 - 2 * tau)
        + 4 * middle * tau * (1 - tau)
        + right * tau * (2 * tau - 1),
    }[parametrisation]
    np.testing.assert_allclose(solution.control(t)[:, 0], expected, atol=1e-12)


def test_a_held_control_jumps_at_the_node():
    solution = sk.solve(PENDULUM, SCHEMES["hold"], tolerance=1e-10)
    node = solution.times[2]
    before, after = solution.control(node - 1e-9)[0], solution.control(node + 1e-9)[0]
    assert before == solution.controls[1, 0]
    assert after == solution.controls[2, 0]
    assert before != pytest.approx(after, abs=1e-3)


def test_scalar_and_array_times_agree_in_value_and_shape(solved):
    _, solution = solved
    assert solution.state(0.3).shape == (2,)
    assert solution.control(0.3).shape == (1,)
    assert solution.state([0.3, 0.4, 0.5]).shape == (3, 2)
    np.testing.assert_array_equal(solution.state([0.3])[0], solution.state(0.3))


def test_times_outside_are_held_at_the_ends(solved):
    _, solution = solved
    np.testing.assert_allclose(solution.state(-1.0), solution.states[0])
    np.testing.assert_allclose(solution.state(9.0), solution.states[-1], atol=1e-13)


def test_a_trajectory_without_a_scheme_is_linear():
    guess = sk.Trajectory([0.0, 1.0, 3.0], [[0.0], [2.0], [0.0]], [[1.0], [1.0], [5.0]])
    np.testing.assert_allclose(guess.state([0.5, 2.0])[:, 0], [1.0, 1.0])
    np.testing.assert_allclose(guess.control([0.5, 2.0])[:, 0], [1.0, 3.0])
    np.testing.assert_allclose(guess.state_rate([0.5, 2.0])[:, 0], [2.0, -1.0])
    assert guess.duration == 3.0


@pytest.mark.parametrize("points", [[0.0], [0.0, 1.0], [0.0, 0.5, 1.0], [0.0, 0.3, 0.7, 1.0]])
def test_the_bases_reproduce_and_integrate_polynomials(points):
    points, tau = np.array(points), np.linspace(0, 1, 9)
    for degree in range(len(points)):
        np.testing.assert_allclose(
            lagrange_basis(points, tau) @ points**degree, tau**degree, atol=1e-13
        )
        np.testing.assert_allclose(
            integral_basis(points, tau) @ points**degree,
            tau ** (degree + 1) / (degree + 1),
            atol=1e-13,
        )


@pytest.mark.parametrize("count", [2, 3, 10, 41, 100])
def test_the_bases_are_stable_for_many_points(count):
    """Runge's function at Chebyshev points: read between them, and integrated, to rounding."""
    points = np.sin(0.5 * np.pi * np.arange(count) / (count - 1)) ** 2
    tau = np.concatenate([np.linspace(0, 1, 301), points])
    values, integrals = lagrange_basis(points, tau), integral_basis(points, tau)
    np.testing.assert_allclose(values.sum(axis=1), 1, atol=1e-13)
    np.testing.assert_allclose(integrals.sum(axis=1), tau, atol=1e-13)
    np.testing.assert_array_equal(values[301:], np.eye(count))
    if count == 100:
        inner, outer = 10 * points - 5, 10 * tau - 5
        fit = values @ (1 / (1 + inner**2))
        area = 10 * integrals @ (1 / (1 + inner**2))
        # |u − p| ≤ 4M ρ^−n/(ρ − 1), the pole i/5 leaves ρ = 1.2198: Trefethen, ATAP, theorem 8.2
        np.testing.assert_allclose(fit, 1 / (1 + outer**2), atol=1e-7)
        np.testing.assert_allclose(area, np.arctan(outer) + np.arctan(5), atol=1e-7)


BAD = {
    "must increase": ([0.0, 0.0], [[0.0]] * 2, [[0.0]] * 2),
    "at least two": ([0.0], [[0.0]], [[0.0]]),
    "The states of a trajectory must have one row": ([0.0, 1.0], [[0.0]] * 3, [[0.0]] * 2),
    "The controls of a trajectory must have one row": ([0.0, 1.0], [[0.0]] * 2, [0.0, 0.0]),
    "not a finite number": ([0.0, 1.0], [[0.0], [np.nan]], [[0.0]] * 2),
}


@pytest.mark.parametrize("complaint", BAD)
def test_a_malformed_trajectory_is_refused(complaint):
    with pytest.raises(sk.UserError, match=complaint):
        sk.Trajectory(*BAD[complaint])


@pytest.mark.parametrize("scheme", ["euler", "trapezoid, hold", "hermite-simpson"])
def test_a_path_constraint_does_not_change_what_is_read_between_nodes(scheme):
    """Constraints may be looked at where the scheme itself does not evaluate the rates."""
    fence = sk.PathConstraint("fence", lambda x, u: x[0], upper=10.0)
    fenced = sk.Problem(
        "pendulum",
        ["angle", "spin"],
        ["torque"],
        PENDULUM.dynamics,
        horizon=2.0,
        initial=[0.0, 0.0],
        final=[1.0, 0.0],
        running_cost=PENDULUM.running_cost,
        path=[fence],
    )
    free, inside = (sk.solve(p, SCHEMES[scheme], tolerance=1e-12) for p in (PENDULUM, fenced))
    t = np.linspace(0, 2, 41)
    np.testing.assert_allclose(inside.state(t), free.state(t), atol=1e-6)
    np.testing.assert_allclose(inside.state(inside.times), inside.states, atol=1e-12)
