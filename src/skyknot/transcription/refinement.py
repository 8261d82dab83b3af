"""A better mesh, from the errors on the last one: segments split, merged, moved onto switches.

A segment whose error is r times what is allowed, and falls as h^(p+1), wants m = r^(1/(p+1))
segments in its place. Nodes are then laid so that every new segment gets an equal share of Σ m: the
equidistribution of de Boor, as in COLSYS (U. Ascher, J. Christiansen & R. D. Russell, Mathematics
of Computation 33, 1979). Where m < 1 segments merge. Nodes near a switch of a control are moved
onto it.

Legend: N segments of length h (shares of the horizon), p order of the scheme, s its stage order.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.transcription.segment_error import SegmentError
from skyknot.transcription.switches import Switch
from skyknot.transcription.table import SchemeTable

Array = NDArray[np.float64]

CONSTRAINT_SHARE = 30.0
"""By how many times the accuracy a limit may be passed between the nodes, of its size: 3 mm of a
clearance, 0.3 % of a speed at 1e-4. No vehicle is flown to a ten-thousandth of its limits."""

MOST_PIECES, LEAST_PIECES = 5.0, 0.4
"""What becomes of one segment in one round, at most and at least."""

MERGED_ABOVE = 10.0
"""Segments merge only while the error is so many times the accuracy: later it would rise again."""

AIM = 0.5
"""Share of the accuracy aimed at in a segment, so that the next answer does not miss by a hair."""

STEEPEST = 4.0
"""Largest ratio of the lengths of neighbours that the errors alone may bring about."""

SWITCH_SHARE = 10.0
"""Over how many times the accuracy, of the horizon, a jump of a control may be spread: switching
times are then known to a thousandth of the horizon at 1e-4."""

SOLVER_SHARE = 0.01
"""Share of the accuracy to which the equations are solved."""

FURTHEST_MOVE = 0.25
"""How far a node is moved onto a switch, of its shorter segment; beyond, a node is added there."""

NEAREST = 0.05
"""How near, in the same measure, a node that cannot move makes another one needless."""

TRUSTED = 0.02
"""Error of the dynamics beyond which states and costates do not tell where the switches are."""

SMALLEST_ACCURACY = 1e-10


@dataclass(frozen=True)
class Refinement:
    """How accurate an answer has to be, and what may be spent on it.

    Parameters
    ----------
    accuracy : largest error of any state between the nodes, and of the whole open-loop flight,
        relative to the size of the state: its scale where given, else 1 + its largest magnitude.
        Limits are passed between the nodes by at most 30 times as much of their size, and jumps
        of controls are spread over at most 10 times as much of the horizon
    rounds : most meshes to solve on
    segments : most segments of a mesh
    seconds : no mesh is begun after this time, s

    Raises
    ------
    UserError
        When a number is not of its kind.
    """

    accuracy: float = 1e-4
    rounds: int = 12
    segments: int = 2000
    seconds: float = 120.0

    def __post_init__(self) -> None:
        found = self.accuracy
        if isinstance(found, bool) or not isinstance(found, int | float | np.floating):
            raise _refused("accuracy", type(found).__name__, "a number such as 1e-4")
        if not SMALLEST_ACCURACY <= found < 1:
            kind = f"a share of the states' sizes, from {SMALLEST_ACCURACY:g} to below 1"
            raise _refused("accuracy", found, kind)
        for name in ("rounds", "segments", "seconds"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int | float) or not value > 0:
                raise _refused(f"accuracy.{name}", repr(value), "a number greater than zero")

    def tolerance(self, asked: float) -> float:
        """Return the solver's tolerance: what is asked for, lowered where defects would add up.

        What a solver leaves of the defects grows along the flight like any other error.
        """
        return min(asked, max(SOLVER_SHARE * self.accuracy, SMALLEST_ACCURACY))

    def met_by(self, error: SegmentError) -> bool:
        """Whether a trajectory is as accurate as asked for."""
        return self.worst(error) <= self.accuracy

    def worst(self, error: SegmentError) -> float:
        """Return the one number to compare with the accuracy."""
        return max(
            error.dynamics,
            error.flight,
            error.constraints / CONSTRAINT_SHARE,
            error.switching / SWITCH_SHARE,
        )


def refined(
    nodes: Array,
    error: SegmentError,
    wanted: Refinement,
    table: SchemeTable,
    switches: Sequence[Switch] = (),
    kept: Sequence[float] = (),
) -> Array:
    """Return the nodes of a mesh laid anew, as shares of the horizon.

    Parameters
    ----------
    nodes : (N+1,) of the last mesh
    error : measured on it
    table : the scheme, for its orders
    switches : of the controls
    kept : places that stay nodes (of point constraints)
    """
    h = np.diff(nodes)
    least = LEAST_PIECES if error.dynamics > MERGED_ABOVE * wanted.accuracy else 1.0
    pieces = np.clip(_pieces(error, wanted, table), least, MOST_PIECES)
    density = _smoothed(pieces / h, h)
    amount = np.concatenate([[0.0], np.cumsum(density * h)])
    count = min(max(int(np.ceil(amount[-1])), 1), int(wanted.segments))
    mesh = np.interp(np.linspace(0.0, amount[-1], count + 1), amount, nodes)
    mesh[0], mesh[-1] = 0.0, 1.0
    return _with_places(mesh, error, wanted, switches, kept)


def segments_needed(error: SegmentError, wanted: Refinement, table: SchemeTable) -> float:
    """Return how many segments the errors ask for, by the orders of the scheme, without limit."""
    return float(np.sum(np.maximum(_pieces(error, wanted, table), LEAST_PIECES)))


def split(
    nodes: Array,
    error: SegmentError,
    wanted: Refinement,
    table: SchemeTable,
    switches: Sequence[Switch] = (),
    kept: Sequence[float] = (),
) -> Array:
    """Return the same mesh with the segments at fault split; parameters as for ``refined``.

    Where controls are not unique (singular arcs) every new mesh has another answer with other
    errors; a mesh that only grows comes to an end there too.
    """
    pieces = np.ceil(np.clip(_pieces_alone(error, wanted, table), 1.0, MOST_PIECES) - 1e-9)
    pieces[_at_fault_in_flight(error, wanted.accuracy, table.order) & (pieces < 2)] = 2
    room = int(wanted.segments) - (len(nodes) - 1)
    worst_first = np.argsort(-pieces, kind="stable")
    allowed = np.cumsum(pieces[worst_first] - 1) <= room
    pieces[worst_first[~allowed]] = 1
    parts = [
        np.linspace(left, right, int(m), endpoint=False)
        for left, right, m in zip(nodes[:-1], nodes[1:], pieces, strict=True)
    ]
    mesh = np.append(np.concatenate(parts), 1.0)
    return _with_places(mesh, error, wanted, switches, kept)


def _with_places(
    mesh: Array,
    error: SegmentError,
    wanted: Refinement,
    switches: Sequence[Switch],
    kept: Sequence[float],
) -> Array:
    """Return the mesh with nodes on the switches, as far as there is room, and on what is kept."""
    onto = [switch.place for switch in switches] if error.dynamics < TRUSTED else []
    for i, place in enumerate(onto):
        more = len(mesh) - 1 + len(kept) < wanted.segments
        mesh = _onto(mesh, place, (*kept, *onto[:i]), more=more)
    for place in kept:
        mesh = _onto(mesh, place, (), more=True)
    return mesh


def _pieces(error: SegmentError, wanted: Refinement, table: SchemeTable) -> Array:
    """Return (N,) how many segments each should become, from all that is measured."""
    flight = _pieces_for_flight(error, wanted.accuracy, table.order)
    return np.maximum(_pieces_alone(error, wanted, table), flight)


def _pieces_alone(error: SegmentError, wanted: Refinement, table: SchemeTable) -> Array:
    """Return (N,) the same from what each segment does by itself."""
    accuracy, s = AIM * wanted.accuracy, table.stage_order
    local = np.maximum(error.between.max(axis=1), np.abs(error.missed).max(axis=1))
    pieces = (_bounded(local) / accuracy) ** (1 / (s + 1))
    passed = (error.passed / (CONSTRAINT_SHARE * accuracy)) ** 0.5
    spread = np.where(error.smeared > SWITCH_SHARE * wanted.accuracy, MOST_PIECES, 0.0)
    return np.maximum(np.maximum(pieces, passed), spread)


def _pieces_for_flight(error: SegmentError, accuracy: float, p: int) -> Array:
    """Return (N,) the fewest segments, Σ m_k, whose effects Σ c_k m_k^(−p) stay within accuracy.

    Their least is where all pieces contribute equally: m_k = c_k^(1/(p+1)) · constant. Effects of
    opposite sign cancel in part; half of what cancels now is counted on later.
    """
    effect = _bounded(error.effect)
    total = float(np.sum(effect))
    if total == 0:
        return np.zeros_like(effect)
    cancelled = np.sqrt(min(1.0, _finite(error.flight) / total))
    root = effect ** (1 / (p + 1))
    result: Array = root * (cancelled * np.sum(root) / accuracy) ** (1 / p)
    return result


def _at_fault_in_flight(error: SegmentError, accuracy: float, p: int) -> NDArray[np.bool_]:
    """Return (N,) the fewest segments that, halved, bring the flight within half the accuracy."""
    if error.flight <= accuracy:
        return np.zeros(len(error.effect), dtype=bool)
    effect = _bounded(error.effect)
    worst_first = np.argsort(-effect)
    gained = np.cumsum(effect[worst_first]) * (1 - 2.0**-p)
    needed = np.sum(effect) * (1 - 0.5 * accuracy / _finite(error.flight))
    chosen = np.zeros(len(effect), dtype=bool)
    chosen[worst_first[: int(np.searchsorted(gained, needed)) + 1]] = True
    return chosen


def _bounded(values: Array) -> Array:
    return np.nan_to_num(values, nan=1e6, posinf=1e6)


def _finite(value: float) -> float:
    return value if np.isfinite(value) else 1e6


def _smoothed(density: Array, h: Array) -> Array:
    """Return the density raised where a neighbour is more than ``STEEPEST`` times as dense."""
    density = density.copy()
    N = len(h)
    for order in (range(1, N), range(N - 2, -1, -1)):
        step = -1 if order.step > 0 else 1
        for k in order:
            density[k] = max(density[k], density[k + step] / STEEPEST)
    return density


def _onto(mesh: Array, place: float, kept: tuple[float, ...], *, more: bool) -> Array:
    """Return the mesh with its nearest free node moved onto a place, or a new one if ``more``."""
    k = int(np.argmin(np.abs(mesh - place)))
    gap = abs(mesh[k] - place)
    if gap == 0:
        return mesh
    lengths = np.diff(mesh)
    near = min(lengths[max(k - 1, 0)], lengths[min(k, len(lengths) - 1)])
    taken = k in (0, len(mesh) - 1) or any(abs(mesh[k] - other) < 1e-12 for other in kept)
    if taken and gap < NEAREST * near:
        return mesh
    if taken or gap > FURTHEST_MOVE * near:
        return np.sort(np.append(mesh, place)) if more else mesh
    moved = mesh.copy()
    moved[k] = place
    return moved


def _refused(where: str, found: object, expected: str) -> UserError:
    return UserError(
        "The accuracy asked for cannot be.",
        where=where,
        found=found,
        expected=expected,
        do="Use 1e-4, or leave it out to solve on one mesh only.",
    )
