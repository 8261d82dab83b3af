"""A quantity that the optimiser may choose: the horizon or a parameter."""

from __future__ import annotations

import math
from dataclasses import dataclass

from skyknot.errors import UserError


@dataclass(frozen=True)
class Free:
    """A number to be chosen between two bounds.

    Parameters
    ----------
    lower, upper : float
        Bounds, in the quantity's unit (seconds for a horizon).
    guess : float, optional
        Where the search starts; the geometric or arithmetic middle when None.

    Raises
    ------
    UserError
        When the bounds are not finite, not in order, or the guess is outside them.
    """

    lower: float
    upper: float
    guess: float | None = None

    def __post_init__(self) -> None:
        finite = all(math.isfinite(value) for value in (self.lower, self.upper))
        guess = self.start
        if not finite or self.lower >= self.upper or not self.lower <= guess <= self.upper:
            raise UserError(
                "The bounds of a free quantity do not enclose its guess.",
                where="Free(lower, upper, guess)",
                found=f"lower {self.lower}, upper {self.upper}, guess {self.guess}",
                expected="finite numbers with lower < upper and the guess between them",
                do="Put the smaller number first; leave the guess out to start in the middle.",
            )

    @property
    def start(self) -> float:
        """The guess, or the middle of the bounds."""
        if self.guess is not None:
            return self.guess
        if self.lower > 0:
            return math.sqrt(self.lower * self.upper)
        return 0.5 * (self.lower + self.upper)
