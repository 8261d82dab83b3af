"""Schemes of any number of points, made from their collocation points.

Legend: c collocation points in [0, 1], L_j their Lagrange polynomials. Every row integrates from
the start of the segment, x_0 − x_i + h Σ_j A_ij f_j = 0 with A_ij = ∫₀^{τ_i} L_j: the integral
form, whose adjoint has full rank, unlike that of a differentiation matrix.

With the weights b the discrete adjoint is the scheme ā_ij = b_j − b_j a_ji/b_i (Hager, Numer.
Math. 87 (2000) 247–282): Lobatto IIIB for Lobatto points, Radau IA for Radau's, of the same order.
With Clenshaw and Curtis's weights it is exact for constants, where s is odd, or for nothing, which
leaves orders 4 or 2 in h, and algebraic decay in s, wherever the control depends on the costate.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.trajectory import integral_basis
from skyknot.transcription import quadrature
from skyknot.transcription.table import DISCONTINUOUS, Orders, SchemeTable

Array = NDArray[np.float64]

MOST_POINTS = 200


@lru_cache(maxsize=64)
def lobatto(points: int) -> SchemeTable:
    """Return Lobatto IIIA with any number of points, both nodes among them: order 2s − 2.

    Raises
    ------
    UserError
        When ``points`` is not a whole number from 2 to ``MOST_POINTS``.
    """
    c, b = quadrature.lobatto(_checked(points, 2))
    # One control value at a node serves two stages, whose costates miss by O(h^(s−1)) on either
    # side: states and costates feel the difference.
    even = points + points % 2
    return _table(
        f"Lobatto, {points} points",
        c,
        b,
        order=2 * points - 2,
        own=Orders(even, points - 1, even),
        broken=Orders(2 * points - 2, points - 1, 2 * points - 2),
        source="Hairer, Lubich & Wanner, Geometric Numerical Integration, II.1.4: Lobatto IIIA",
    )


@lru_cache(maxsize=64)
def radau(points: int) -> SchemeTable:
    """Return Radau IIA of s points, the end of the segment among them, its start not: order 2s − 1.

    Raises
    ------
    UserError
        When ``points`` is not a whole number from 1 to ``MOST_POINTS``.
    """
    c, b = quadrature.radau(_checked(points, 1))
    return _table(
        f"Radau, {points} point{'s' if points > 1 else ''}",
        c,
        b,
        order=2 * points - 1,
        own=Orders(2 * points - 1, points, 2 * points - 1),
        source="Hairer & Wanner, Solving Ordinary Differential Equations II, IV.5: Radau IIA",
    )


@lru_cache(maxsize=64)
def chebyshev(points: int) -> SchemeTable:
    """Return collocation at the Chebyshev–Gauss–Lobatto points: order s, or s + 1 where s is odd.

    Raises
    ------
    UserError
        When ``points`` is not a whole number from 2 to ``MOST_POINTS``.
    """
    c, b = quadrature.chebyshev(_checked(points, 2))
    consistent = Orders(4, 2, 4) if points % 2 else Orders(2, 1, 2)
    return _table(
        f"Chebyshev, {points} points",
        c,
        b,
        order=points + points % 2,
        own=consistent,
        broken=consistent,
        source="Clenshaw & Curtis, Numer. Math. 2 (1960) 197–205; Fahroo & Ross, JGCD 25 (2002)",
    )


def _table(
    name: str,
    c: Array,
    b: Array,
    *,
    order: int,
    source: str,
    own: Orders,
    broken: Orders | None = None,
) -> SchemeTable:
    """Return the collocation scheme on points c with weights b, in integral form.

    Parameters
    ----------
    own, broken : orders with the polynomial control, and with one that may jump at the nodes
    """
    tau = c if c[0] == 0 else np.concatenate([[0.0], c])
    A, weights = np.zeros((len(tau) - 1, len(tau))), np.zeros(len(tau))
    A[:, -len(c) :], weights[-len(c) :] = integral_basis(c, tau[1:]), b
    A[-1] = weights
    C = -np.eye(len(tau))[1:]
    C[:, 0] = 1.0
    controls = _controls(c, order, own, broken)
    return SchemeTable(
        name=name,
        points=tau,
        C=C,
        A=A,
        b=weights,
        order=order,
        stage_order=len(c),
        control_points={choice: places for choice, (places, _) in controls.items()},
        orders={choice: claimed for choice, (_, claimed) in controls.items()},
        source=source,
    )


def _controls(
    c: Array, order: int, own: Orders, broken: Orders | None
) -> dict[str, tuple[Array, Orders]]:
    """Return the parametrisations that leave no control value without an equation."""
    held = {"hold": (np.array([0.0]), Orders(min(order, 2), 1, min(order, 2)))}
    if len(c) == 1:
        return held
    jumping = {} if broken is None else {DISCONTINUOUS: (c, broken)}
    straight = Orders(min(order, 4), 1 if order == 2 else 2, min(order, 4))
    linear = {"linear": (np.array([0.0, 1.0]), straight)}
    return {"polynomial": (c, own)} | jumping | linear | held


def _checked(points: int, least: int) -> int:
    whole = isinstance(points, int | np.integer) and not isinstance(points, bool)
    if not whole or not least <= points <= MOST_POINTS:
        raise UserError(
            "A segment cannot have this number of points.",
            where="points",
            found=points,
            expected=f"a whole number from {least} to {MOST_POINTS}",
            do="Choose a few points and many segments, or some tens of points and one segment.",
        )
    return int(points)
