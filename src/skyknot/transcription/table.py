"""A scheme as a small table that checks itself.

Legend: a segment of length h carries state points τ_j (0 first, 1 last). Row i of the scheme reads
    d_i = Σ_j C_ij x_j + h Σ_j A_ij f_j     (the last row is the defect proper: predicted − actual)
and the running cost of the segment is h Σ_j b_j ℓ_j.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.trajectory import lagrange_basis
from skyknot.transcription.stability_function import Stability

Array = NDArray[np.float64]

DISCONTINUOUS = "discontinuous"
"""The control parametrisation that leaves every segment its own values at the nodes."""


@dataclass(frozen=True)
class Orders:
    """Claimed orders of a solved control problem, on smooth optima with no active bound.

    Attributes
    ----------
    states, costates : at the nodes
    controls : the values the scheme itself solves for, the worst of them
    """

    states: int
    controls: int
    costates: int


@dataclass(frozen=True)
class SchemeTable:
    """Collocation points, integration matrix, quadrature weights, control points and order.

    Attributes
    ----------
    name : what messages call the scheme
    points : (s,) τ of the state points, 0 first and 1 last
    C, A : (s−1, s) coefficients of states and of rates times h in each row
    b : (s,) quadrature weights of the running cost
    order : classical order of the states where the control is given
    stage_order : degree up to which every row is exact for polynomials
    control_points : τ of the control values, by parametrisation; the first is the default
    orders : what is claimed when the control is solved for, by parametrisation
    source : paper or book

    Raises
    ------
    ValueError
        When a row is not exact for polynomials of degree ``stage_order``, the weights do not
        integrate up to ``order``, a point lies outside [0, 1], or a parametrisation claims nothing.
    """

    name: str
    points: Array
    C: Array
    A: Array
    b: Array
    order: int
    stage_order: int
    control_points: dict[str, Array]
    orders: dict[str, Orders]
    source: str

    def __post_init__(self) -> None:
        tau = self.points
        if tau[0] != 0 or tau[-1] != 1 or np.any(np.diff(tau) <= 0):
            raise ValueError(f"{self.name}: points must increase from 0 to 1")
        for q in range(self.stage_order + 1):
            derivative = q * tau ** max(q - 1, 0)
            if not np.allclose(self.C @ tau**q + self.A @ derivative, 0, atol=1e-12):
                raise ValueError(f"{self.name}: a row is not exact for degree {q}")
        for q in range(self.order):
            if not np.isclose(self.b @ tau**q, 1 / (q + 1), rtol=0, atol=1e-12):
                raise ValueError(f"{self.name}: the weights do not integrate degree {q}")
        if not np.allclose(self.A[-1], self.b, atol=1e-14):
            raise ValueError(f"{self.name}: the last row must integrate with the weights b")
        if self.orders.keys() != self.control_points.keys():
            raise ValueError(f"{self.name}: every parametrisation needs its claimed orders")

    @property
    def default_controls(self) -> str:
        """The control parametrisation used when none is asked for."""
        return next(iter(self.control_points))

    @property
    def stability(self) -> Stability:
        """The stability function R(z) of the scheme."""
        return Stability(self.C, self.A)

    @property
    def used(self) -> NDArray[np.intp]:
        """Indices of the points where rates or costs are evaluated."""
        return np.flatnonzero(np.any(self.A != 0, axis=0) | (self.b != 0))

    def control_weights(self, parametrisation: str) -> Array:
        """Return W (s, m): the control at point j is Σ_i W_ji times control value i."""
        return lagrange_basis(self.control_points[parametrisation], self.points)

    def shares_controls(self, parametrisation: str) -> bool:
        """Whether the first and last control value belong to the nodes and so to both segments."""
        points = self.control_points[parametrisation]
        at_nodes = len(points) > 1 and bool(points[0] == 0 and points[-1] == 1)
        return at_nodes and parametrisation != DISCONTINUOUS
