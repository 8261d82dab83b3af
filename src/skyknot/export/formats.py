"""All export formats by name, in the order of the documentation."""

from __future__ import annotations

from skyknot.export.base import Format
from skyknot.export.rpg_table import CSV

FORMATS: dict[str, Format] = {entry.name: entry for entry in (CSV,)}
"""Formats by name."""
