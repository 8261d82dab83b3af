"""What every check owes, and what it hands back.

Duties of whoever adds a check:
1. Write one function ``name(evidence, limits) -> Check | None`` in a small file of this room; None
   when the problem has nothing of the kind (no path constraint, say).
2. Recompute from the problem's own callables and the trajectory's own numbers. Import no solver,
   no transcription, no kernel: a check shares no code with what it checks.
3. Say in ``how``, in one sentence, how the value was measured; name in ``worst`` the state,
   control or constraint and the time.
4. Give the value in the unit of the quantity named, and its limit from ``Limits``, with the reason
   for the default beside it.
5. Never raise for a bad trajectory: a number that is not finite is a failed check.
6. Add the function to ``CHECKS`` in ``certify.py``, and to the tests one mutation that only a
   working check catches.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Check:
    """One measured statement about a trajectory.

    Attributes
    ----------
    name : what the check is called in tables
    value, limit : measured and allowed, in ``unit``; of several quantities, those of the one that
        comes closest to its limit or exceeds it most
    unit : unit of value and limit; empty when dimensionless
    passed : whether every quantity keeps its limit
    how : one sentence: how it was measured
    worst : which quantity, and when; empty when nothing exceeds anything
    information : whether it only tells something and cannot fail
    """

    name: str
    value: float
    limit: float
    unit: str
    passed: bool
    how: str
    worst: str
    information: bool = False

    @property
    def load(self) -> float:
        """Share of the limit that is used up: below 1 passes; infinite when not finite."""
        if not math.isfinite(self.value):
            return math.inf
        if self.limit > 0:
            return self.value / self.limit
        return 0.0 if self.value <= 0 else math.inf

    def as_dict(self) -> dict[str, object]:
        """Return plain data for JSON; a value that is not finite becomes None."""
        return {
            "name": self.name,
            "value": self.value if math.isfinite(self.value) else None,
            "limit": self.limit if math.isfinite(self.limit) else None,
            "unit": self.unit,
            "passed": self.passed,
            "how": self.how,
            "worst": self.worst,
        }


def worst_of(
    name: str,
    how: str,
    excess: Array,
    allowed: Array,
    names: Sequence[str],
    units: Sequence[str],
    times: Array | None = None,
) -> Check:
    """Return the check on the entry that comes closest to its limit.

    Parameters
    ----------
    excess : (M, n) amounts by which n quantities fail at M times, ≥ 0; not finite is worst of all
    allowed : (n,) limits, each in its quantity's unit
    names, units : of the n quantities
    times : (M,) s, to say when; None where time does not matter
    """
    finite = np.where(np.isfinite(excess), excess, np.inf)
    # A limit that is not finite was measured on numbers that are not: nothing keeps it.
    loads = np.where(np.isfinite(allowed), finite / np.where(allowed > 0, allowed, 1.0), np.inf)
    row, column = divmod(int(np.argmax(loads)), finite.shape[1])
    value, limit = float(finite[row, column]), float(allowed[column])
    when = "" if times is None else f" at {times[row]:.4g} s"
    return Check(
        name=name,
        value=value,
        limit=limit,
        unit=units[column],
        passed=bool(np.all(loads <= 1)),
        how=how,
        worst=f"{names[column]}{when}" if value > 0 else "",
    )


def outside(values: Array, lower: Array, upper: Array) -> Array:
    """Return (M, n) how far values lie outside [lower, upper] (n,); NaN stays NaN."""
    below, above = lower - values, values - upper
    return np.maximum(np.maximum(below, above), 0.0)


def cost_per(unit: str) -> str:
    """Return the unit of a multiplier: the objective's over that of what it multiplies."""
    if not unit:
        return "cost"
    return f"cost/({unit})" if "/" in unit or " " in unit else f"cost/{unit}"
