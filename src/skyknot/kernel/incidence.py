"""Which entries of z the parts of a program read: made once, shared while only numbers differ.

Legend: as in program.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from skyknot.kernel.program import Program

Array = NDArray[np.float64]
Offsets = NDArray[np.intp]
T = TypeVar("T", bound=np.generic)


@dataclass(frozen=True, eq=False)
class Incidence:
    """Positions in z, and places in arrays of points, spelled out.

    Attributes
    ----------
    states : (N, s, nx) positions of the segments' states, controls : (N, m, nu) of their controls
    last : (nx,) of the last state, globals : (nq,)
    point_states : (P, nx), point_controls : (P, m, nu) what the evaluated points read
    segment_entries : (N · s_used · nx,) where segments read a (P, nx) array, flattened
    gradient_entries : where the gradient's parts stand: size bounds, then the entries of states,
        point_states, point_controls and rate rows
    point_cost : (P,) cost weights c_j
    shares : (N, s−1, s_used, 1) weights δ_k A_ij
    """

    states: Offsets
    controls: Offsets
    last: Offsets
    globals: Offsets
    point_states: Offsets
    point_controls: Offsets
    segment_entries: Offsets
    gradient_entries: Offsets
    point_cost: Array
    shares: Array

    @classmethod
    def of(cls, program: Program) -> Incidence:
        """Return the incidence of a program."""
        layout = program.layout
        cost = np.zeros(len(program.point_state))
        np.add.at(cost, program.segment_points, program.segment_cost)
        states, controls = layout.states_at(layout.state), layout.controls_at(layout.control)
        point_states = layout.states_at(program.point_state)
        point_controls = layout.controls_at(program.point_control)
        read = (states, point_states, point_controls, program.rates.positions)
        entries = program.segment_points[..., None] * layout.nx + np.arange(layout.nx)
        return cls(
            states=states,
            controls=controls,
            last=states[-1, -1],
            globals=layout.global_positions,
            point_states=point_states,
            point_controls=point_controls,
            segment_entries=entries.ravel(),
            gradient_entries=joined(np.arange(layout.size), *read),
            point_cost=cost,
            shares=program.fractions[:, None, None, None] * program.A[..., None],
        )


def joined(*parts: NDArray[T]) -> NDArray[T]:
    """Return all entries of arrays, one array after the other."""
    return np.concatenate([part.ravel() for part in parts])


def summed(places: Offsets, values: Array, size: int) -> Array:
    """Return (size,) sums of values (n,) at their places (n,).

    One addend after the other in the order given, as np.add.at would, at a tenth of its time.
    """
    return np.bincount(places, values, size).astype(np.float64, copy=False)
