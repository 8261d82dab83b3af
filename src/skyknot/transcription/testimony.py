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
Mask = NDArray[np.bool_]


def testimony(program: Program, points: Array, multipliers: Multipliers) -> Witness:
    """Return scheme and multipliers of a program, free of its layout.

    Parameters
    ----------
    points : (s,) state points of the scheme
    """
    places, used = program.incidence, program.used
    N, s, ng = program.segments, len(points), multipliers.path.shape[1]
    A, weights = np.zeros((len(program.C), s)), np.zeros((N, s))
    A[:, used], weights[:, used] = program.A, program.segment_cost
    path = np.zeros((N, s, ng))
    if ng:
        path[:, used] = _once(places.owned_points, multipliers.path[program.segment_points])
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
        state_bounds=_once(places.owned_states, bounds[places.states]),
        control_bounds=_once(places.owned_controls, bounds[places.controls]),
        global_bounds=bounds[places.globals],
        rates=multipliers.rates,
        rate_values=_control_places(program),
        rate_weights=program.rates.weights,
        rate_spans=program.rates.length,
    )


def _once(owned: Mask, values: Array) -> Array:
    """Return values (N, j, n) where their place (N, j) is owned, zero elsewhere."""
    result: Array = np.where(owned[..., None], values, 0.0)
    return result


def _control_places(program: Program) -> Offsets:
    """Return (R, w) positions of the rate rows' values in control values (N, m, nu), flattened."""
    if not program.rates.positions.size:
        return program.rates.positions
    first = np.zeros(program.layout.size, dtype=np.intp)
    entries = program.incidence.controls.reshape(-1)
    first[entries] = np.arange(len(entries))
    return first[program.rates.positions]
