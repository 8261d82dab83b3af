"""Claim: a scheme is a table that checks itself, and its stability function is the one known.

Legend: τ points, C, A rows, b weights; z = hλ; R(z) = x_{k+1}/x_k on ẋ = λx.
"""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

import skyknot as sk
from skyknot.kernel.evaluation import defects, evaluate
from skyknot.transcription import DOORS
from skyknot.transcription.schemes import EULER, HERMITE_SIMPSON, SCHEMES, TRAPEZOID


def step(table, z):
    """Return R(z): eliminate interior states from the rows C x + z A x = 0, with x_0 = 1."""
    rows = (table.C + z * table.A).astype(complex)
    return np.linalg.solve(rows[:, 1:], -rows[:, 0])[-1]


STABILITY = {
    "euler": lambda z: 1 + z,
    "trapezoid": lambda z: (1 + z / 2) / (1 - z / 2),
    # Lobatto IIIA with 3 points: the (2,2) Padé approximant of exp (Hairer & Wanner, IV.3)
    "hermite-simpson": lambda z: (1 + z / 2 + z**2 / 12) / (1 - z / 2 + z**2 / 12),
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
    z = np.array([0.2, 0.1, 0.05])
    errors = [abs(step(table, s) - np.exp(s)) for s in z]
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
    t = np.linspace(0, 2, 2001)
    guess = sk.Trajectory(t, sum(t**q for q in range(degree + 1))[:, None], np.zeros((2001, 1)))
    mesh = np.array([0.0, 0.125, 0.5, 0.75, 1.0])
    program = DOORS[scheme](mesh=mesh).program(problem, guess)
    d = defects(program, program.start, evaluate(program, program.start))
    np.testing.assert_allclose(d, 0, atol=1e-12)
