"""An extension of griffe: "name : words" in our docstrings is a description, not a type.

Types stand in the annotations; the words after the colon say shape, unit and meaning. Only where an
indented sentence follows are they the type, as numpydoc means it, and stay.
"""

from __future__ import annotations

import re
from typing import Any

import griffe

ENTRY = re.compile(r"^(\*{0,2}\w[\w, *]*?) : (.+)$")
SECTIONS = ("Parameters", "Attributes")


class Words(griffe.Extension):
    """Moves the words after the colon to where descriptions stand."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Rewrite the docstring of one object before it is parsed."""
        if obj.docstring is not None:
            obj.docstring.value = described(obj.docstring.value)


def described(docstring: str) -> str:
    """Return a docstring whose entries have their words below their names."""
    lines = docstring.splitlines()
    result: list[str] = []
    inside = False
    for i, line in enumerate(lines):
        following = lines[i + 1] if i + 1 < len(lines) else ""
        if following and not following.strip("-"):
            inside = line.strip() in SECTIONS
        entry = ENTRY.match(line)
        sentence = re.match(r"^ +[A-Z]", following)
        if inside and entry is not None and not sentence:
            result += [entry[1], f"    {entry[2]}"]
        else:
            result.append(line)
    return "\n".join(result)
