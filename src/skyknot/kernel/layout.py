"""Where every unknown stands in the decision vector: node-major, published here and only here.

z = [ segment 0 | segment 1 | … | segment N−1 | x_N, u_N | q ]

A segment holds x_k, then its control values, then its interior states. With shared controls
(linear, quadratic, polynomial through the nodes) the first control value u_k belongs to the node
and the last one to the next node; interior states and controls alternate:
    [x_k, u_k, x_c, u_c]             Hermite–Simpson, quadratic control
    [x_k, u_k]                       trapezoid, linear control
    [x_k, u_k]                       Euler, held control (no u_N)
q holds the free duration (if any), then the free parameters.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Offsets = NDArray[np.intp]


@dataclass(frozen=True)
class Layout:
    """Offsets into the decision vector.

    Attributes
    ----------
    size : number of unknowns
    state : (N, s) offset of each segment's state points; column s−1 is the next segment's column 0
    control : (N, m) offset of each segment's control values
    globals : offset of q
    """

    nx: int
    nu: int
    nq: int
    size: int
    state: Offsets
    control: Offsets
    globals: int

    def states_at(self, offsets: Offsets) -> Offsets:
        """Return (…, nx) positions in z of the states that begin at ``offsets``."""
        return offsets[..., None] + np.arange(self.nx)

    def controls_at(self, offsets: Offsets) -> Offsets:
        """Return (…, nu) positions in z of the controls that begin at ``offsets``."""
        return offsets[..., None] + np.arange(self.nu)

    @property
    def global_positions(self) -> Offsets:
        """(nq,) positions of the globals."""
        return self.globals + np.arange(self.nq)


def node_major(N: int, s: int, m: int, shared: bool, nx: int, nu: int, nq: int) -> Layout:
    """Return the layout of N segments with s state points and m control values each."""
    own = m - 1 if shared else m
    stride = (s - 1) * nx + own * nu
    start = stride * np.arange(N)
    state = np.empty((N, s), dtype=np.intp)
    control = np.empty((N, m), dtype=np.intp)
    state[:, 0], state[:, -1] = start, start + stride
    position = nx
    interior_controls = list(range(1, m - 1)) if shared else []
    for j in range(1 if shared else m):
        control[:, j] = start + position
        position += nu
    for i in range(1, s - 1):
        state[:, i] = start + position
        position += nx
        if interior_controls:
            control[:, interior_controls.pop(0)] = start + position
            position += nu
    for j in interior_controls:
        control[:, j] = start + position
        position += nu
    if shared:
        control[:, -1] = start + stride + nx
    end = N * stride + nx + (nu if shared else 0)
    return Layout(nx, nu, nq, end + nq, state, control, end)
