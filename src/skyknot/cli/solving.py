"""skyknot solve: from a mission to a certified trajectory."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from skyknot import missions
from skyknot.cli.exits import Exit, command, print_json
from skyknot.cli.interruption import Interruption
from skyknot.cli.iterations import Watcher, progress_for
from skyknot.cli.mesh_table import rounds_table
from skyknot.cli.run_folder import check_target, run_facts, write_run
from skyknot.errors import UserError
from skyknot.missions import Mission
from skyknot.report.page import FILE_NAME as REPORT_FILE
from skyknot.solution import Solution
from skyknot.solve import DEFAULT_SOLVER, resolve_solver, resolve_transcription
from skyknot.solve import solve as solve_problem
from skyknot.solvers.base import Solver
from skyknot.status import Status
from skyknot.transcription.refinement import Refinement
from skyknot.verification import Certificate, Limits, certify

MissionArgument = Annotated[
    str,
    typer.Argument(metavar="MISSION", help="Name of a library mission, or path of a TOML file."),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print one JSON object on standard output, nothing else.")
]


@command
def solve(
    mission: MissionArgument,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Write solution, table, certificate and report here."),
    ] = None,
    segments: Annotated[
        int | None,
        typer.Option(min=1, help="Segments of the first mesh, instead of the mission's."),
    ] = None,
    solver: Annotated[
        str | None, typer.Option(metavar="NAME", help="Solver, instead of the mission's.")
    ] = None,
    tolerance: Annotated[
        float | None, typer.Option(help="On the optimality conditions, instead of the mission's.")
    ] = None,
    accuracy: Annotated[
        str | None,
        typer.Option(
            metavar="SHARE",
            help="Refine the mesh to this error, or 'off' for one mesh, instead of the mission's.",
        ),
    ] = None,
    as_json: JsonOption = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Show the time each phase took.")
    ] = False,
) -> Exit:
    """Solve a mission, certify the answer, and write it down.

    The certificate is an independent check: it re-flies the controls with another integrator and
    re-measures every limit, at the nodes and between them.

    Examples
    --------
      skyknot solve city_hop --out runs/city_hop

      skyknot solve my_flight.toml --segments 200 --accuracy off -v

      skyknot solve report_transfer --json | jq .objective

    Exit status: 0 solved and certified, 2 a mistake in the input, 3 not solved, 4 solved but not
    certified or not as accurate as asked, 130 interrupted before there was anything to keep.
    """
    if out is not None:
        check_target(out)
    loaded = missions.load(mission)
    arguments = solve_arguments(loaded, segments, solver, tolerance, accuracy)
    console = Console(highlight=False)
    if not as_json:
        console.print(f"[bold]{loaded.title}[/]  ({loaded.name}, vehicle {loaded.vehicle.name})")
    solution = _solved(loaded, arguments, console, quiet=as_json)
    certificate = certified(loaded, solution) if _worth_checking(solution) else None
    interrupted = solution.status is Status.INTERRUPTED
    written = None if out is None or interrupted else write_run(out, loaded, solution, certificate)
    status = exit_of(solution, certificate)
    if as_json:
        print_json(_facts(loaded, solution, certificate, written, status))
    else:
        _tell(console, solution, certificate, written, verbose=verbose)
    return status


def solve_arguments(
    mission: Mission,
    segments: int | None,
    solver: str | None,
    tolerance: float | None,
    accuracy: str | None = None,
) -> dict[str, Any]:
    """Return the arguments of skyknot.solve: the mission's, or those of the command line.

    Raises
    ------
    UserError
        When scheme or solver is not known or has no such setting, or the accuracy is none.
    """
    settings = mission.settings()
    if segments is not None:
        settings["transcription"] = settings["transcription"] | {"segments": segments}
    resolve_transcription(settings["transcription"])
    chosen = resolve_solver(solver or settings.get("solver", DEFAULT_SOLVER))
    settings["solver"] = _limited(chosen, mission.file.solver.max_iterations)
    if tolerance is not None:
        settings["tolerance"] = tolerance
    if accuracy is not None:
        settings["accuracy"] = _accuracy(accuracy)
    return settings


def _accuracy(text: str) -> float | None:
    """Return the accuracy that a word of the command line means."""
    if text == "off":
        return None
    try:
        return Refinement(float(text)).accuracy
    except ValueError:
        raise UserError(
            "The accuracy is neither a number nor 'off'.",
            where="--accuracy",
            found=repr(text),
            expected="a share such as 1e-4, or off",
            do="Leave it out for the mission's own.",
        ) from None


def _worth_checking(solution: Solution) -> bool:
    return solution.success or solution.status is Status.INACCURATE


def certified(mission: Mission, solution: Solution) -> Certificate:
    """Return the certificate of a solution, by the mission's limits."""
    return certify(
        mission.problem,
        solution.trajectory,
        solution.record.parameters,
        limits=limits_of(mission),
        witness=solution.full_witness(),
    )


