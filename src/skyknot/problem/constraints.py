"""Constraints along the way and at single times, each with a name users will read again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from skyknot.errors import UserError

Expression = Callable[..., Any]


@dataclass(frozen=True)
class PathConstraint:
    """A scalar that stays between two bounds along the whole way.

    Parameters
    ----------
    name : str
        What messages, figures and certificates call it.
    function : callable
        ``function(x, u)`` of CasADi symbols, optionally with arguments named ``p`` (parameters)
        and ``t`` (time, s); returns one expression.
    lower, upper : float or None
        Bounds in ``unit``; None is free. Equal bounds make an equality.
    unit : str
        Unit of the expression.
    shape : object, optional
        What to draw for it (see ``skyknot.problem.airspace``); not used by solvers.

    Raises
    ------
    UserError
        When there is no name or the bounds leave no room.
    """

    name: str
    function: Expression
    lower: float | None = None
    upper: float | None = None
    unit: str = ""
    shape: Any = None

    def __post_init__(self) -> None:
        _check_bounds(self.name, self.lower, self.upper)


@dataclass(frozen=True)
class PointConstraint:
    """A scalar that lies between two bounds at one time of the horizon (a waypoint, an end).

    Parameters
    ----------
    name, function, lower, upper, unit : as for PathConstraint
    at : float
        Place in the horizon: 0 is the start, 1 the end. The mesh gets a node there.
    """

    name: str
    function: Expression
    at: float
    lower: float | None = None
    upper: float | None = None
    unit: str = ""

    def __post_init__(self) -> None:
        _check_bounds(self.name, self.lower, self.upper)
        if not 0 <= self.at <= 1:
            raise UserError(
                "A point constraint lies outside the horizon.",
                where=f"{self.name}.at",
                found=self.at,
                expected="a fraction of the horizon, 0 to 1",
                do="Divide the time of the event by the duration.",
            )


def _check_bounds(name: str, lower: float | None, upper: float | None) -> None:
    if not name:
        raise UserError(
            "A constraint has no name.",
            where="constraint",
            found="an empty name",
            expected="a short name, e.g. 'tower'",
            do="Name the constraint; messages will use it.",
        )
    both = lower is not None and upper is not None
    neither = lower is None and upper is None
    nan = any(value is not None and value != value for value in (lower, upper))
    if nan or neither or (both and lower > upper):  # type: ignore[operator]
        raise UserError(
            f"The bounds of constraint '{name}' leave no room or do not bound.",
            where=f"{name}.lower, {name}.upper",
            found=f"lower {lower}, upper {upper}",
            expected="lower ≤ upper, at least one of them a number",
            do="Exchange the bounds, or drop the constraint.",
        )
