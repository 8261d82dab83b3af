"""Words for a failure: which state, constraint and time are at fault."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.evaluation import Evaluation, defects, evaluate
from skyknot.kernel.program import Program

Array = NDArray[np.float64]


def worst_violation(program: Program, z: Array) -> str:
    """Return a sentence that names the most violated constraint at z, or the place of a NaN."""
    values = evaluate(program, z)
    bad = np.argwhere(~np.isfinite(values.F))
    if len(bad):
        point, i = bad[0]
        t = program.point_time[point] * program.duration_of(z)
        return f"The rate of {program.state_names[i]} is not a number at t = {t:.4g} s."
    path = np.maximum(program.path_lower - values.g, values.g - program.path_upper)
    candidates: list[tuple[float, str]] = []
    if path.size:
        point, i = np.unravel_index(np.argmax(path), path.shape)
        t = program.point_time[point] * program.duration_of(z)
        candidates.append((path[point, i], f"'{program.path_names[i]}' at t = {t:.4g} s"))
    from_defects = _largest_defect(program, z, values)
    candidates.append(from_defects)
    worst, where = max(candidates)
    return f"The largest violation is {worst:.3g}, of {where}." if worst > 0 else ""


def _largest_defect(program: Program, z: Array, values: Evaluation) -> tuple[float, str]:
    """Return the largest defect and where it stands, in words."""
    d = np.abs(defects(program, z, values))
    k, row, i = np.unravel_index(np.argmax(d), d.shape)
    t = np.concatenate([[0.0], np.cumsum(program.fractions)])[k] * program.duration_of(z)
    return float(d[k, row, i]), f"the defect of {program.state_names[i]} after t = {t:.4g} s"
