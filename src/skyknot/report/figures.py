"""Figures of a solution: drawn one by one, or all written to files."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from skyknot.errors import UserError
from skyknot.report.actuation import CONTROLS_FIGURE, ROTORS_FIGURE, STATES_FIGURE
from skyknot.report.along_the_way import CLEARANCE_FIGURE, LIMITS_FIGURE
from skyknot.report.base import Kind
from skyknot.report.comparison import COMPARISON_FIGURE
from skyknot.report.costate_figure import COSTATES_FIGURE
from skyknot.report.mesh_figure import MESH_FIGURE
from skyknot.report.motion_figures import POSITION_FIGURE, VELOCITY_FIGURE
from skyknot.report.overview import OVERVIEW_FIGURE
from skyknot.report.path_figure import PATH_FIGURE
from skyknot.report.power_figure import POWER_FIGURE
from skyknot.report.progress import HISTORY_FIGURE
from skyknot.report.reading import Reading
from skyknot.report.style import styled
from skyknot.solution import Solution
from skyknot.trajectory import Trajectory
from skyknot.whole_file import replace_file

KINDS: dict[str, Kind] = {
    kind.name: kind
    for kind in (
        PATH_FIGURE,
        STATES_FIGURE,
        POSITION_FIGURE,
        VELOCITY_FIGURE,
        ROTORS_FIGURE,
        CONTROLS_FIGURE,
        POWER_FIGURE,
        CLEARANCE_FIGURE,
        LIMITS_FIGURE,
        MESH_FIGURE,
        HISTORY_FIGURE,
        COSTATES_FIGURE,
        COMPARISON_FIGURE,
        OVERVIEW_FIGURE,
    )
}
"""All kinds of figures by name, in the order of a page."""


@dataclass(frozen=True)
class Illustration:
    """A figure with its words.

    Attributes
    ----------
    kind : name of the kind
    title, caption : heading, and what is seen
    figure : matplotlib figure
    """

    kind: str
    title: str
    caption: str
    figure: Figure


def kinds_of(solution: Solution) -> tuple[str, ...]:
    """Return the kinds of figures that make sense for a solution."""
    return kinds_read(Reading(solution))


def kinds_read(reading: Reading) -> tuple[str, ...]:
    """Return the kinds of figures that make sense for a solution as it is read."""
    return tuple(name for name, kind in KINDS.items() if kind.applies(reading))


def draw(solution: Solution, kind: str = "overview", guess: Trajectory | None = None) -> Figure:
    """Return a matplotlib figure of one kind.

    Parameters
    ----------
    solution : solved or not
    kind : a name of ``kinds_of(solution)``
    guess : where the search started, for "before_after"; a straight line at hover when None

    Raises
    ------
    UserError
        When there is no such kind, or the solution has nothing to show in it.
    """
    return illustrate(solution, kind, guess).figure


def illustrate(solution: Solution, kind: str, guess: Trajectory | None = None) -> Illustration:
    """Return a figure of one kind with title and caption; raises as ``draw``."""
    return illustrated(Reading(solution, guess), kind)


def illustrated(reading: Reading, kind: str) -> Illustration:
    """Return a figure of one kind of a solution as it is read; raises as ``draw``."""
    chosen = KINDS.get(kind)
    if chosen is None or not chosen.applies(reading):
        raise UserError(
            "There is no such figure of this solution.",
            where="kind",
            found=repr(kind),
            expected=", ".join(kinds_read(reading)),
            do="Choose one of the kinds above; some need a vehicle or the problem itself.",
        )
    with styled():
        figure = Figure(figsize=chosen.size, layout="constrained")
        caption = chosen.draw(figure, reading)
    return Illustration(chosen.name, chosen.title, caption, figure)


def save_figures(
    solution: Solution, directory: str | Path, guess: Trajectory | None = None
) -> list[Path]:
    """Write every figure that makes sense as PNG and PDF; return the paths.

    Parameters
    ----------
    solution : solved or not
    directory : made when it does not exist
    guess : as for ``draw``

    Raises
    ------
    UserError
        When the directory cannot be written.
    """
    folder, written = Path(directory), []
    for name in kinds_of(solution):
        figure = draw(solution, name, guess)
        for suffix in ("png", "pdf"):
            path = folder / f"{name}.{suffix}"
            write_bytes(path, rendered(figure, suffix))
            written.append(path)
    return written


def rendered(figure: Figure, suffix: str) -> bytes:
    """Return a figure as the bytes of a PNG, PDF or SVG file, the same bytes every time."""
    undated: dict[str, dict[str, Any]] = {
        "png": {"Software": None},
        "pdf": {"CreationDate": None},
        "svg": {"Date": None},
    }
    stream = io.BytesIO()
    with styled():
        figure.savefig(stream, format=suffix, metadata=undated[suffix])
    return stream.getvalue()


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file, its folder too; a failure is told as a UserError."""
    replace_file(path, lambda part: part.write_bytes(content))
