"""skyknot schemes: which there are, and how each treats smooth and stiff problems."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from skyknot.cli.exits import Exit, command, print_json
from skyknot.cli.solving import JsonOption
from skyknot.errors import UserError
from skyknot.report.stability_picture import stability_figure, write_figure
from skyknot.solve import resolve_transcription
from skyknot.transcription import DOORS
from skyknot.transcription.table import SchemeTable

COLUMNS = ("scheme", "points", "order", "controls", "costates", "A-stable", "L-stable", "source")
RESOLUTION = 241


@command
def schemes(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="One scheme, told in full.")
    ] = None,
    points: Annotated[
        int | None, typer.Option(min=1, help="Points of a segment: lobatto, radau, chebyshev.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the stability region (.png .pdf .svg)")
    ] = None,
    as_json: JsonOption = False,
) -> Exit:
    """List the transcription schemes, with their orders and their stability.

    Orders are those of states, controls and costates on smooth problems, at the scheme's own
    points; A-stable: decaying modes decay with any step; L-stable: stiff ones die at once.

    Example:

      skyknot schemes radau --points 3 --plot radau.png
    """
    if name is None:
        return _list(points, plot, as_json)
    table = _table(name, points)
    written = None if plot is None else _draw(table, plot)
    if as_json:
        print_json({"scheme": _facts(name, table), "plot": None if written is None else str(plot)})
        return Exit.GOOD
    _tell(name, table)
    if written is not None:
        typer.echo(f"Stability region drawn: {written}")
    typer.echo(f"{table.name}: order {table.order}, {_verdict(table)}")
    return Exit.GOOD


def _list(points: int | None, plot: Path | None, as_json: bool) -> Exit:
    if points is not None or plot is not None:
        raise UserError(
            "A picture or a number of points belongs to one scheme.",
            where="schemes",
            found="no NAME",
            expected=" or ".join(DOORS),
            do="Write for example: skyknot schemes radau --points 3 --plot radau.png",
        )
    facts = [_facts(name, _table(name, None)) for name in DOORS]
    if as_json:
        print_json({"schemes": facts})
        return Exit.GOOD
    table = Table(box=None, pad_edge=False)
    for column in COLUMNS:
        table.add_column(column, overflow="fold", no_wrap=column == "scheme")
    for row in facts:
        table.add_row(*(_word(row[column]) for column in COLUMNS))
    Console(highlight=False).print(table)
    typer.echo(f"{len(facts)} schemes; tell one in full with: skyknot schemes NAME")
    return Exit.GOOD


def _table(name: str, points: int | None) -> SchemeTable:
    choice: dict[str, Any] = {"scheme": name}
    fixed = name in DOORS and "points" not in inspect.signature(DOORS[name]).parameters
    if points is not None and fixed:
        raise UserError(
            "This scheme has its own number of points.",
            where="points",
            found=f"--points {points} with '{name}'",
            expected="no --points",
            do="Leave it out, or take lobatto, radau or chebyshev.",
        )
    return resolve_transcription(choice | ({} if points is None else {"points": points})).table


def _facts(name: str, table: SchemeTable) -> dict[str, Any]:
    """Return what the columns tell, and what they have no room for."""
    orders, found = table.orders[table.default_controls], table.stability
    return {
        "scheme": name,
        "points": len(table.used),
        "order": orders.states,
        "controls": orders.controls,
        "costates": orders.costates,
        "A-stable": found.a_stable,
        "L-stable": found.l_stable,
        "source": table.source,
        "order of integration": table.order,
        "stage order": table.stage_order,
        "parametrisations": {
            kind: {"states": each.states, "controls": each.controls, "costates": each.costates}
            for kind, each in table.orders.items()
        },
        "numerator": found.numerator.tolist(),
        "denominator": found.denominator.tolist(),
        "R(infinity)": found.at_infinity,
        "axis excess": found.axis_excess,
    }


def _tell(name: str, table: SchemeTable) -> None:
    found = table.stability
    for line in (
        f"{table.name} ({name}): {table.source}",
        f"points: {', '.join(f'{tau:.6g}' for tau in table.points[table.used])}",
        *(
            f"{kind} control: states {each.states}, controls {each.controls},"
            f" costates {each.costates}"
            for kind, each in table.orders.items()
        ),
        f"R(z) = ({_polynomial(found.numerator)}) / ({_polynomial(found.denominator)})",
        f"R(∞) = {found.at_infinity:.6g}, max |R(iy)| − 1 = {found.axis_excess:.1e}",
    ):
        typer.echo(line)


def _polynomial(coefficients: np.ndarray[Any, Any]) -> str:
    terms = [
        f"{value:+.6g}" + ("" if power == 0 else " z" if power == 1 else f" z^{power}")
        for power, value in enumerate(coefficients)
    ]
    return " ".join(terms).removeprefix("+")


def _verdict(table: SchemeTable) -> str:
    found = table.stability
    if found.l_stable:
        return "A-stable and L-stable."
    return "A-stable, not L-stable." if found.a_stable else "not A-stable."


def _draw(table: SchemeTable, path: Path) -> Path:
    reach = 4.0 if not len(table.stability.poles) else 1.6 * np.max(np.abs(table.stability.poles))
    axis = np.linspace(-reach, reach, RESOLUTION)
    return write_figure(
        stability_figure(table.name, axis, axis, table.stability.region(axis, axis)), path
    )


def _word(value: object) -> str:
    return {True: "yes", False: "no"}[value] if isinstance(value, bool) else str(value)
