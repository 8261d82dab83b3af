"""From what the schema refuses to a message in five parts."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from skyknot.errors import UserError
from skyknot.missions.mission_text import MissionText, Path, dotted
from skyknot.missions.schema import MissionFile

_KINDS = {
    "float_type": "a number, without quotes",
    "int_type": "a whole number, without quotes",
    "string_type": 'a text in "quotes"',
    "bool_type": "true or false",
    "list_type": "a list in [brackets]",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "finite_number": "a finite number, not inf or nan",
}
_BOUNDS = {
    "greater_than": ("gt", "above {}"),
    "greater_than_equal": ("ge", "{} or more"),
    "less_than": ("lt", "below {}"),
    "less_than_equal": ("le", "{} or less"),
}


def validated(text: MissionText) -> MissionFile:
    """Return the mission that the text describes, or raise a UserError at the first fault."""
    try:
        return MissionFile.model_validate(text.data)
    except ValidationError as error:
        faults = error.errors(include_url=False)
        places = {_path(text.data, fault["loc"]) for fault in faults}
        raise _told(text, _gravest(faults), len(places)) from None


def nearest(word: object, known: Iterable[str], otherwise: str) -> str:
    """Return a sentence naming the nearest known word, or ``otherwise``."""
    close = difflib.get_close_matches(str(word), list(known), n=1, cutoff=0.5)
    return f'Did you mean "{close[0]}"?' if close else otherwise


def _gravest(faults: Sequence[ErrorDetails]) -> ErrorDetails:
    """Return the fault to tell: a misspelt key explains the missing one, so it comes first."""
    return next((fault for fault in faults if fault["type"] == "extra_forbidden"), faults[0])


def _told(text: MissionText, fault: ErrorDetails, count: int) -> UserError:
    path = _path(text.data, fault["loc"])
    what, found, expected, do = _words(text, fault, path)
    more = f" (Then lint again: {count - 1} more to mend.)" if count > 1 else ""
    return UserError(what, where=text.where(path), found=found, expected=expected, do=do + more)


def _path(data: Any, location: Sequence[str | int]) -> Path:
    """Return the place in the data: the location without the names of union members."""
    path: Path = ()
    for i, part in enumerate(location):
        inside = isinstance(data, dict) and part in data
        entry = isinstance(data, list) and isinstance(part, int) and part < len(data)
        if inside or entry:
            data = data[part]
        elif i < len(location) - 1 or not isinstance(data, dict | list):
            continue
        path = (*path, part)
    return path


def _words(text: MissionText, fault: ErrorDetails, path: Path) -> tuple[str, str, str, str]:
    """Return what, found, expected and do."""
    kind, name = fault["type"], dotted(path[-1:])
    if kind == "extra_forbidden":
        known = list(_fields(text.data, path[:-1]))
        section = f"The section {dotted(path[:-1])}" if len(path) > 1 else "The mission file"
        return (
            f'{section} has no key "{name}".',
            f'"{name}"',
            ", ".join(known),
            nearest(name, known, "Remove it, or look for the key you need in the list above."),
        )
    meaning = _meaning(text.data, path)
    if kind == "missing":
        return (
            f"{dotted(path)} is missing.",
            "nothing",
            meaning or "a value",
            f"Add {name} to {dotted(path[:-1]) or 'the mission file'}.",
        )
    if kind.startswith("union_tag"):
        return _tag_words(fault, path)
    return _value_words(fault, path, meaning)


def _tag_words(fault: ErrorDetails, path: Path) -> tuple[str, str, str, str]:
    """Return the words for an obstacle whose kind is missing or not known."""
    context = fault.get("ctx", {})
    tags = [tag.strip(" '") for tag in str(context.get("expected_tags", "")).split(",") if tag]
    tags = tags or ["cylinder", "sphere", "ellipsoid", "building", "box", "half-space"]
    tag = context.get("tag")
    return (
        f"{dotted(path)} is of no known kind.",
        f'kind = "{tag}"' if tag is not None else "no kind",
        "kind = " + " or ".join(f'"{known}"' for known in tags),
        nearest(tag, tags, "Give one of these kinds."),
    )


def _value_words(fault: ErrorDetails, path: Path, meaning: str) -> tuple[str, str, str, str]:
    """Return the words for a value of the wrong type, size or count."""
    kind, context, value = fault["type"], fault.get("ctx", {}), fault["input"]
    name, found = dotted(path), repr(value)[:80]
    note = f" ({meaning})" if meaning else ""
    if kind == "literal_error":
        choices = [part.strip(" '") for part in context["expected"].replace(" or ", ",").split(",")]
        expected = " or ".join(f'"{choice}"' for choice in choices)
        return (
            f"{name} is not one of its choices.",
            found,
            expected,
            nearest(value, choices, "Take one of the choices."),
        )
    if kind in _BOUNDS:
        key, form = _BOUNDS[kind]
        bound = form.format(f"{context[key]:g}")
        return f"{name} is out of range.", found, bound + note, f"Give a number {bound}."
    if kind in ("too_short", "too_long"):
        limit = context.get("min_length", context.get("max_length"))
        wanted = f"{'at least' if kind == 'too_short' else 'at most'} {limit} entries"
        counted = f"{context['actual_length']} entries: {found}"
        return f"{name} has the wrong number of entries.", counted, wanted + note, f"Give {wanted}."
    if kind == "string_too_short":
        return f"{name} is empty.", found, 'a text in "quotes"' + note, f"Write a {path[-1]}."
    wanted = _KINDS.get(kind, fault["msg"])
    return f"{name} is not what it should be.", found, wanted + note, f"Write {wanted}."


def _fields(data: Any, path: Path) -> dict[str, Any]:
    """Return the fields, by name, of the section at a path of the data."""
    section: Any = MissionFile
    for part in path:
        data = data[part]
        if isinstance(part, int):
            section = get_args(_bare(section))[0]
        else:
            section = section.model_fields[part].annotation
        section = _chosen(section, data)
    return dict(section.model_fields)


def _meaning(data: Any, path: Path) -> str:
    """Return the description of the innermost named field on a path; empty if there is none."""
    while path and isinstance(path[-1], int):
        path = path[:-1]
    if not path:
        return ""
    try:
        field = _fields(data, path[:-1])[str(path[-1])]
    except (AttributeError, IndexError, KeyError, TypeError):
        return ""
    return field.description or ""


def _bare(annotation: Any) -> Any:
    return get_args(annotation)[0] if get_origin(annotation) is Annotated else annotation


def _chosen(annotation: Any, data: Any) -> Any:
    """Return the section class that an annotation stands for, given the data there."""
    annotation = _bare(annotation)
    if get_origin(annotation) not in (Union, UnionType):
        return annotation
    members = [_bare(member) for member in get_args(annotation) if member is not type(None)]
    sections = [m for m in members if isinstance(m, type) and issubclass(m, BaseModel)]
    kind = data.get("kind") if isinstance(data, dict) else None
    for section in sections:
        field = section.model_fields.get("kind")
        if field is not None and kind in get_args(field.annotation):
            return section
    return sections[0] if sections else members[0]
