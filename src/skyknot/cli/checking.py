"""skyknot lint and skyknot verify: is the mission sound, is the answer true."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from skyknot import missions
from skyknot.cli.exits import Exit, command, print_json
from skyknot.cli.run_folder import read_run
from skyknot.cli.solving import (
    JsonOption,
    MissionArgument,
    certified,
    limits_of,
    solve_arguments,
)
from skyknot.examination import examine
from skyknot.missions import Mission
from skyknot.missions.placement import shortest_time


@command
def lint(mission: MissionArgument, as_json: JsonOption = False) -> Exit:
    """Check a mission file without solving it.

    Every fault is told in five parts: what is wrong, where (file, line, field), what was found,
    what was expected, what to do.

    Example:

      skyknot lint my_flight.toml
    """
    loaded = missions.load(mission)
    solve_arguments(loaded, None, None, None)
    sentence = _summary(loaded)
    if as_json:
        print_json({"mission": loaded.name, "sound": True, "verdict": sentence, "exit_status": 0})
    else:
        typer.echo(sentence)
    return Exit.GOOD


@command
def verify(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that 'solve --out' wrote.")],
    full: Annotated[
        bool, typer.Option("--full", help="Solve again too: finer meshes, other starts and solver.")
    ] = False,
    as_json: JsonOption = False,
) -> Exit:
    """Certify a run again, from its files alone.

    The problem is rebuilt from DIR/mission.toml and DIR/vehicle.toml, the trajectory is read from
    DIR/solution.npz, and every limit and equation is measured again. With --full the problem is
    also solved again: on meshes twice and four times as fine, from starts a little off, and by
    another solver.

    Examples
    --------
      skyknot verify runs/city_hop

      skyknot verify runs/city_hop --full

    Exit status: 0 certified, 2 not a run, 4 not certified.
    """
    mission, solution = read_run(folder)
    if full:
        scheme = mission.settings()["transcription"]
        certificate = examine(solution, mission.problem, scheme, limits_of(mission))
    else:
        certificate = certified(mission, solution)
    status = Exit.GOOD if certificate.passed else Exit.NOT_CERTIFIED
    if as_json:
        print_json(certificate.as_dict() | {"exit_status": int(status)})
    else:
        typer.echo(certificate.table())
    return status


def _summary(mission: Mission) -> str:
    problem = mission.problem
    needed, why = shortest_time(mission.file, problem)
    time = "free" if problem.free_horizon else f"{problem.duration_guess:g} s"
    pace = f"; at least {needed:.3g} s are needed ({why})" if needed > 0 else ""
    return (
        f"Sound: '{mission.title}', {problem.nx} states, {problem.nu} controls, "
        f"{len(problem.path)} path constraints, {len(problem.points)} waypoints, "
        f"horizon {time}{pace}."
    )
