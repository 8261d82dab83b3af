"""Claim: a problem stated again meets the tapes made before, and only where nothing changed."""

from __future__ import annotations

import casadi as ca

import skyknot as sk
from skyknot.kernel.rows import Rows, tapes

MASS = {"value": 2.0}


def program_of(horizon=1.0, scheme=None):
    """Return a program whose dynamics read a number that may change."""
    problem = sk.Problem(
        name="sledge",
        states=["x", "v"],
        controls=["force"],
        dynamics=lambda x, u, p: [x[1], u[0] / MASS["value"] - p.drag * ca.sin(x[1])],
        horizon=horizon,
        initial=[0, 0],
        final=[1, 0],
        running_cost=lambda x, u: u[0] ** 2,
        parameters={"drag": 0.1},
    )
    return (scheme or sk.Euler(4)).program(problem, sk.initial_guess(problem)[0])


def tapes_of(program):
    return tapes(program, Rows(program).path_scale)


def test_a_problem_stated_again_shares_tapes_but_no_expression():
    one, other = program_of(), program_of(scheme=sk.HermiteSimpson(3))
    assert other.parametric_point is not one.parametric_point
    assert other.functions == one.functions
    assert other.slopes is one.slopes
    assert tapes_of(other) is tapes_of(one)


def test_another_number_in_the_callables_makes_other_tapes(monkeypatch):
    one = program_of()
    monkeypatch.setitem(MASS, "value", 2.0 + 1e-15)
    for other in (program_of(), program_of(horizon=1.5)):
        assert other.functions != one.functions
        assert other.slopes is not one.slopes
        assert tapes_of(other) is not tapes_of(one)


def test_a_problem_that_changes_under_way_is_solved_as_it_is_now(monkeypatch):
    problem = sk.Problem(
        name="sledge",
        states=["x", "v"],
        controls=["force"],
        dynamics=lambda x, u: [x[1], u[0] / MASS["value"]],
        horizon=1.0,
        initial=[0, 0],
        final=[1, 0],
        running_cost=lambda x, u: u[0] ** 2,
    )
    light = sk.solve(problem, sk.HermiteSimpson(5)).objective
    monkeypatch.setitem(MASS, "value", 4.0)
    heavy = sk.solve_many(problem, initials=[[0, 0]], transcription=sk.HermiteSimpson(5))[0]
    assert abs(heavy.objective - 4 * light) < 1e-6 * light
