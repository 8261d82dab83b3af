"""Claim: a failure names the state, constraint and time at fault, in the user's words."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from skyknot.solvers.blame import worst_violation
from solvers.probes import mover

UNDEFINED = {
    "The rate of speed is not a number": {
        "dynamics": lambda x, u: [x[1], ca.sqrt(x[0] - 0.5) + u[0]]
    },
    "The running cost is not a number": {"running_cost": lambda x, u: u[0] ** 2 + ca.log(x[0] - 1)},
    "'tower' is not a number": {
        "path": [sk.PathConstraint("tower", lambda x, u: ca.sqrt(x[0] - 0.5), lower=0.0)]
    },
    "The slope of the rate of speed is not a number": {
        "final": [0.0, 0.0],
        "dynamics": lambda x, u: [x[1], ca.sqrt(x[0]) + u[0]],
    },
    "The terminal cost or its slope is not a number": {
        "terminal_cost": lambda x, tf: ca.sqrt(x[0] - 0.5)
    },
}


@pytest.mark.parametrize("form", ["separated", "compressed"])
@pytest.mark.parametrize("sentence", UNDEFINED)
def test_what_is_not_a_number_is_named(sentence, form):
    solution = sk.solve(mover(**UNDEFINED[sentence]), sk.HermiteSimpson(10, form=form), "ipopt")
    assert solution.status == "evaluation error"
    assert sentence in solution.message
    assert "Bound the state named above" in solution.message
    assert np.all(np.isfinite(solution.states))


def test_the_time_of_the_first_trouble_is_told():
    problem = mover(**UNDEFINED["The rate of speed is not a number"])
    solution = sk.solve(problem, sk.Trapezoid(10), "ipopt")
    # straight line 1 → 0.2 is at 0.5 when t = 0.625; the next node is 0.7
    assert "at t = 0.7 s" in solution.message


BLOCKED = {
    "of 'fence' at t = 1 s": {
        "path": [sk.PathConstraint("fence", lambda x, u: x[0], lower=0.7)],
    },
    "of 'gate' at t = 0.5 s": {
        "points": [sk.PointConstraint("gate", lambda x, u: x[0], at=0.5, lower=90.0)],
        "state_bounds": ([None, -3.0], [None, 3.0]),
    },
    "of the defect of": {"control_bounds": (-0.1, 0.1)},
}


@pytest.mark.parametrize("words", BLOCKED)
def test_an_infeasible_problem_says_so_and_names_the_worst(words):
    solution = sk.solve(mover(**BLOCKED[words]), sk.HermiteSimpson(10), "ipopt")
    assert solution.status == "locally infeasible"
    assert "The largest violation is" in solution.message
    assert words in solution.message
    assert "Relax the constraint named above" in solution.message


def test_a_rate_bound_can_be_the_one_named():
    problem = mover(rates=[0.5])
    scheme = sk.HermiteSimpson(4)
    program = scheme.program(problem, sk.initial_guess(problem)[0])
    z = program.start.copy()
    z[program.layout.controls_at(program.layout.control[1])] = [[0.0], [400.0], [0.0]]
    assert "the rate bound of push" in worst_violation(program, z)
