"""The entry point ``skyknot``."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from skyknot.cli.bank import bank
from skyknot.cli.bench import bench
from skyknot.cli.checking import lint, verify
from skyknot.cli.claims import paper
from skyknot.cli.doctor import doctor
from skyknot.cli.exits import Exit
from skyknot.cli.exporting import export
from skyknot.cli.listing import missions, schema, vehicles
from skyknot.cli.live import live
from skyknot.cli.plotting import plot
from skyknot.cli.scheme_list import schemes
from skyknot.cli.solving import solve
from skyknot.version import __version__

app = typer.Typer(
    name="skyknot",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"skyknot {__version__}")
        raise typer.Exit(0)


@app.callback()
def about(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Optimal trajectories of multirotor and urban-air-mobility vehicles, with proof.

    A mission file (TOML) says what flies, from where to where, and at what price; skyknot
    answers with a trajectory, an independent certificate and a report, or says why not.

    First steps:

      skyknot doctor                                is the installation sound?

      skyknot missions                              what is there to fly?

      skyknot solve city_hop --out runs/city_hop    solve, certify, draw

      skyknot verify runs/city_hop                  check the answer again

      skyknot export runs/city_hop --to csv         give it to other programs

      skyknot live city_hop                         drag the goal, see the path follow
    """


for _command in (
    solve,
    live,
    lint,
    verify,
    export,
    plot,
    missions,
    vehicles,
    schemes,
    schema,
    paper,
    doctor,
    bench,
    bank,
):
    app.command()(_command)


def main() -> None:
    """Run the command line and exit with its status."""
    try:
        app(prog_name="skyknot")
    except KeyboardInterrupt:
        sys.exit(int(Exit.INTERRUPTED))
    except BrokenPipeError:
        # the reader of our output left (skyknot … | head): nothing more to say, nothing to mend
        sys.stderr.close()
        sys.exit(int(Exit.GOOD))
