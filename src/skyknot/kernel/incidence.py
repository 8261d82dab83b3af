"""Which entries of z the parts of a program read: made once, shared while only numbers differ.

Legend: as in program.py.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from skyknot.kernel.program import Program

Array = NDArray[np.float64]
Offsets = NDArray[np.intp]
Mask = NDArray[np.bool_]
Chosen = Offsets | slice
T = TypeVar("T", bound=np.generic)

MOST_PARTS = 8
"""Parts of a program that are kept."""


@dataclass(frozen=True, eq=False)
class Part:
    """The segments, points and rows that read some entries of z, and where their slopes go.

    Slopes are summed into ``size`` places: the n entries asked for, then maybe one for all others.

    Attributes
    ----------
    entries : the entries asked for; segments, points, rows : what reads them
    places : where go, one after the other, n bounds, slopes of the segments' states, states and
        controls of the points, rate rows
    last : (nx,), globals : (nq,) places of the last state and of the globals
    shares : (s−1, segments, s_used, 1) weights δ_k A_ij
    rates_read : where segments read the (points + 1, nx) multipliers of F, flattened
    """

    entries: Chosen
    segments: Chosen
    points: Chosen
    rows: Chosen
    places: Offsets
    last: Offsets
    globals: Offsets
    shares: Array
    rates_read: Offsets
    size: int


@dataclass(frozen=True, eq=False)
class Incidence:
    """Positions in z, and places in arrays of points, spelled out.

    Attributes
    ----------
    states : (N, s, nx) positions of the segments' states, controls : (N, m, nu) of their controls
    last : (nx,) of the last state, globals : (nq,)
    point_states : (P, nx), point_controls : (P, m, nu) what the evaluated points read
    rates : (R, w) of the rate rows
    segment_points : (N, s_used) evaluated points of the segments
    point_cost : (P,) cost weights c_j
    shares : (s−1, N, s_used, 1) weights δ_k A_ij
    size : of z
    """

    states: Offsets
    controls: Offsets
    last: Offsets
    globals: Offsets
    point_states: Offsets
    point_controls: Offsets
    rates: Offsets
    segment_points: Offsets
    point_cost: Array
    shares: Array
    size: int
    _parts: dict[bytes, Part] = field(default_factory=dict)

    @classmethod
    def of(cls, program: Program) -> Incidence:
        """Return the incidence of a program."""
        layout = program.layout
        cost = np.zeros(len(program.point_state))
        np.add.at(cost, program.segment_points, program.segment_cost)
        states = layout.states_at(layout.state)
        return cls(
            states=states,
            controls=layout.controls_at(layout.control),
            last=states[-1, -1],
            globals=layout.global_positions,
            point_states=layout.states_at(program.point_state),
            point_controls=layout.controls_at(program.point_control),
            rates=program.rates.positions,
            segment_points=program.segment_points,
            point_cost=cost,
            shares=program.fractions[:, None, None] * program.A[:, None, :, None],
            size=layout.size,
        )

    @cached_property
    def owned_states(self) -> Mask:
        """(N, s) the last of the segments' places that stand for one state."""
        return _last_of_each(self.states[..., 0])

    @cached_property
    def owned_controls(self) -> Mask:
        """(N, m) the last of the segments' places that stand for one control value."""
        return _last_of_each(self.controls[..., 0])

    @cached_property
    def owned_points(self) -> Mask:
        """(N, s_used) the last of the segments' places that stand for one evaluated point."""
        return _last_of_each(self.segment_points)

    @cached_property
    def whole(self) -> Part:
        """All of the program."""
        every = slice(None)
        return self._part(every, every, every, every, np.arange(self.size), self.size)

    def reading(self, entries: Mask) -> Part:
        """Return the part that reads the entries of z marked in a (size,) mask."""
        key = np.packbits(entries).tobytes()
        part = self._parts.get(key)
        if part is None:
            if len(self._parts) >= MOST_PARTS:
                self._parts.clear()
            part = self._parts[key] = self._reading(entries)
        return part

    def _reading(self, entries: Mask) -> Part:
        asked, count = np.flatnonzero(entries), len(self.point_states)
        place = np.full(self.size, len(asked))
        place[asked] = np.arange(len(asked))
        read = np.any(entries[self.point_states], axis=1)
        read = read | np.any(entries[self.point_controls.reshape(count, -1)], axis=1)
        read = read | np.any(entries[self.globals])
        segments = np.any(read[self.segment_points], axis=1)
        segments = segments | np.any(entries[self.states], axis=(1, 2))
        rows = np.any(entries[self.rates], axis=1)
        k, j, r = (np.flatnonzero(mask) for mask in (segments, read, rows))
        return self._part(asked, k, j, r, place, len(asked) + 1)

    def _part(
        self,
        entries: Chosen,
        segments: Chosen,
        points: Chosen,
        rows: Chosen,
        place: Offsets,
        size: int,
    ) -> Part:
        """Return a part whose slopes are summed at the place of each entry of z."""
        P, nx = self.point_states.shape
        chosen = np.arange(P)[points]
        number = np.full(P, len(chosen))  # points left out share the place after the last
        number[chosen] = np.arange(len(chosen))
        own = np.arange(self.size)[entries]
        read = self.states[segments], self.point_states[points], self.point_controls[points]
        points_read = number[self.segment_points[segments]]
        return Part(
            entries=entries,
            segments=segments,
            points=points,
            rows=rows,
            places=place[joined(own, *read, self.rates[rows])],
            last=place[self.last],
            globals=place[self.globals],
            shares=np.ascontiguousarray(self.shares[:, segments]),
            rates_read=(points_read[..., None] * nx + np.arange(nx)).ravel(),
            size=size,
        )


def _last_of_each(places: Offsets) -> Mask:
    flat = places.ravel()
    last = np.zeros(flat.max() + 1, dtype=np.intp)
    last[flat] = np.arange(len(flat))
    owned: Mask = last[flat] == np.arange(len(flat))
    return owned.reshape(places.shape)


def joined(*parts: NDArray[T]) -> NDArray[T]:
    """Return all entries of arrays, one array after the other."""
    return np.concatenate([part.ravel() for part in parts])


def summed(places: Offsets, values: Array, size: int) -> Array:
    """Return (size,) sums of values (n,) at their places (n,).

    One addend after the other in the order given, as np.add.at would, at a tenth of its time.
    """
    return np.bincount(places, values, size).astype(np.float64, copy=False)
