"""What every kind of figure owes.

Duties of whoever adds a kind:
1. Write ``draw(figure, reading) -> caption`` in a file of its own. ``figure`` is an empty Figure
   or SubFigure; draw on it through the object interface, never through pyplot.
2. Say in ``applies`` for which solutions the kind makes sense; draw without warning for all of
   them, solved or not, with or without a vehicle.
3. Read the trajectory through its own interpolant (``Reading``), nodes as dots; take colours from
   ``style``; put name and unit on every axis, time in seconds.
4. Return a caption of one to three sentences that says what is seen, and every liberty taken (a
   craft drawn larger than life, a stretched altitude).
5. Add the kind to ``KINDS`` in ``figures.py``, and look at the picture.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from skyknot.report.reading import Reading


@dataclass(frozen=True)
class Kind:
    """One kind of figure.

    Attributes
    ----------
    name : what users ask for
    title : heading on a page
    size : width and height, inches
    applies : whether it makes sense for a solution
    draw : draws on an empty figure and returns the caption
    """

    name: str
    title: str
    size: tuple[float, float]
    applies: Callable[[Reading], bool]
    draw: Callable[[Any, Reading], str]
