"""The meshes of a refinement as lines of text."""

from __future__ import annotations

import math
from collections.abc import Sequence

from skyknot.solution import MeshRound

COLUMNS = ("mesh", "segments", "iterations", "between nodes", "flown", "limits", "jumps", "time")
"""Errors as shares: of the sizes of the states twice, of the limits, of the horizon."""


def rounds_table(rounds: Sequence[MeshRound]) -> str:
    """Return one line for every mesh under a head: what it cost and how far off it was."""
    rows = [COLUMNS, *(_row(number, entry) for number, entry in enumerate(rounds, start=1))]
    widths = [max(len(row[i]) for row in rows) for i in range(len(COLUMNS))]
    return "\n".join(
        "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        for row in rows
    )


def _row(number: int, entry: MeshRound) -> tuple[str, ...]:
    errors = (entry.dynamics, entry.flight, entry.constraints, entry.switching)
    told = [f"{error:.1e}" if math.isfinite(error) else "–" for error in errors]
    spent = f"{1e3 * entry.seconds:.0f} ms"
    solved = entry.status.startswith("solved")
    return (
        str(number),
        str(entry.segments),
        str(entry.iterations),
        *told,
        spent if solved else f"{spent}, {entry.status}",
    )
