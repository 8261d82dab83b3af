"""skyknot bank: problems with known answers, solved again."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from skyknot.bank.answers_page import (
    HEAD,
    cells,
    family,
    known,
    mesh_cells,
    mesh_head,
    page,
)
from skyknot.bank.catalogue import CATALOGUE, about
from skyknot.bank.judgement import Judgement, judged
from skyknot.bank.mesh_errors import MESHES, MeshErrors, mesh_errors
from skyknot.cli.exits import Exit, command, finite, print_json
from skyknot.cli.solving import JsonOption
from skyknot.errors import UserError
from skyknot.report.error_picture import error_figure
from skyknot.report.figures import write_bytes
from skyknot.report.stability_picture import write_figure


@command
def bank(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME]...", help="Some problems; all if none.")
    ] = None,
    show_list: Annotated[
        bool, typer.Option("--list", help="Tell the problems without solving any.")
    ] = False,
    mesh: Annotated[
        str | None,
        typer.Option(metavar="N,N,...", help="Errors on these uniform meshes too, and the order."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write page, figure and numbers here.")
    ] = None,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the page of the documents.")
    ] = None,
    as_json: JsonOption = False,
) -> Exit:
    """Solve problems whose optimum is known from elsewhere, and compare.

    Closed forms are held to a relative 1e-6, printed numbers to every digit printed, switching
    times to a thousandth of the horizon. Exit status 0 only if every reference is reached, else 3.

    Examples
    --------
      skyknot bank --list

      skyknot bank hager goddard --mesh 10,20,40,80

      skyknot bank --out runs/bank
    """
    chosen = _chosen(names or [])
    if show_list:
        return _list(chosen, as_json)
    written = out is not None or markdown is not None
    meshes = _meshes(mesh) if mesh is not None else MESHES if written else ()
    console = Console(highlight=False, quiet=as_json)
    if not console.is_terminal:
        console = Console(highlight=False, quiet=as_json, width=160)
    judgements = []
    for number, name in enumerate(chosen, 1):
        judgements.append(judged(name, CATALOGUE[name]()))
        _tell(console, number, len(chosen), judgements[-1])
    errors = [mesh_errors(name, CATALOGUE[name](), meshes) for name in chosen] if meshes else []
    _show(console, judgements, errors)
    facts = _facts(judgements, errors)
    if markdown is not None:
        write_bytes(markdown, page(judgements, errors).encode())
    if out is not None:
        _write(out, judgements, errors, facts)
    if as_json:
        print_json(facts)
    console.out(facts["verdict"])
    return Exit.GOOD if all(each.reached for each in judgements) else Exit.NOT_SOLVED


def _chosen(names: list[str]) -> list[str]:
    for name in names:
        if name not in CATALOGUE:
            raise UserError(
                "There is no reference problem of this name.",
                where="NAME",
                found=repr(name),
                expected="one of the names that skyknot bank --list tells",
                do="List them with: skyknot bank --list",
            )
    return names or list(CATALOGUE)


def _meshes(text: str) -> tuple[int, ...]:
    entries = [entry.strip() for entry in text.split(",")]
    if not all(entry.isdecimal() and int(entry) > 0 for entry in entries):
        raise UserError(
            "The meshes are not numbers of segments.",
            where="--mesh",
            found=repr(text),
            expected="positive whole numbers, separated by commas",
            do="Write for example: --mesh 10,20,40,80",
        )
    return tuple(sorted({int(entry) for entry in entries}))


def _list(chosen: list[str], as_json: bool) -> Exit:
    rows = [(name, (made := CATALOGUE[name]()).kind, known(made), about(name)) for name in chosen]
    if as_json:
        keys = ("name", "kind", "reference", "about")
        print_json({"problems": [dict(zip(keys, row, strict=True)) for row in rows]})
        return Exit.GOOD
    console = Console(highlight=False)
    console.print(_table(["problem", "kind", "reference", "what is asked"], rows))
    typer.echo(f"{len(rows)} problems; solve one with: skyknot bank NAME")
    return Exit.GOOD


def _tell(console: Console, number: int, count: int, judgement: Judgement) -> None:
    verdict = "reached" if judgement.reached else judgement.complaint
    console.out(
        f"{number}/{count} {judgement.name}: {judgement.found:.10g},"
        f" error {judgement.relative:+.1e}, {judgement.seconds:.2f} s, {verdict}"
    )


def _show(console: Console, judgements: list[Judgement], errors: list[MeshErrors]) -> None:
    head = [*HEAD[:-1], "s", HEAD[-1]]
    rows = [[*(row := cells(each))[:-1], f"{each.seconds:.2f}", row[-1]] for each in judgements]
    console.print(_table(head, rows))
    if errors:
        console.print(_table(mesh_head(errors[0].meshes), [mesh_cells(each) for each in errors]))


def _table(head: list[str], rows: Any) -> Table:
    table = Table(box=None, pad_edge=False)
    for column in head:
        table.add_column(column, overflow="fold", no_wrap=column == "problem")
    for row in rows:
        table.add_row(*row)
    return table


def _facts(judgements: list[Judgement], errors: list[MeshErrors]) -> dict[str, Any]:
    missed = [each.name for each in judgements if not each.reached]
    verdict = f"{len(judgements) - len(missed)} of {len(judgements)} references reached"
    facts: dict[str, Any] = finite(
        {
            "problems": [_problem_facts(each) for each in judgements],
            "meshes": [
                {
                    "name": each.name,
                    "order": each.order,
                    "errors": dict(zip(map(str, each.meshes), each.errors, strict=True)),
                }
                for each in errors
            ],
            "verdict": f"{verdict}." if not missed else f"{verdict}; missed: {', '.join(missed)}.",
        }
    )
    return facts


def _problem_facts(judgement: Judgement) -> dict[str, Any]:
    reference = judgement.reference
    return {
        "name": judgement.name,
        "kind": reference.kind,
        "source": reference.source,
        "reference": reference.optimum,
        "found": judgement.found,
        "relative_error": judgement.relative,
        "digits": judgement.agreeing,
        "switching_error": judgement.switching,
        "segments": judgement.segments,
        "seconds": judgement.seconds,
        "reached": judgement.reached,
        "complaint": judgement.complaint,
    }


def _write(
    out: Path, judgements: list[Judgement], errors: list[MeshErrors], facts: dict[str, Any]
) -> None:
    write_bytes(out / "bank.md", page(judgements, errors).encode())
    write_bytes(out / "bank.json", json.dumps(facts, indent=1).encode())
    families: dict[str, dict[str, tuple[tuple[int, ...], tuple[float, ...]]]] = {}
    for each in errors:
        if not all(math.isnan(error) for error in each.errors):
            families.setdefault(family(each.name), {})[each.name] = (each.meshes, each.errors)
    write_figure(error_figure(families), out / "errors.png")
