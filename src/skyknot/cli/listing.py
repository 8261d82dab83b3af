"""skyknot missions, vehicles and schema: what there is to choose from."""

from __future__ import annotations

import json

import typer
from rich.console import Console
from rich.table import Table

from skyknot import missions as mission_room
from skyknot.cli.exits import Exit, command, print_json
from skyknot.cli.solving import JsonOption
from skyknot.missions import vehicles as vehicle_room


@command
def missions(as_json: JsonOption = False) -> Exit:
    """List the missions that come with skyknot.

    Example:

      skyknot solve city_hop
    """
    loaded = [mission_room.load(name) for name in mission_room.names()]
    if as_json:
        rows = [{"name": m.name, "title": m.title, "vehicle": m.vehicle.name} for m in loaded]
        print_json({"missions": rows})
        return Exit.GOOD
    _print_table(
        ("mission", "title", "vehicle"), [(m.name, m.title, m.vehicle.name) for m in loaded]
    )
    typer.echo(f"{len(loaded)} missions; solve one with: skyknot solve NAME")
    return Exit.GOOD


@command
def vehicles(as_json: JsonOption = False) -> Exit:
    """List the vehicles that come with skyknot.

    A vehicle of your own is a TOML file; name its path as the mission's vehicle.
    """
    loaded = [vehicle_room.load(name) for name in vehicle_room.names()]
    if as_json:
        rows = [
            {"name": v.name, "title": v.title, "kind": v.kind, "mass_kg": v.mass} for v in loaded
        ]
        print_json({"vehicles": rows})
        return Exit.GOOD
    _print_table(
        ("vehicle", "title", "mass [kg]", "thrust/weight"),
        [(v.name, v.title, f"{v.mass:g}", f"{v.thrust_to_weight:.2f}") for v in loaded],
    )
    typer.echo(f'{len(loaded)} vehicles; name one in a mission file: vehicle = "NAME"')
    return Exit.GOOD


@command
def schema() -> Exit:
    """Print the JSON Schema of mission files, for completion and checks in an editor.

    Example:

      skyknot schema > mission.schema.json
    """
    typer.echo(json.dumps(mission_room.json_schema(), indent=2, ensure_ascii=False))
    return Exit.GOOD


def _print_table(columns: tuple[str, ...], rows: list[tuple[str, ...]]) -> None:
    table = Table(box=None, pad_edge=False)
    for column in columns:
        table.add_column(column, overflow="fold")
    for row in rows:
        table.add_row(*row)
    Console(highlight=False).print(table)
