"""Hooks of mkdocs: what the pages of the site have beyond the files of docs/.

Links that leave docs/ become words, as a page from disk has no repository beside it; the page of
evidence gets the list of all claims, read from the tests themselves.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

OUTSIDE = re.compile(r"(?<!!)\[([^\]]+)\]\(\.\./([^)#\s]+)[^)]*\)")
MARK = "<!-- every claim -->"
TESTS = Path(__file__).parents[1] / "tests"


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Return a page with its links to the repository told in words, and its mark filled in."""
    filled = markdown.replace(MARK, claims()) if MARK in markdown else markdown
    return OUTSIDE.sub(_told, filled)


def claims() -> str:
    """Return every claim of the tests as a list, by room."""
    lines = ["## Every claim of the tests", ""]
    room = ""
    for path in sorted(TESTS.rglob("test_*.py")):
        text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
        if path.parent.name != room:
            room = path.parent.name
            lines += ["", f"### {room}", ""]
        claim = " ".join(text.removeprefix("Claim: ").split())
        told = claim[:1].upper() + claim[1:].replace("[", "\\[")
        lines.append(f"- {told} (`{path.name}`)")
    return "\n".join(lines)


def _told(match: re.Match[str]) -> str:
    words, path = match.groups()
    named = words.strip("`") in path
    return f"`{path}`" if named else f"{words} (`{path}`)"
