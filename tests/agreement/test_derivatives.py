"""Claim: a program's values and slopes are those of CasADi's graph and of complex steps.

The gradient of the Lagrangian is assembled from point-wise Jacobians; here it meets CasADi's
automatic differentiation of the whole graph, and the defects' Jacobian the complex step
(Squire & Trapp, SIAM Review 40 (1998) 110–112) through the model run on complex numbers.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from agreement.variants import ALL_SCHEMES, CASES, PROBLEMS, SCHEMES, program_of, random_point
from skyknot import bank as problems
from skyknot.kernel.evaluation import defects, evaluate, gradient, objective
from skyknot.solvers.nonlinear_program import nonlinear_program

SEPARATED = [case for case in CASES if ALL_SCHEMES[case[1]].form == "separated"]


def graph_multipliers(program, nlp, m):
    """Return lam_g in the graph's order; rate rows of a free horizon are split by their side."""
    above, below = nlp.rate_rows
    if program.duration is None:
        rates = [np.maximum(m.rates[above], 0), np.minimum(m.rates[below], 0)]
    else:
        rates = [m.rates[above]]
    return np.concatenate([m.defects.ravel(), m.path.ravel()[nlp.path_rows], *rates])


def one_sided(program, m):
    """Drop the sign of a rate multiplier whose bound does not exist."""
    m.rates[(m.rates > 0) & ~np.isfinite(program.rates.upper)] = 0.0
    m.rates[(m.rates < 0) & ~np.isfinite(program.rates.lower)] = 0.0


@pytest.mark.parametrize(("problem", "scheme"), SEPARATED)
def test_the_gradient_of_the_lagrangian_is_casadis(problem, scheme):
    program = program_of(PROBLEMS[problem], ALL_SCHEMES[scheme])
    z, m = random_point(program, seed=3)
    one_sided(program, m)
    nlp = nonlinear_program(program)
    lam = ca.MX.sym("lam", nlp.graph["g"].numel())
    lagrangian = nlp.graph["f"] + ca.dot(lam, nlp.graph["g"])
    reverse = ca.Function("g", [nlp.graph["x"], lam], [ca.gradient(lagrangian, nlp.graph["x"])])
    slopes = np.asarray(reverse(z / nlp.scale, graph_multipliers(program, nlp, m))).ravel()
    expected = slopes / nlp.scale + m.bounds
    found = gradient(program, evaluate(program, z), m)
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize(("problem", "scheme"), SEPARATED)
def test_objective_and_defects_are_the_graphs(problem, scheme):
    program = program_of(PROBLEMS[problem], ALL_SCHEMES[scheme])
    z, _ = random_point(program, seed=4)
    nlp = nonlinear_program(program)
    value = ca.Function("value", [nlp.graph["x"]], [nlp.graph["f"], nlp.graph["g"]])
    f, g = (np.asarray(v).ravel() for v in value(z / nlp.scale))
    values = evaluate(program, z)
    d = defects(program, z, values)
    assert objective(program, values) == pytest.approx(f[0], rel=1e-13)
    np.testing.assert_allclose(d.ravel(), g[: d.size], rtol=1e-12, atol=1e-13)


def complex_defects(program, model, z):
    """Return the defects on complex numbers, written from the legend of the program."""
    layout, T = program.layout, z[program.layout.globals] if program.duration is None else None
    T = program.duration if T is None else T
    X = z[layout.states_at(layout.state)]
    rows = []
    for k, delta in enumerate(program.fractions):
        U = program.control_weights @ z[layout.controls_at(layout.control[k])]
        F = [T * np.array(model(X[k, j], U[i])) for i, j in enumerate(program.used)]
        rows.append(program.C @ X[k] + delta * program.A @ np.array(F))
    return np.array(rows)


COMPLEX = {
    "quadrotor": (problems.quadrotor_transfer().problem, problems.quadrotor_transfer().guess),
    "van der pol": (problems.van_der_pol().problem, problems.van_der_pol().guess),
    "minimum time": (problems.minimum_time().problem, None),
}


@pytest.mark.parametrize("case", COMPLEX)
@pytest.mark.parametrize(
    "scheme",
    [sk.Euler(4), sk.Trapezoid(4), sk.HermiteSimpson(4), sk.Lobatto(2, 4), sk.Radau(2, 3)],
    ids=["euler", "trap", "hs", "lobatto", "radau"],
)
def test_the_defects_jacobian_is_that_of_the_complex_step(case, scheme):
    problem, guess = COMPLEX[case]
    program = scheme.program(problem, guess or sk.initial_guess(problem)[0])
    z, m = random_point(program, seed=5)
    values = evaluate(program, z)
    np.testing.assert_allclose(
        complex_defects(program, problem.dynamics, z), defects(program, z, values), atol=1e-12
    )
    step = 1e-30
    slopes = np.array(
        [
            np.sum(m.defects * complex_defects(program, problem.dynamics, z + 1j * step * e).imag)
            for e in np.eye(program.layout.size)
        ]
    )
    nothing = program.empty_multipliers()
    m.bounds[:], m.path[:], m.rates[:] = 0.0, 0.0, 0.0
    found = gradient(program, values, m) - gradient(program, values, nothing)
    np.testing.assert_allclose(found, slopes / step, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("problem", ["plain", "path", "everything", "parameters"])
def test_the_compressed_graph_is_the_separated_one_on_its_hermite_manifold(problem):
    """Reading z back from the compressed graph leaves no Hermite defect, and the same objective."""
    program = program_of(PROBLEMS[problem], SCHEMES["compressed"])
    z, _ = random_point(program, seed=6)
    nlp = nonlinear_program(program)
    y = z[nlp.kept] / nlp.scale
    lifted = np.asarray(nlp.full_z(y)).ravel()
    values = evaluate(program, lifted)
    d = defects(program, lifted, values)
    np.testing.assert_allclose(d[:, 0], 0, atol=1e-13)
    value = ca.Function("value", [nlp.graph["x"]], [nlp.graph["f"], nlp.graph["g"]])
    f, g = (np.asarray(v).ravel() for v in value(y))
    assert objective(program, values) == pytest.approx(f[0], rel=1e-13)
    np.testing.assert_allclose(d[:, 1].ravel(), g[: d[:, 1].size], atol=1e-13)
