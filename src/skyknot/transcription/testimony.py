"""From a solved program to the plain numbers that its certificate asks for.

Legend: as in kernel/program.py and in witness.py.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.program import Multipliers, Program
from skyknot.witness import Witness

Array = NDArray[np.float64]
Offsets = NDArray[np.intp]


def testimony(program: Program, points: Array, multipliers: Multipliers) -> Witness:
    """Return scheme and multipliers of a program, free of its layout.

    Parameters
    ----------
    points : (s,) state points of the scheme
    """
    layout, used = program.layout, program.used
    N, s, ng = program.segments, len(points), multipliers.path.shape[1]
    A, weights = np.zeros((len(program.C), s)), np.zeros((N, s))
    A[:, used], weights[:, used] = program.A, program.segment_cost
    path = np.zeros((N, s, ng))
    path[:, used] = _once(program.segment_points, multipliers.path[program.segment_points])
    bounds = multipliers.bounds
    return Witness(
        points=points,
        C=program.C,
        A=A,
        weights=weights,
        control_points=program.control_points,
        shared=program.shared,
        defects=multipliers.defects,
        path=path,
        state_bounds=_once(layout.state, bounds[layout.states_at(layout.state)]),
        control_bounds=_once(layout.control, bounds[layout.controls_at(layout.control)]),
        global_bounds=bounds[layout.global_positions],
        rates=multipliers.rates,
        rate_values=_control_places(program),
        rate_weights=program.rates.weights,
        rate_spans=program.rates.length,
    )


def _once(places: Offsets, values: Array) -> Array:
    """Return values (N, j, n) at places (N, j), zero at a repeated place but for its last one."""
    flat = places.ravel()
    last = np.zeros(flat.max() + 1, dtype=np.intp)
    last[flat] = np.arange(len(flat))
    owner = (last[flat] == np.arange(len(flat))).reshape(places.shape)
    result: Array = np.where(owner[..., None], values, 0.0)
    return result


def _control_places(program: Program) -> Offsets:
    """Return (R, w) positions of the rate rows' values in control values (N, m, nu), flattened."""
    layout = program.layout
    first = np.zeros(layout.size, dtype=np.intp)
    entries = layout.controls_at(layout.control).reshape(-1)
    first[entries] = np.arange(len(entries))
    return first[program.rates.positions]
