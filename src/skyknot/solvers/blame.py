"""Words for a failure: which state, constraint and time are at fault."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.evaluation import Evaluation, defects, evaluate, rate_values
from skyknot.kernel.program import Program

Array = NDArray[np.float64]


def undefined_value(program: Program, z: Array) -> str:
    """Return a sentence naming the first value or slope that is not a number at z, or nothing."""
    return _undefined(program, z, evaluate(program, z))


def worst_violation(program: Program, z: Array) -> str:
    """Return a sentence that names the most violated constraint at z, or the place of a NaN."""
    values = evaluate(program, z)
    undefined = _undefined(program, z, values)
    if undefined:
        return undefined
    candidates = [
        *_largest_path(program, z, values),
        *_largest_rate(program, z),
        _largest_defect(program, z, values),
    ]
    worst, where = max(candidates)
    return f"The largest violation is {worst:.3g}, of {where}." if worst > 0 else ""


def _undefined(program: Program, z: Array, values: Evaluation) -> str:
    rates = [f"the rate of {name}" for name in program.state_names]
    paths = [f"'{name}'" for name in program.path_names]
    groups = [
        (values.F, rates),
        (values.L[:, None], ["the running cost"]),
        (values.g, paths),
        (values.JF, [f"the slope of {name}" for name in rates]),
        (values.JL[:, None, :], ["the slope of the running cost"]),
        (values.Jg, [f"the slope of {name}" for name in paths]),
    ]
    # A state that is not a number itself is a consequence: prefer to name its cause.
    known = np.all(np.isfinite(program.point_states(z)), axis=1)
    for array, names in groups:
        bad = ~np.isfinite(array).all(axis=tuple(range(2, array.ndim)))
        for here in (bad & known[:, None], bad):
            if here.any():
                point, i = np.argwhere(here)[0]
                return f"{_capital(names[i])} is not a number at t = {_time(program, z, point)} s."
    if not np.isfinite([values.M, *values.JM]).all():
        return "The terminal cost or its slope is not a number."
    return ""


def _largest_path(program: Program, z: Array, values: Evaluation) -> list[tuple[float, str]]:
    """Return the largest violation of a path or point constraint, if there are any."""
    path = np.maximum(program.path_lower - values.g, values.g - program.path_upper)
    if not path.size:
        return []
    point, i = np.unravel_index(np.argmax(path), path.shape)
    where = f"'{program.path_names[i]}' at t = {_time(program, z, int(point))} s"
    return [(float(path[point, i]), where)]


def _largest_rate(program: Program, z: Array) -> list[tuple[float, str]]:
    """Return the largest violation of a rate bound, if there are any."""
    value, lower, upper = rate_values(program, z)
    violation = np.maximum(lower - value, value - upper)
    if not violation.size:
        return []
    row = int(np.argmax(violation))
    return [(float(violation[row]), f"the rate bound of {program.rates.names[row]}")]


def _largest_defect(program: Program, z: Array, values: Evaluation) -> tuple[float, str]:
    """Return the largest defect and where it stands, in words."""
    d = np.abs(defects(program, z, values))
    k, row, i = np.unravel_index(np.argmax(d), d.shape)
    t = np.concatenate([[0.0], np.cumsum(program.fractions)])[k] * program.duration_of(z)
    return float(d[k, row, i]), f"the defect of {program.state_names[i]} after t = {t:.4g} s"


def _time(program: Program, z: Array, point: int) -> str:
    return f"{program.point_time[point] * program.duration_of(z):.4g}"


def _capital(words: str) -> str:
    return words[0].upper() + words[1:]
