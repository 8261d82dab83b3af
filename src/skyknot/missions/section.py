"""What every section of a mission file shares: strict types, no unknown keys, finite numbers."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field


class Section(BaseModel):
    """A table of the mission file; a misspelt key is an error and never ignored."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


Position = Annotated[list[float], Field(min_length=3, max_length=3)]
"""North, east, down, m."""

Triple = Annotated[list[float], Field(min_length=3, max_length=3)]
"""Three numbers, one for each axis."""

Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
"""Two numbers: north, east."""

Positive = Annotated[float, Field(gt=0)]
"""A number above zero."""

NotNegative = Annotated[float, Field(ge=0)]
"""Zero or more."""

Weights = Annotated[list[NotNegative], Field(min_length=1)]
"""Weights, one for each state or control."""