def limits_of(mission: Mission) -> Limits:
    """Return the certificate's limits: the mission's own, else those of the vehicle's class."""
    given = mission.file.verification.model_dump(exclude_none=True)
    return Limits.of(mission.vehicle, **given)


def exit_of(solution: Solution, certificate: Certificate | None) -> Exit:
    """Return the exit status that a solution and its certificate earn."""
    if not _worth_checking(solution):
        return Exit.NOT_SOLVED
    if not solution.success:
        return Exit.NOT_CERTIFIED
    return Exit.GOOD if certificate is not None and certificate.passed else Exit.NOT_CERTIFIED


def verdict(solution: Solution, certificate: Certificate | None) -> str:
    """Return the last line of a run."""
    if certificate is None or not _worth_checking(solution):
        return f"Not solved: {solution.message}"
    if not solution.success:
        return f"Solved, not as accurately as asked: {solution.message} {certificate.sentence}"
    effort = f"{solution.iterations} iterations, {solution.solve_time:.3g} s"
    facts = f"objective {solution.objective:.6g}, {solution.trajectory.duration:.4g} s of flight"
    head = "Solved and certified" if certificate.passed else "Solved, not certified"
    return f"{head}: {facts}, {effort}. {certificate.sentence}"


def _limited(solver: Solver, max_iterations: int | None) -> Solver:
    if max_iterations is None:
        return solver
    known = {field.name for field in dataclasses.fields(solver)}  # type: ignore[arg-type]
    if "max_iterations" not in known:
        raise UserError(
            f"The solver '{solver.name}' has no limit of iterations to set.",
            where="solver.max_iterations",
            found=max_iterations,
            expected=", ".join(sorted(known)) or "no settings",
            do="Leave max_iterations out, or choose another solver.",
        )
    limited: Solver = dataclasses.replace(solver, max_iterations=max_iterations)  # type: ignore[type-var]
    return limited


def _solved(
    mission: Mission, arguments: dict[str, Any], console: Console, *, quiet: bool
) -> Solution:
    title = f"{arguments['solver'].name}, {arguments['transcription']['segments']} segments"
    if arguments["accuracy"] is not None:
        title += f", refined to {arguments['accuracy']:g}"
    with Interruption() as interruption, progress_for(console, title, quiet=quiet) as progress:
        watcher = Watcher(progress, interruption)
        return solve_problem(mission.problem, callback=watcher, **arguments)


def _facts(
    mission: Mission,
    solution: Solution,
    certificate: Certificate | None,
    written: Path | None,
    status: Exit,
) -> dict[str, Any]:
    return run_facts(mission, solution) | {
        "certificate": None if certificate is None else certificate.as_dict(),
        "out": None if written is None else str(written),
        "verdict": verdict(solution, certificate),
        "exit_status": int(status),
    }


def _tell(
    console: Console,
    solution: Solution,
    certificate: Certificate | None,
    written: Path | None,
    *,
    verbose: bool,
) -> None:
    if verbose:
        for phase, seconds in solution.record.timings.items():
            console.out(f"  {phase:<14} {1e3 * seconds:10.2f} ms")
    if solution.rounds:
        console.out(rounds_table(solution.rounds))
    if certificate is not None:
        console.out(certificate.table().rsplit("\n", 1)[0])
    if written is not None:
        page = written / REPORT_FILE
        console.out(f"Written to {written}" + (f"; look at {page}" if page.exists() else ""))
    console.out(verdict(solution, certificate))
