"""skyknot plot: one figure of a run, for a paper or a slide."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from skyknot.cli.exits import Exit, command, print_json
from skyknot.cli.exporting import RunArgument
from skyknot.cli.run_folder import read_run
from skyknot.cli.solving import JsonOption
from skyknot.errors import UserError
from skyknot.missions import Mission
from skyknot.report.figures import KINDS, illustrate, rendered
from skyknot.solution import Solution
from skyknot.storage import replace_file

PICTURES = ("pdf", "svg", "png")
"""Formats of figures; the first is the default."""

_KINDS = "; ".join(f"{kind.name}: {kind.title}" for kind in KINDS.values())


@command
def plot(
    run: RunArgument,
    kind: Annotated[str, typer.Option("--kind", metavar="KIND", help=f"{_KINDS}.")],
    file_format: Annotated[
        str | None,
        typer.Option("--format", metavar="pdf|svg|png", help="By default that of --out, or pdf."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="File to write; in the run's folder by default."),
    ] = None,
    as_json: JsonOption = False,
) -> Exit:
    """Draw one figure of a run.

    PDF and SVG are vectors with real text; all figures share one style, with colours safe for
    colour-blind readers, a name and a unit on every axis. The caption is printed, ready for a
    paper: it tells every liberty that the figure takes.

    Examples
    --------
      skyknot plot runs/city_hop --kind path --out figures/city.pdf

      skyknot plot runs/city_hop --kind rotors --format svg

    Exit status: 0 written, 2 a mistake in the input.
    """
    wanted = _format_of(file_format, out)
    mission, solution = read_run(run)
    path = out or run / "figures" / f"{kind}.{wanted}"
    caption = _draw(mission, solution, kind, wanted, path)
    sentence = f"Written to {path}."
    if as_json:
        facts = {"path": str(path), "kind": kind, "format": wanted, "caption": caption}
        print_json(facts | {"verdict": sentence, "exit_status": 0})
    else:
        typer.echo(caption)
        typer.echo(sentence)
    return Exit.GOOD


def _draw(mission: Mission, solution: Solution, kind: str, wanted: str, path: Path) -> str:
    """Write a figure; return its caption."""
    picture = illustrate(solution, kind, mission.guess)
    content = rendered(picture.figure, wanted)
    replace_file(path, lambda part: part.write_bytes(content))
    return picture.caption


def _format_of(given: str | None, out: Path | None) -> str:
    """Return the format asked for, or that of the file's ending, or the first.

    Raises
    ------
    UserError
        When figures are not written in that format.
    """
    ending = "" if out is None else out.suffix.lower().removeprefix(".")
    wanted = given or ending or PICTURES[0]
    if wanted in PICTURES:
        return wanted
    raise UserError(
        "Figures are not written in this format.",
        where="--format" if given else "--out",
        found=repr(wanted),
        expected=", ".join(PICTURES),
        do="Choose one of them with --format, or an ending of --out.",
    )
