"""skyknot plot: one figure of a run, for a paper or a slide."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

from skyknot.cli.exits import Exit, command, print_json
from skyknot.cli.exporting import RunArgument
from skyknot.cli.run_folder import read_run
from skyknot.cli.solving import JsonOption
from skyknot.errors import UserError
from skyknot.missions import Mission
from skyknot.report.animation import FILMS, animated, best_film
from skyknot.report.figures import KINDS, illustrate, rendered
from skyknot.solution import Solution
from skyknot.whole_file import replace_file

PICTURES = ("pdf", "svg", "png")
"""Formats of figures; the first is the default."""

FILM = "animation"
"""The kind that moves."""

_KINDS = "; ".join(f"{kind.name}: {kind.title}" for kind in KINDS.values())


@command
def plot(
    run: RunArgument,
    kind: Annotated[str, typer.Option("--kind", metavar="KIND", help=f"{_KINDS}; {FILM}: Film.")],
    file_format: Annotated[
        str | None,
        typer.Option(
            "--format",
            metavar="pdf|svg|png|gif|mp4",
            help="By default that of --out, or pdf (a film: mp4 or gif).",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="File to write; in the run's folder by default."),
    ] = None,
    as_json: JsonOption = False,
) -> Exit:
    """Draw one figure of a run, or make a film of it.

    PDF and SVG are vectors with real text; all figures share one style, with colours safe for
    colour-blind readers, a name and a unit on every axis. The caption is printed, ready for a
    paper: it tells every liberty that the figure takes. The kind "animation" is a film of the
    flight: MP4 where the program ffmpeg is installed, or GIF.

    Examples
    --------
      skyknot plot runs/city_hop --kind path --out figures/city.pdf

      skyknot plot runs/city_hop --kind rotors --format svg

      skyknot plot runs/city_hop --kind animation --format gif

    Exit status: 0 written, 2 a mistake in the input.
    """
    wanted = _format_of(kind, file_format, out)
    mission, solution = read_run(run)
    path = out or run / "figures" / f"{kind}.{wanted}"
    if kind == FILM:
        caption = _film(solution, wanted, path, quiet=as_json)
    else:
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


def _film(solution: Solution, wanted: str, path: Path, *, quiet: bool) -> str:
    """Write a film, with a bar on a terminal while it is made; return its caption."""
    console = Console(stderr=True, quiet=quiet)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("Drawing frames")

        def tell(frame: int, frames: int) -> None:
            bar.update(task, completed=frame, total=frames)

        content = animated(solution, wanted, tell)
    replace_file(path, lambda part: part.write_bytes(content))
    return f"A film of the flight, {len(content) / 1e6:.1f} MB."


def _format_of(kind: str, given: str | None, out: Path | None) -> str:
    """Return the format asked for, or that of the file's ending, or the first.

    Raises
    ------
    UserError
        When the kind is not written in that format.
    """
    possible, first = (FILMS, best_film()) if kind == FILM else (PICTURES, PICTURES[0])
    ending = "" if out is None else out.suffix.lower().removeprefix(".")
    wanted = given or ending or first
    if wanted in possible:
        return wanted
    raise UserError(
        "Films are not written in this format."
        if kind == FILM
        else "Figures are not written in this format.",
        where="--format" if given else "--out",
        found=repr(wanted),
        expected=", ".join(possible),
        do="Choose one of them with --format, or an ending of --out.",
    )
