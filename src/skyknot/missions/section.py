"""What every section of a mission file shares: strict types, no unknown keys, finite numbers."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field


class Section(BaseModel):
    """A table of the mission file; a misspelt key is an error and never ignored."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


LARGEST = 1e12
"""Beyond this nothing in a mission is meant, and squares of it would overflow."""

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
"""A number of either sign."""

Position = Annotated[list[Number], Field(min_length=3, max_length=3)]
"""North, east, down, m."""

Triple = Annotated[list[Number], Field(min_length=3, max_length=3)]
"""Three numbers, one for each axis."""

Pair = Annotated[list[Number], Field(min_length=2, max_length=2)]
"""Two numbers: north, east."""

Positive = Annotated[float, Field(gt=0, le=LARGEST)]
"""A number above zero."""

NotNegative = Annotated[float, Field(ge=0, le=LARGEST)]
"""Zero or more."""

Weights = Annotated[list[NotNegative], Field(min_length=1)]
"""Weights, one for each state or control."""
