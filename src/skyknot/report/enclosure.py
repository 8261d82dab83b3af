"""What the command line hands in with a solution: what the solution itself does not carry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from skyknot.report.binding import Binding, Confirmation
from skyknot.solution import Solution


@dataclass(frozen=True)
class Enclosure:
    """Papers that go with a report.

    Attributes
    ----------
    mission, vehicle : text of the mission file and of the vehicle file; empty when there is none
    wind : north, east, down, m/s; None in still air
    prices : limits that bind, each with what solving again found; None where nobody tried, and the
        report then tells the prices alone
    companions : other flights to show in the same replay
    """

    mission: str = ""
    vehicle: str = ""
    wind: Sequence[float] | None = None
    prices: Sequence[tuple[Binding, Confirmation | None]] | None = None
    companions: Sequence[Solution] = ()


NOTHING = Enclosure()
"""A solution alone."""
