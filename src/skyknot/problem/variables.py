"""Named states and controls with their units and bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError

Array = NDArray[np.float64]
Bound = float | None


@dataclass(frozen=True)
class State:
    """A state: name, unit, bounds (None is free) and typical size for scaling."""

    name: str
    unit: str = ""
    lower: Bound = None
    upper: Bound = None
    scale: float | None = None


@dataclass(frozen=True)
class Control:
    """A control: name, unit, bounds (None is free) and typical size for scaling."""

    name: str
    unit: str = ""
    lower: Bound = None
    upper: Bound = None
    scale: float | None = None


Variable = TypeVar("Variable", State, Control)


def named(
    entries: Sequence[str | Variable], kind: type[Variable], field: str
) -> tuple[Variable, ...]:
    """Return the entries as ``kind``; plain strings become names without unit or bounds.

    Raises
    ------
    UserError
        When there is no entry, a name is empty, or a name occurs twice.
    """
    variables = tuple(kind(entry) if isinstance(entry, str) else entry for entry in entries)
    names = [variable.name for variable in variables]
    repeated = sorted({name for name in names if names.count(name) > 1})
    if not names or repeated or "" in names:
        raise UserError(
            f"The {field} need distinct names.",
            where=field,
            found=", ".join(repeated) if repeated else repr(names),
            expected="at least one name, each used once",
            do="Give every entry its own name.",
        )
    return variables


def bound_arrays(
    variables: Sequence[State | Control],
    bounds: tuple[object, object] | None,
    field: str,
) -> tuple[Array, Array]:
    """Return lower and upper bounds as arrays with ±inf where free.

    ``bounds`` (a pair of numbers or of lists; None entries are free) replaces the bounds that
    the variables carry themselves.
    """
    if bounds is None:
        pair: tuple[object, object] = ([v.lower for v in variables], [v.upper for v in variables])
    else:
        pair = bounds
    lower = filled(pair[0], len(variables), -np.inf, f"{field}[0]")
    upper = filled(pair[1], len(variables), np.inf, f"{field}[1]")
    for variable, low, high in zip(variables, lower, upper, strict=True):
        if not low <= high:
            raise UserError(
                f"The bounds of {variable.name} leave no room.",
                where=f"{field}, {variable.name}",
                found=f"lower {low:g}, upper {high:g} {variable.unit}".rstrip(),
                expected="lower ≤ upper",
                do="Exchange or widen the bounds.",
            )
    return lower, upper


def filled(values: object, n: int, default: float, field: str) -> Array:
    """Return ``values`` as n numbers; None (all or single entries) becomes ``default``."""
    if values is None:
        return np.full(n, default)
    if np.isscalar(values):
        values = [values] * n
    entries = [default if v is None else float(v) for v in np.asarray(values, dtype=object).ravel()]
    if len(entries) != n or np.any(np.isnan(entries)):
        raise UserError(
            f"{field} has the wrong size or holds NaN.",
            where=field,
            found=f"{len(entries)} entries: {values}",
            expected=f"{n} numbers, or None where free",
            do=f"Give one entry for each of the {n} names.",
        )
    return np.array(entries)
