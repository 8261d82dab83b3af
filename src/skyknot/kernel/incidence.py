"""Which entries of z the parts of a program read: made once, shared while only numbers differ.

Legend: as in program.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
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
    rates : (R, w) of the rate rows
    point_cost : (P,) cost weights c_j
    shares : (s−1, N, s_used, 1) weights δ_k A_ij
    own : (size,) each entry's own position
    """

    states: Offsets
    controls: Offsets
    last: Offsets
    globals: Offsets
    point_states: Offsets
    point_controls: Offsets
    segment_entries: Offsets
    rates: Offsets
    own: Offsets
    point_cost: Array
    shares: Array

    @classmethod
    def of(cls, program: Program) -> Incidence:
        """Return the incidence of a program."""
        layout = program.layout
        cost = np.zeros(len(program.point_state))
        np.add.at(cost, program.segment_points, program.segment_cost)
        states = layout.states_at(layout.state)
        entries = program.segment_points[..., None] * layout.nx + np.arange(layout.nx)
        return cls(
            states=states,
            controls=layout.controls_at(layout.control),
            last=states[-1, -1],
            globals=layout.global_positions,
            point_states=layout.states_at(program.point_state),
            point_controls=layout.controls_at(program.point_control),
            rates=program.rates.positions,
            own=np.arange(layout.size),
            segment_entries=entries.ravel(),
            point_cost=cost,
            shares=program.fractions[:, None, None] * program.A[:, None, :, None],
        )

    def gradient_entries(self, points: Offsets | None = None) -> Offsets:
        """Return where the parts of a gradient stand in z.

        All of z, the segments' states, states and controls of the evaluated points (all of them,
        or some), rate rows.
        """
        return self._all_entries if points is None else self._entries(points)

    @cached_property
    def _all_entries(self) -> Offsets:
        return self._entries(slice(None))

    def _entries(self, points: Offsets | slice) -> Offsets:
        read = self.point_states[points], self.point_controls[points]
        return joined(self.own, self.states, *read, self.rates)

    def reading(self, entries: NDArray[np.bool_]) -> Offsets:
        """Return the evaluated points that read one of the entries of z, in order."""
        P = len(self.point_states)
        if entries[self.globals].any():
            return np.arange(P)
        read = entries[self.point_states].any(axis=1)
        read |= entries[self.point_controls.reshape(P, -1)].any(axis=1)
        return np.flatnonzero(read)


def joined(*parts: NDArray[T]) -> NDArray[T]:
    """Return all entries of arrays, one array after the other."""
    return np.concatenate([part.ravel() for part in parts])


def summed(places: Offsets, values: Array, size: int) -> Array:
    """Return (size,) sums of values (n,) at their places (n,).

    One addend after the other in the order given, as np.add.at would, at a tenth of its time.
    """
    return np.bincount(places, values, size).astype(np.float64, copy=False)
