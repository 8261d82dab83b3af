"""skyknot paper: every claim of the source report, run and judged."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from skyknot.cli.exits import Exit, command, print_json
from skyknot.cli.solving import JsonOption
from skyknot.errors import UserError
from skyknot.paper import EXPERIMENTS, Finding, Scale, run_claims
from skyknot.paper.claims_page import MARKS, summary
from skyknot.paper.run import KEPT

STEP = "{task.fields[step]}"


@command
def paper(
    out: Annotated[
        Path, typer.Option(metavar="DIR", help="Write claims.json, index.html and figures here.")
    ] = Path("paper"),
    quick: Annotated[bool, typer.Option("--quick", help="Small sizes, for a first look.")] = False,
    as_json: JsonOption = False,
) -> Exit:
    """Run every claim of the source report and judge it.

    What is done is kept in DIR, so that an interrupted run is taken up where it stopped; remove
    DIR/experiments to run all of it again.

    Example:

      skyknot paper --out runs/paper --quick
    """
    check_folder(out)
    console = Console(highlight=False)
    try:
        findings = run_claims(out, Scale(quick)) if as_json else _shown(console, out, Scale(quick))
    except KeyboardInterrupt:
        kept = len(list((out / KEPT).glob("*.json")))
        typer.echo(
            f"Interrupted: {kept} of {len(EXPERIMENTS)} claims are kept in {out}; the same command"
            " takes the run up there.",
            err=True,
        )
        return Exit.INTERRUPTED
    claims = [finding.claim for finding in findings.values()]
    if as_json:
        told = {name: finding.as_dict()["claim"] for name, finding in findings.items()}
        print_json({"claims": told, "summary": summary(claims), "exit_status": int(Exit.GOOD)})
        return Exit.GOOD
    for claim in claims:
        mark, _ = MARKS[claim.verdict]
        console.print(f"{mark} {claim.claim} ({claim.section}): {claim.verdict}", soft_wrap=True)
    typer.echo(f"Written: {out / 'index.html'}")
    typer.echo(summary(claims))
    return Exit.GOOD


def check_folder(folder: Path) -> None:
    """Raise a UserError when the folder holds anything but an earlier run of this command."""
    if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
        return
    if (folder / KEPT).is_dir():
        return
    raise UserError(
        "The output folder holds something that is not a run of skyknot paper.",
        where=f"--out {folder}",
        found="a file" if not folder.is_dir() else f"a folder without '{KEPT}'",
        expected="a folder that does not exist yet, is empty, or holds an earlier run",
        do="Name another folder; skyknot replaces only its own.",
    )


def _shown(console: Console, out: Path, scale: Scale) -> dict[str, Finding]:
    """Run under a progress bar; a line a step where there is no terminal."""
    if not console.is_terminal:
        return run_claims(out, scale, _say)
    columns = (
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[step]}"),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("claims", total=None, step="")

        def tell(step: str, done: int, total: int) -> None:
            bar.update(task, completed=done, total=total, step=step)

        return run_claims(out, scale, tell)


def _say(step: str, done: int, total: int) -> None:
    if done < total:
        typer.echo(f"{done + 1} of {total}: {step}")
