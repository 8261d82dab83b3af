"""skyknot export: a run as a file that other programs read."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from skyknot.cli.exits import Exit, command, print_json
from skyknot.cli.run_folder import read_run
from skyknot.cli.solving import JsonOption, certified
from skyknot.errors import UserError
from skyknot.export import FORMATS, Origin, format_named, uncertified_because, write_export
from skyknot.missions import Mission
from skyknot.solution import Solution

RunArgument = Annotated[
    Path, typer.Argument(metavar="RUN", help="Folder that 'solve --out' wrote.")
]
_CHOICES = "; ".join(f"{name}: {known.title}" for name, known in FORMATS.items())


@command
def export(
    run: RunArgument,
    to: Annotated[str, typer.Option("--to", metavar="FORMAT", help=f"{_CHOICES}.")],
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="File to write; in the run's folder by default."),
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Samples per second, instead of the format's."),
    ] = None,
    frame: Annotated[
        str | None, typer.Option(metavar="ned|enu", help="Axes, where the format leaves a choice.")
    ] = None,
    origin: Annotated[
        str | None,
        typer.Option(
            metavar="LAT,LON,ALT",
            help="Place on Earth of x = y = z = 0 [deg, deg, m], instead of the mission's.",
        ),
    ] = None,
    uncertified: Annotated[
        bool, typer.Option("--uncertified", help="Write it though its certificate fails; marked.")
    ] = False,
    as_json: JsonOption = False,
) -> Exit:
    """Write a run in a format that other programs read.

    The run is certified again first, from its files alone. What is not certified is not exported,
    unless --uncertified is given; the file then says so. Frames, units and accuracies of all
    formats: docs/exports.md.

    Examples
    --------
      skyknot export runs/city_hop --to csv --frame enu --rate 200

      skyknot export runs/city_hop --to plan --origin 37.2296,-80.4139,634 --out hop.plan

      skyknot export runs/city_hop --to mavlink-position --rate 50

    Exit status: 0 written, 2 a mistake in the input, 3 not solved, 4 not certified.
    """
    wanted = format_named(to)
    mission, solution = read_run(run)
    certificate = certified(mission, solution) if solution.success else None
    failing = uncertified_because(solution, certificate)
    if failing and not uncertified:
        return _refused(run, solution, failing, as_json=as_json)
    written = write_export(
        solution,
        out or run / wanted.file_name,
        to,
        rate=rate,
        frame=frame,
        origin=origin or mission_origin(mission),
        certificate=certificate,
        uncertified=uncertified,
    )
    sentence = (
        f"Written to {written.path}: {written.format.title}, {written.samples} points; "
        f"{written.accuracy}. {written.verdict[0].upper()}{written.verdict[1:]}."
    )
    if as_json:
        facts = asdict(written) | {"path": str(written.path), "format": to, "mission": mission.name}
        print_json(facts | {"verdict": sentence, "exit_status": 0})
    else:
        typer.echo(sentence)
    return Exit.GOOD


def mission_origin(mission: Mission) -> Origin | None:
    """Return the place on Earth that the mission file gives, if any."""
    given = mission.file.origin
    return None if given is None else Origin(given.latitude, given.longitude, given.altitude)


def _refused(run: Path, solution: Solution, failing: str, *, as_json: bool) -> Exit:
    status = Exit.NOT_CERTIFIED if solution.success else Exit.NOT_SOLVED
    refusal = UserError(
        "This run is not certified, so it is not exported.",
        where=str(run),
        found=failing,
        expected="a run whose certificate passes",
        do="Mend it (a finer mesh, often), or add --uncertified, which marks the file.",
    )
    typer.echo(f"error: {refusal}", err=True)
    typer.echo("Not exported: nothing was written.", err=True)
    if as_json:
        print_json({"error": refusal.parts(), "exit_status": int(status)})
    return status
