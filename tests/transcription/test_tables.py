"""Claim: a scheme is a table that checks itself, and its stability function is the one known.

Legend: τ points, C, A rows, b weights; z = hλ; R(z) = x_{k+1}/x_k on ẋ = λx.
"""

from __future__ import annotations

from dataclasses import fields, replace
from math import factorial

import numpy as np
import pytest

import skyknot as sk
from skyknot.kernel.evaluation import defects, evaluate
from skyknot.transcription import DOORS, quadrature
from skyknot.transcription.collocation import chebyshev, lobatto, radau
from skyknot.transcription.schemes import EULER, HERMITE_SIMPSON, SCHEMES, TRAPEZOID


def step(table, z):
    """Return R(z): eliminate interior states from the rows C x + z A x = 0, with x_0 = 1."""
    rows = (table.C + z * table.A).astype(complex)
    return np.linalg.solve(rows[:, 1:], -rows[:, 0])[-1]


def of_collocation(c):
    """Return R(z) of collocation at c, from its polynomial M: Hairer & Wanner II, theorem IV.3.9.

    R(z) = Σ_j M^(s−j)(1) z^j / Σ_j M^(s−j)(0) z^j with M(x) = Π (x − c_i)/s!.
    """
    M = np.poly1d(c, r=True) / factorial(len(c))
    derivatives = [M.deriv(len(c) - j) for j in range(len(c) + 1)]
    above, below = (np.poly1d([d(end) for d in derivatives[::-1]]) for end in (1.0, 0.0))
    return lambda z: above(z) / below(z)


STABILITY = {
    "euler": lambda z: 1 + z,
    "trapezoid": lambda z: (1 + z / 2) / (1 - z / 2),
    # Lobatto IIIA with 3 points: the (2,2) Padé approximant of exp (Hairer & Wanner, IV.3)
    "hermite-simpson": lambda z: (1 + z / 2 + z**2 / 12) / (1 - z / 2 + z**2 / 12),
    "lobatto": of_collocation(quadrature.lobatto(5)[0]),
    "radau": of_collocation(quadrature.radau(4)[0]),
    "chebyshev": of_collocation(quadrature.chebyshev(5)[0]),
}


@pytest.mark.parametrize("z", [-0.5, -5.0, -50.0, 2j])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_one_step_on_a_linear_equation_is_the_known_rational_function(scheme, z):
    assert step(SCHEMES[scheme], z) == pytest.approx(STABILITY[scheme](z), rel=1e-13)


def test_hermite_simpson_neither_damps_nor_feeds_an_oscillation():
    for y in (0.1, 1.0, 10.0, 1e3):
        assert abs(step(HERMITE_SIMPSON, 1j * y)) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_error_of_one_step_falls_with_the_order_plus_one(scheme):
    table = SCHEMES[scheme]
    z = np.array([0.2, 0.1, 0.05]) if table.order <= 4 else np.array([1.2, 0.9, 0.6])
    errors = [abs(step(table, 1j * s) - np.exp(1j * s)) for s in z]
    slope = np.polyfit(np.log(z), np.log(errors), 1)[0]
    assert slope == pytest.approx(table.order + 1, abs=0.15)


@pytest.mark.parametrize("z", [-0.5, -5.0, 1.0])
def test_the_program_makes_the_same_step_as_its_table(z):
    problem = sk.Problem("decay", ["x"], ["u"], lambda x, u: [z * x[0] + 0 * u[0]], 1.0, [1.0])
    for name, door in DOORS.items():
        solution = sk.solve(problem, door(1), tolerance=1e-10)
        expected = STABILITY[name](z)
        assert solution.states[-1, 0] == pytest.approx(expected, rel=1e-9), name


CORRUPTED = [
    (HERMITE_SIMPSON, "A", (0, 0), 1 / 7, "not exact for degree"),
    (HERMITE_SIMPSON, "A", (1, 1), 0.6, "not exact for degree"),
    (HERMITE_SIMPSON, "C", (0, 0), 0.4, "not exact for degree 0"),
    (HERMITE_SIMPSON, "b", (0,), 0.2, "do not integrate degree 0"),
    (TRAPEZOID, "b", (0,), 0.4, "do not integrate degree 0"),
    (EULER, "A", (0, 1), 0.1, "not exact for degree 1"),
    (TRAPEZOID, "points", (0,), 0.1, "increase from 0 to 1"),
    (TRAPEZOID, "points", (1,), 0.9, "increase from 0 to 1"),
]


@pytest.mark.parametrize(("table", "name", "place", "value", "complaint"), CORRUPTED)
def test_a_corrupted_table_is_refused(table, name, place, value, complaint):
    array = getattr(table, name).copy()
    array[place] = value
    with pytest.raises(ValueError, match=complaint) as caught:
        replace(table, **{name: array})
    assert table.name in str(caught.value)


def test_weights_that_differ_from_the_last_row_are_refused():
    with pytest.raises(ValueError, match="must integrate with the weights b"):
        replace(EULER, b=np.array([0.5, 0.5]))


@pytest.mark.parametrize("claim", ["order", "stage_order"])
def test_a_table_cannot_claim_more_than_it_holds(claim):
    for table in SCHEMES.values():
        with pytest.raises(ValueError, match="degree"):
            replace(table, **{claim: getattr(table, claim) + 1})


