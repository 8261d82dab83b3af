"""The text of a mission file and the line on which each of its fields stands.

Python's TOML reader gives values without places. This scanner walks a text that the reader has
accepted, so it can be lenient: it knows headings, keys, strings, arrays and inline tables, and
notes the line of each.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from skyknot.errors import UserError

Path = tuple[str | int, ...]

_KEY = re.compile(r"""[A-Za-z0-9_-]+|"(?:[^"\\]|\\.)*"|'[^']*'""")
_BLANK = re.compile(r"(?:\s|#[^\n]*)*")
_SPACE = re.compile(r"[ \t]*")
_STRING = re.compile(
    r'"""(?:[^\\]|\\.)*?"""+|\'\'\'.*?\'\'\'+|"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'', re.DOTALL
)
_SCALAR = re.compile(r"[^,\]}\n#]*")


@dataclass(frozen=True)
class MissionText:
    """A mission file: its label for messages, its text, its data, the line of each field."""

    label: str
    text: str
    data: dict[str, Any]
    lines: dict[Path, int]

    @classmethod
    def parsed(cls, text: str, label: str) -> MissionText:
        """Return the text with its data, or raise a UserError at the line that is not TOML."""
        try:
            data = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            reason, _, place = str(error).partition(" (at ")
            raise UserError(
                "The mission file is not valid TOML.",
                where=f"{label}, {place.rstrip(')') or 'start'}",
                found=reason,
                expected='lines such as key = value, headings such as [start], text in "quotes"',
                do="Mend the line; look for a missing quote, bracket or equals sign.",
            ) from None
        return cls(label, text, data, _Scanner(text).lines())

    def where(self, path: Sequence[str | int]) -> str:
        """Return file, line and dotted name of a field, e.g. "hop.toml line 7, start.position"."""
        known = tuple(path)
        while known and known not in self.lines:
            known = known[:-1]
        line = f" line {self.lines[known]}" if known else ""
        return f"{self.label}{line}, {dotted(path)}" if path else self.label


def dotted(path: Sequence[str | int]) -> str:
    """Return a path as people write it: airspace.obstacles[2].radius, counted from 1."""
    parts = [f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in path]
    return "".join(parts).lstrip(".")


class _Scanner:
    """One walk through a valid TOML text."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self.found: dict[Path, int] = {}
        self.counts: dict[Path, int] = {}

    def lines(self) -> dict[Path, int]:
        """Return the line, from 1, of every heading, key and array entry."""
        table: Path = ()
        self._skip(_BLANK)
        while self.at < len(self.text):
            if self.text[self.at] == "[":
                table = self._heading()
            else:
                self._entry(table)
            self._skip(_BLANK)
        return self.found

    def _heading(self) -> Path:
        line = self._line()
        repeated = self.text.startswith("[[", self.at)
        self.at += 2 if repeated else 1
        path: Path = ()
        keys = self._keys()
        for i, key in enumerate(keys):
            path = (*path, key)
            if repeated and i == len(keys) - 1:
                self.counts[path] = self.counts.get(path, 0) + 1
                self.found.setdefault(path, line)
            if path in self.counts:
                path = (*path, self.counts[path] - 1)
        self.found.setdefault(path, line)
        self.at += 2 if repeated else 1
        return path

    def _entry(self, table: Path) -> None:
        line = self._line()
        path = table
        for key in self._keys():
            path = (*path, key)
            self.found.setdefault(path, line)
        self.at += 1  # the equals sign
        self._skip(_SPACE)
        self._value(path)

    def _value(self, path: Path) -> None:
        self.found.setdefault(path, self._line())
        opening = self.text[self.at]
        if opening in "[{":
            self._group(path, "]" if opening == "[" else "}")
        elif opening in "\"'":
            self._skip(_STRING)
        else:
            self._skip(_SCALAR)

    def _group(self, path: Path, closing: str) -> None:
        self.at += 1
        index = 0
        self._skip(_BLANK)
        while self.text[self.at] != closing:
            if closing == "]":
                self._value((*path, index))
            else:
                self._entry(path)
            index += 1
            self._skip(_BLANK)
            if self.text[self.at] == ",":
                self.at += 1
                self._skip(_BLANK)
        self.at += 1

    def _keys(self) -> list[str]:
        keys: list[str] = []
        while True:
            self._skip(_SPACE)
            match = _KEY.match(self.text, self.at)
            if match is None:
                return keys
            self.at = match.end()
            keys.append(match.group().strip("\"'"))
            self._skip(_SPACE)
            if self.text[self.at : self.at + 1] != ".":
                return keys
            self.at += 1

    def _skip(self, pattern: re.Pattern[str]) -> None:
        match = pattern.match(self.text, self.at)
        self.at = match.end() if match else self.at

    def _line(self) -> int:
        return self.text.count("\n", 0, self.at) + 1
