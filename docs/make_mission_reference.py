"""Write docs/mission-file.md: the words below, then every key of the schema.

Run: python docs/make_mission_reference.py
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from skyknot.missions import json_schema

PAGE = Path(__file__).with_name("mission-file.md")
UNLIMITED = 1e12
"""Bounds of this size only keep absurd numbers out and are not worth a word."""

INTRODUCTION = """\
# The mission file

*Made from the schema by `docs/make_mission_reference.py`; change it there.*

A mission is a TOML file: what flies, from where to where, in what time, at what price, within which
limits. It is pure data and never executed. A misspelt key, a missing unit or two fields that
contradict one another are told with file, line and what to do:

```sh
skyknot lint my_flight.toml
```

Lengths are metres, times seconds, angles radians unless a key ends in `_degrees`, accelerations in
g where a key ends in `_g`. Positions are north, east, **down**: a point 4 m above ground is
`position = [0.0, 27.0, -4.0]`, or `position = [0.0, 27.0]` with `altitude = 4.0`. The vehicle's own
limits always hold.

```toml
title = "Over the hedge"
vehicle = "hummingbird"

[start]
position = [0.0, 0.0]
altitude = 1.5

[goal]
position = [12.0, 3.0]
altitude = 1.5
yaw_degrees = 90.0

[horizon]
free = {lower = 2.0, upper = 20.0}

[objective]
kind = "effort"
R = [0.1, 1000.0, 1000.0, 1000.0]
time = 1.0

[limits]
speed = 5.0
tilt_degrees = 35.0

[[airspace.obstacles]]
kind = "box"
name = "hedge"
center = [6.0, 0.0, -1.0]
size = [1.0, 30.0, 2.0]
clearance = 0.5

[scheme]
segments = 60
```

The missions of the library are good starting points: `skyknot missions` lists them, they lie in
[src/skyknot/missions/library](../src/skyknot/missions/library). A vehicle of one's own is a file
too, in the form of [these](../src/skyknot/missions/vehicle_files); every number there is a table of
value, unit and source. For completion and checks in an editor, give it the
[JSON Schema](mission.schema.json), which `skyknot schema` prints.

Names of schemes and solvers that an installation does not have are refused by name:
[choosing](choosing.md) tells which there are.

## Every key

**Bold** keys must be there.
"""


def reference() -> str:
    """Return the page."""
    schema = json_schema()
    return "\n".join([INTRODUCTION, *_sections("", "", schema, schema["$defs"])]) + "\n"


def _sections(
    heading: str, kind: str, section: dict[str, Any], definitions: dict[str, Any]
) -> Iterator[str]:
    """Yield a section's title, sentence and table, then the sections within."""
    title = f"`{heading}`{kind}" if heading else "At the top of the file"
    yield f"### {title}\n"
    yield f"{section['description'].replace('``', '`')}\n"
    yield "| key | value | default | meaning |\n| --- | --- | --- | --- |"
    required, inner = section.get("required", ()), []
    for key, entry in section["properties"].items():
        parts = [_form(part) for part in entry.get("anyOf", [entry])]
        targets = list(_targets(entry))
        inner += [(key, "items" in entry, target) for target in targets]
        name = f"**`{key}`**" if key in required else f"`{key}`"
        value = " or ".join(part for part in parts if part)
        yield f"| {name} | {value} | {_default(entry)} | {_meaning(entry)} |"
    yield ""
    for key, several, target in inner:
        path = f"{heading.strip('[]')}.{key}" if heading else key
        chosen = definitions[target.rsplit("/", 1)[-1]]
        constant = chosen["properties"].get("kind", {}).get("const")
        yield from _sections(
            f"[[{path}]]" if several else f"[{path}]",
            f', kind `"{constant}"`' if constant else "",
            chosen,
            definitions,
        )


def _targets(entry: dict[str, Any]) -> Iterator[str]:
    """Yield the definitions that an entry refers to."""
    if "$ref" in entry:
        yield entry["$ref"]
    for part in [*entry.get("anyOf", ()), *entry.get("oneOf", ())]:
        yield from _targets(part)
    if "items" in entry:
        yield from _targets(entry["items"])


def _form(entry: dict[str, Any]) -> str:
    """Return in words what may stand there; empty for null."""
    if "const" in entry or "enum" in entry:
        return ", ".join(f'`"{choice}"`' for choice in entry.get("enum", [entry.get("const")]))
    if "$ref" in entry:
        return "a table, below"
    if entry["type"] == "array":
        return _list_form(entry)
    names = {
        "number": "number",
        "integer": "whole number",
        "string": "text",
        "boolean": "true, false",
    }
    return names.get(entry["type"], "") + _bounds(entry)


def _list_form(entry: dict[str, Any]) -> str:
    if list(_targets(entry["items"])):
        return "tables, below"
    fewest, most = entry.get("minItems", 0), entry.get("maxItems")
    if most is None:
        count = f"{fewest} or more"
    else:
        count = f"{fewest}" if fewest == most else f"{fewest} or {most}"
    inner = entry["items"]
    each = (
        "lists of 3 numbers" if inner["type"] == "array" else f"numbers{_bounds(inner, each=True)}"
    )
    return f"list of {count} {each}"


def _bounds(entry: dict[str, Any], each: bool = False) -> str:
    words = {
        "minimum": "{} or more",
        "exclusiveMinimum": "above {}",
        "maximum": "{} or less",
        "exclusiveMaximum": "below {}",
    }
    told = [
        text.format(f"{entry[key]:g}")
        for key, text in words.items()
        if key in entry and abs(entry[key]) < UNLIMITED
    ]
    return (", each " if each else " ") + " and ".join(told) if told else ""


def _meaning(entry: dict[str, Any]) -> str:
    """Return the description, with the bars of a magnitude kept from ending the cell."""
    return str(entry.get("description", "which of the kinds")).replace("|", r"\|")


def _default(entry: dict[str, Any]) -> str:
    value = entry.get("default")
    if value is None or value in ("", []) or isinstance(value, dict):
        return ""
    if isinstance(value, str):
        return f'`"{value}"`'
    return f"`{value}`".lower()


if __name__ == "__main__":
    PAGE.write_text(reference(), encoding="utf-8")