def test_a_parametrisation_that_claims_nothing_is_refused():
    with pytest.raises(ValueError, match="every parametrisation needs its claimed orders"):
        replace(EULER, orders={})


def test_every_table_cites_its_source_and_has_a_door():
    assert set(DOORS) == set(SCHEMES)
    for table in SCHEMES.values():
        assert len(table.source) > 10
        assert all(getattr(table, field.name) is not None for field in fields(table))


@pytest.mark.parametrize("scheme", SCHEMES)
def test_polynomials_up_to_the_stage_order_leave_no_defect(scheme):
    """x = Σ t^q solves ẋ = Σ q t^(q−1): the states of a true solution have zero defects."""
    degree = SCHEMES[scheme].stage_order
    problem = sk.Problem(
        "polynomial",
        ["x"],
        ["u"],
        lambda x, u, t: [sum(q * t ** (q - 1) for q in range(1, degree + 1)) + 0 * u[0]],
        2.0,
    )
    guess = sk.Trajectory([0.0, 2.0], np.zeros((2, 1)), np.zeros((2, 1)))
    mesh = np.array([0.0, 0.125, 0.5, 0.75, 1.0])
    transcription = DOORS[scheme](mesh=mesh)
    program = transcription.program(problem, guess)
    t = 2 * (mesh[:-1, None] + np.diff(mesh)[:, None] * transcription.table.points)
    z = program.start.copy()
    z[program.layout.state] = sum(t**q for q in range(degree + 1))
    d = defects(program, z, evaluate(program, z))
    np.testing.assert_allclose(d, 0, atol=1e-12)


FAMILIES = {"lobatto": (lobatto, 2), "radau": (radau, 1), "chebyshev": (chebyshev, 2)}


@pytest.mark.parametrize("s", [1, 2, 3, 4, 7, 20, 40, 100])
@pytest.mark.parametrize("family", FAMILIES)
def test_families_check_themselves_for_any_number_of_points(family, s):
    make, least = FAMILIES[family]
    if s < least:
        with pytest.raises(sk.UserError, match="cannot have this number of points") as caught:
            make(s)
        assert caught.value.where == "points"
    else:
        table = make(s)
        assert len(table.used) == s
        x = np.exp(table.points)
        # error of interpolating the rate, max |Π (τ − c_i)| e/s!, at points like these
        limit = 4 * np.e * 0.25**s / factorial(s) + 1e-14 * s
        assert np.abs(table.C @ x + table.A @ x).max() < limit


@pytest.mark.parametrize("points", [2.5, "five", None, 201, True])
def test_a_number_of_points_that_is_none_is_refused(points):
    with pytest.raises(sk.UserError, match="cannot have this number of points"):
        sk.Lobatto(4, points)


def test_lobatto_of_two_and_three_points_is_trapezoid_and_hermite_simpson():
    for known, table in ((TRAPEZOID, lobatto(2)), (HERMITE_SIMPSON, lobatto(3))):
        np.testing.assert_allclose(table.points, known.points, atol=1e-16)
        np.testing.assert_allclose(table.b, known.b, atol=1e-16)
        # the rows span the same space: x at the points as affine maps of the rates
        same = [np.linalg.solve(t.C[:, 1:], t.A) for t in (known, table)]
        np.testing.assert_allclose(*same, atol=1e-15)
    np.testing.assert_array_equal(chebyshev(3).points, lobatto(3).points)


def test_radau_of_one_point_is_implicit_euler():
    table = radau(1)
    np.testing.assert_array_equal(table.A, [[0.0, 1.0]])
    assert step(table, -2.0) == pytest.approx(1 / 3)
    assert list(table.control_points) == ["hold"]


@pytest.mark.parametrize("family", ["lobatto", "radau"])
@pytest.mark.parametrize("s", [2, 3, 5, 8])
def test_the_discrete_adjoint_has_the_order_of_its_scheme(family, s):
    """Lobatto IIIB and Radau IA: ā_ij = b_j − b_j a_ji/b_i meets Butcher's B(p) and D, C in turn.

    C(q) of the adjoint is D(q) of the scheme: Σ_i b_i c_i^(q−1) a_ij = b_j (1 − c_j^q)/q.
    """
    table = FAMILIES[family][0](s)
    c, b, A = table.points[table.used], table.b[table.used], table.A[:, table.used]
    A = np.vstack([np.zeros(s), A]) if family == "lobatto" else A
    degree = s - 2 if family == "lobatto" else s - 1
    for q in range(1, degree + 1):
        np.testing.assert_allclose(b * c ** (q - 1) @ A, b * (1 - c**q) / q, atol=1e-14)


@pytest.mark.parametrize("s", [4, 5, 6, 7, 12, 13])
def test_the_adjoint_of_chebyshev_is_exact_for_constants_at_most(s):
    table = chebyshev(s)
    c, b, A = table.points, table.b, np.vstack([np.zeros(s), table.A])
    missed = [np.abs(b * c ** (q - 1) @ A - b * (1 - c**q) / q).max() for q in (1, 2)]
    assert missed[1] > 1e-5
    assert missed[0] < 1e-15 if s % 2 else missed[0] > 1e-5
