"""Claim: the orders claimed of solved control problems are those of the theory of trees.

Legend: 𝒜, b, c Butcher's tableau over the points used; ā_ij = b_j − b_j a_ji/b_i its discrete
adjoint (Hager, Numer. Math. 87 (2000) 247–282). With the control eliminated by ∂H/∂u = 0 state and
costate are integrated by the partitioned pair (𝒜, ā); its order is p where every rooted tree of up
to p vertices, those below the root in two colours, meets Σ_i b_i Φ_i = 1/γ (Hairer, Lubich &
Wanner, Geometric Numerical Integration, III.2). That holds where every stage has a control of its
own: "discontinuous" with Lobatto, and Radau's polynomials.
"""

from __future__ import annotations

from itertools import combinations_with_replacement, product

import numpy as np
import pytest

from skyknot.transcription.collocation import chebyshev, lobatto, radau
from skyknot.transcription.schemes import EULER, HERMITE_SIMPSON, TRAPEZOID

TABLES = {
    "euler": (EULER, "hold"),
    "trapezoid": (TRAPEZOID, "linear"),
    "hermite-simpson": (HERMITE_SIMPSON, "quadratic"),
    **{f"lobatto {s}": (lobatto(s), "discontinuous") for s in (2, 3, 4, 5)},
    "radau 1": (radau(1), "hold"),
    **{f"radau {s}": (radau(s), "polynomial") for s in (2, 3, 4)},
    **{f"chebyshev {s}": (chebyshev(s), "discontinuous") for s in (4, 5, 6, 7, 8, 9)},
}


def pair(table):
    """Return 𝒜, ā and b over the points used."""
    tableau = np.zeros((len(table.points),) * 2)
    tableau[1:] = np.linalg.solve(-table.C[:, 1:], table.A)
    A, b = tableau[np.ix_(table.used, table.used)], table.b[table.used]
    return A, b[None, :] - b[None, :] * A.T / b[:, None], b


def partitions(total, largest):
    """Return the ways to write a sum of whole numbers, as {number: how often}."""
    if total == 0:
        return [{}]
    if largest == 0:
        return []
    return [
        ({largest: count} if count else {}) | rest
        for count in range(total // largest + 1)
        for rest in partitions(total - count * largest, largest - 1)
    ]


def trees(matrices, most):
    """Return, by number of vertices, Φ over the stages and γ of every tree."""
    s = len(matrices[0])
    grown, hung = {}, {}
    for size in range(1, most + 1):
        grown[size] = []
        for parts in partitions(size - 1, size - 1):
            groups = [combinations_with_replacement(hung[n], times) for n, times in parts.items()]
            for children in product(*groups):
                below = [child for group in children for child in group]
                Phi = np.prod([phi for phi, _ in below], axis=0) if below else np.ones(s)
                grown[size].append((Phi, size * float(np.prod([gamma for _, gamma in below]))))
        hung[size] = [(matrix @ Phi, gamma) for Phi, gamma in grown[size] for matrix in matrices]
    return grown


def missed(table, most):
    """Return, by number of vertices, the largest miss of a condition."""
    A, adjoint, b = pair(table)
    found = trees((A, adjoint), most)
    return {n: max(abs(b @ Phi - 1 / gamma) for Phi, gamma in each) for n, each in found.items()}


def test_trees_are_counted_as_they_are():
    """1, 2, 7, 26, 107 rooted trees, vertices below the root in two colours (OEIS A000151)."""
    counts = [len(each) for each in trees((np.eye(1), np.eye(1)), 5).values()]
    assert counts == [1, 2, 7, 26, 107]


@pytest.mark.parametrize("name", TABLES)
def test_every_condition_up_to_the_claimed_order_holds_and_one_beyond_fails(name):
    table, controls = TABLES[name]
    claimed = table.orders[controls]
    assert claimed.states == claimed.costates
    found = missed(table, min(claimed.states + 1, 8))
    assert all(found[n] < 1e-13 for n in found if n <= claimed.states)
    if claimed.states + 1 in found:
        assert found[claimed.states + 1] > 1e-8
    else:  # the quadrature of a power ends with the order already
        c, b, p = table.points[table.used], table.b[table.used], claimed.states
        assert abs(b @ c**p - 1 / (p + 1)) > 1e-8
