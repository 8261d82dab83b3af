"""What came out, as rows: for a terminal and for the documents, from the same cells."""

from __future__ import annotations

import math
from collections.abc import Sequence

from skyknot.bank.base import OF_THE_HORIZON, RELATIVE, Reference
from skyknot.bank.catalogue import CATALOGUE, about
from skyknot.bank.judgement import Judgement
from skyknot.bank.mesh_errors import MeshErrors

Rows = list[list[str]]

HEAD = [
    "problem",
    "kind",
    "reference",
    "found",
    "relative error",
    "digits",
    "switches",
    "segments",
    "verdict",
]
"""Columns of what came out; ``switches`` is the largest error of a switching time over T."""

INTRODUCTION = f"""\
# Bank of known answers

*Made by `skyknot bank --markdown docs/bank.md`, which solves all of it anew; do not edit it.*

Problems whose optimum is known from elsewhere, each solved by the recipe that stands with it in
`src/skyknot/bank`. A problem counts as reached when its objective is within {RELATIVE:g} of the
optimum, relative (of a computed optimum, within one unit of its last digit if that is coarser),
when it rounds to every digit that others have printed, and when all switching times are within
{OF_THE_HORIZON:g} of the horizon. No recipe knows the answer: meshes are uniform at first, and
refinement lays nodes on the switches. Where controls enter singular arcs, the arcs that the answer
shows become phases of free length.

"Closed form": evaluated from the formula cited. "Computed": multi-phase Radau and Gauss
collocation of degrees 4 to 8, in the digits on which both agree. "Switches" is the largest error
of a switching time, as a share of the horizon; "digits" how many significant ones agree.
"""

ON_MESHES = """\
## Error against mesh size

The same problems on uniform meshes, Hermite–Simpson with free midpoint controls, started alike:
relative error of the objective, and the slope of its logarithm over that of the number of segments.
Smooth problems show order 4. Where a bound is met inside a segment the order falls to 2 or 3, and
where a control jumps to 2, which is why answers are refined and not only solved on finer meshes.
Singular arcs ring, and the objective is then lower than the optimum. "–": not solved on that mesh,
or too few errors above rounding and above the digits known for an order; "exact": rounding on every
mesh.
"""

ON_SOURCES = """\
## Sources
"""


def cells(judgement: Judgement) -> list[str]:
    """Return the row of a judgement, in the order of ``HEAD``."""
    reference = judgement.reference
    switching = judgement.switching
    return [
        judgement.name,
        reference.kind,
        known(reference),
        f"{judgement.found:.13g}",
        f"{judgement.relative:+.1e}",
        str(judgement.agreeing),
        "" if math.isnan(switching) else "–" if math.isinf(switching) else f"{switching:.1e}",
        str(judgement.segments),
        "reached" if judgement.reached else judgement.complaint,
    ]


def known(reference: Reference) -> str:
    """Return the optimum with the digits that are known of it."""
    return f"{reference.optimum:.{reference.digits or 13}g}"


def mesh_head(meshes: Sequence[int]) -> list[str]:
    """Return the columns of the table of errors."""
    return ["problem", *(f"N = {N}" for N in meshes), "order"]


def mesh_cells(found: MeshErrors) -> list[str]:
    """Return the row of a problem's errors."""
    errors = ["–" if math.isnan(error) else f"{error:.1e}" for error in found.errors]
    order = "exact" if found.exact else "–" if math.isnan(found.order) else f"{found.order:.1f}"
    return [found.name, *errors, order]


def source_lines(name: str, reference: Reference) -> list[str]:
    """Return what a problem asks, where its optimum comes from, and what others have printed."""
    lines = [f"- **{name}**: {about(name)} {reference.source}."]
    for number in reference.printed:
        verdict = f"not asked for: {number.wrong}" if number.wrong else "reached digit for digit"
        lines.append(f"    - printed {number.text} ({number.by}); {verdict}.")
    return lines


def page(judgements: Sequence[Judgement], errors: Sequence[MeshErrors]) -> str:
    """Return the page of the documents, in Markdown."""
    reached = sum(each.reached for each in judgements)
    parts = [
        INTRODUCTION,
        f"{reached} of {len(judgements)} problems reach their reference.",
        "",
        *_table(HEAD, [cells(each) for each in judgements]),
        "",
        ON_MESHES,
        *_table(mesh_head(errors[0].meshes), [mesh_cells(each) for each in errors]),
        "",
        ON_SOURCES,
        *(line for each in judgements for line in source_lines(each.name, each.reference)),
        "",
    ]
    return "\n".join(parts)


def family(name: str) -> str:
    """Return the family of a problem, by the file it is defined in."""
    made = CATALOGUE[name]
    factory = getattr(made, "func", made)
    return str(factory.__module__.rpartition(".")[2].replace("_", " "))


def _table(head: Sequence[str], rows: Rows) -> list[str]:
    return [_line(head), _line(["---"] * len(head)), *map(_line, rows)]


def _line(entries: Sequence[str]) -> str:
    return f"| {' | '.join(entries)} |"
