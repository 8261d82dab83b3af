"""The form of a vehicle file: which numbers it holds, in which units, and how each is read.

A vehicle file is TOML and pure data. Every number is a table of three: value, unit, source, as in
`mass = {value = 0.5, unit = "kg", source = "RotorPy 3.0.0, hummingbird_params"}`. Nothing else is
allowed, so that a misspelt key or a missing unit is told and never guessed.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np

from skyknot.errors import UserError


@dataclass(frozen=True)
class Quantity:
    """A number, or array of numbers, that a vehicle file may hold.

    Parameters
    ----------
    units : dict of str to float
        Accepted units and the factor to SI; the first is the one advised.
    shape : tuple
        () for one number, (k,) for k numbers, (None, 2) for rows of two, (None,) for any count.
    required : bool
        Whether the file must have it.
    positive : bool
        Whether all its numbers must be above zero.
    """

    units: dict[str, float]
    shape: tuple[int | None, ...] = ()
    required: bool = False
    positive: bool = False


DEGREE = float(np.deg2rad(1.0))

TEXTS = ("name", "title", "kind")
LAYOUTS = ("x", "plus", "custom")

QUANTITIES = {
    "body.mass": Quantity({"kg": 1.0}, required=True),
    "body.inertia": Quantity({"kg m^2": 1.0}, (3,), required=True),
    "body.gravity": Quantity({"m/s^2": 1.0}, required=True),
    "rotors.arm": Quantity({"m": 1.0}, positive=True),
    "rotors.levers": Quantity({"m": 1.0}, (2,), positive=True),
    "rotors.positions": Quantity({"m": 1.0}, (None, 2)),
    "rotors.spins": Quantity({"1": 1.0}, (None,)),
    "rotors.kappa": Quantity({"m": 1.0}, required=True),
    "rotors.thrust_min": Quantity({"N": 1.0}, required=True),
    "rotors.thrust_max": Quantity({"N": 1.0}, required=True),
    "rotors.radius": Quantity({"m": 1.0}),
    "drag.linear": Quantity({"N s/m": 1.0}, (3,)),
    "limits.speed": Quantity({"m/s": 1.0}),
    "limits.climb": Quantity({"m/s": 1.0}),
    "limits.descent": Quantity({"m/s": 1.0}),
    "limits.tilt": Quantity({"rad": 1.0, "deg": DEGREE}),
    "limits.body_rates": Quantity({"rad/s": 1.0, "deg/s": DEGREE}, (3,)),
    "wrench_limits.thrust": Quantity({"N": 1.0}, (2,)),
    "wrench_limits.torque": Quantity({"N m": 1.0}, (3,)),
    "power.hover": Quantity({"W": 1.0, "kW": 1e3}),
    "power.rated": Quantity({"W": 1.0, "kW": 1e3}),
    "power.figure_of_merit": Quantity({"1": 1.0}),
}

PARTS_OF_A_NUMBER = ("value", "unit", "source")

EXAMPLE = 'mass = {value = 0.5, unit = "kg", source = "data sheet"}'


@dataclass(frozen=True)
class Form:
    """A vehicle file being read: its label for messages, its text, its parsed data."""

    label: str
    text: str
    data: dict[str, Any]

    def place(self, key: str) -> str:
        """Return where a key such as "body.mass" is, with its line if it can be found."""
        section, _, name = key.rpartition(".")
        line = line_of(self.text, section, name)
        return f"{self.label}, {key}" if line is None else f"{self.label} line {line}, {key}"

    def refuse(self, what: str, key: str, found: object, expected: str, do: str) -> NoReturn:
        """Raise a UserError placed at a key."""
        raise UserError(what, where=self.place(key), found=found, expected=expected, do=do)

    def check_keys(self) -> None:
        """Raise a UserError at the first section or key that the form does not know."""
        sections = dict.fromkeys(key.partition(".")[0] for key in QUANTITIES)
        self._check_known("", self.data, (*TEXTS, "notes", *sections))
        for section in sections:
            table = self.data.get(section, {})
            if not isinstance(table, dict):
                self.refuse(
                    f"The section {section} is not a table.",
                    section,
                    table,
                    f"a table headed [{section}]",
                    f"Write [{section}] on a line of its own and its numbers below.",
                )
            known = [key.partition(".")[2] for key in QUANTITIES if key.startswith(section + ".")]
            extra = ["layout"] if section == "rotors" else []
            self._check_known(section, table, (*known, *extra))

    def _check_known(self, section: str, table: dict[str, Any], known: Iterable[str]) -> None:
        known = list(known)
        for key in table:
            if key not in known:
                title = f"section [{section}]" if section else "vehicle file"
                self.refuse(
                    f'The {title} has no key "{key}".',
                    f"{section}.{key}" if section else key,
                    key,
                    ", ".join(known),
                    suggestion(key, known, "Remove it"),
                )

    def text_of(self, key: str, choices: tuple[str, ...] = ()) -> str:
        """Return a required text, one of the choices if any are given."""
        section, _, name = key.rpartition(".")
        value = (self.data.get(section, {}) if section else self.data).get(name)
        if not isinstance(value, str) or not value.strip():
            self.refuse(
                f"The {name} is missing." if value is None else f"The {name} is not a text.",
                key,
                "nothing" if value is None else repr(value),
                " or ".join(f'"{choice}"' for choice in choices) or "a text in quotes",
                f'Write {name} = "{choices[0] if choices else "..."}".',
            )
        if choices and value not in choices:
            self.refuse(
                f'The {name} "{value}" is not known.',
                key,
                value,
                " or ".join(f'"{choice}"' for choice in choices),
                suggestion(value, choices, "Choose one of them"),
            )
        return value

    def notes(self) -> tuple[str, ...]:
        """Return the notes, a list of texts, empty if there are none."""
        notes = self.data.get("notes", [])
        if not isinstance(notes, list) or not all(isinstance(note, str) for note in notes):
            self.refuse(
                "The notes are not a list of texts.",
                "notes",
                repr(notes),
                'texts in quotes, as in notes = ["one", "two"]',
                "Put each note in quotes and all of them in brackets.",
            )
        return tuple(notes)

    def number(self, key: str) -> Any:
        """Return a quantity in SI units, a float or nested tuples of them; None if not given."""
        section, _, name = key.partition(".")
        quantity, entry = QUANTITIES[key], self.data.get(section, {}).get(name)
        if entry is None and not quantity.required:
            return None
        if entry is None:
            self.refuse(
                f"The vehicle file does not give {key}.",
                key,
                "nothing",
                f"a number in {next(iter(quantity.units))}",
                f"Add {name} under [{section}], written like {EXAMPLE}.",
            )
        self._check_parts(key, entry)
        factor = self._factor(key, quantity, entry["unit"])
        values = self._values(key, quantity, entry["value"])
        return _tuples(values * factor)

    def source(self, key: str) -> str | None:
        """Return the source of a quantity, None if it is not given."""
        section, _, name = key.partition(".")
        entry = self.data.get(section, {}).get(name)
        return None if entry is None else str(entry["source"])

    def _check_parts(self, key: str, entry: object) -> None:
        """Raise unless the entry is a table of value, unit and source."""
        if not isinstance(entry, dict):
            self.refuse(
                f"The number {key} stands alone.",
                key,
                repr(entry),
                "a table with value, unit and source",
                f"Write it like {EXAMPLE}.",
            )
        for part in entry:
            if part not in PARTS_OF_A_NUMBER:
                self.refuse(
                    f'The number {key} has an unknown part "{part}".',
                    key,
                    part,
                    ", ".join(PARTS_OF_A_NUMBER),
                    suggestion(part, PARTS_OF_A_NUMBER, "Remove it"),
                )
        for part in PARTS_OF_A_NUMBER:
            value = entry.get(part)
            if value is None or (part != "value" and not (isinstance(value, str) and value)):
                self.refuse(
                    f"The number {key} has no {part}.",
                    key,
                    repr(entry),
                    "value, unit and source",
                    f"Write it like {EXAMPLE}.",
                )

    def _factor(self, key: str, quantity: Quantity, unit: str) -> float:
        """Return the factor of the unit to SI."""
        if unit not in quantity.units:
            units = list(quantity.units)
            self.refuse(
                f'The number {key} cannot be in "{unit}".',
                key,
                f'unit = "{unit}"',
                " or ".join(f'"{name}"' for name in units),
                f'Convert the value and write unit = "{units[0]}".',
            )
        return quantity.units[unit]

    def _values(self, key: str, quantity: Quantity, value: object) -> np.ndarray[Any, Any]:
        """Return the values as a float array of the quantity's shape."""
        array = _floats(value)
        if array is None or not np.all(np.isfinite(array)):
            self.refuse(
                f"The value of {key} is not made of finite numbers.",
                key,
                repr(value)[:80],
                _shape_text(quantity.shape),
                "Write plain numbers, without quotes.",
            )
        if not _fits(array.shape, quantity.shape):
            self.refuse(
                f"The value of {key} has the wrong number of entries.",
                key,
                repr(value)[:80],
                _shape_text(quantity.shape),
                f"Write it like value = {_shape_example(quantity.shape)}.",
            )
        if quantity.positive and not np.all(array > 0.0):
            self.refuse(
                f"The value of {key} is not positive.",
                key,
                repr(value)[:80],
                "above zero",
                "Write the length without a sign.",
            )
        return array


def line_of(text: str, section: str, name: str) -> int | None:
    """Return the line (from 1) where a key, or else its section, stands; None if not found."""
    current, section_line = "", None
    for number, line in enumerate(text.splitlines(), start=1):
        heading = re.match(r"\s*\[\s*([^\[\]]+?)\s*\]", line)
        if heading:
            current = heading.group(1)
            if current == (section or name):
                section_line = number
        elif current == section and re.match(rf"\s*[\"']?{re.escape(name)}[\"']?\s*=", line):
            return number
    return section_line


def suggestion(word: str, known: Iterable[str], otherwise: str) -> str:
    """Return a sentence naming the nearest known word, or `otherwise`."""
    nearest = difflib.get_close_matches(word, list(known), n=1, cutoff=0.5)
    return f'Did you mean "{nearest[0]}"?' if nearest else f"{otherwise}; it is like none of these."


def _floats(value: object) -> np.ndarray[Any, Any] | None:
    """Return numbers, or lists of them, as a float array; None if they are not that."""
    if isinstance(value, bool) or not isinstance(value, int | float | list):
        return None
    if isinstance(value, list):
        rows = [_floats(entry) for entry in value]
        if not rows or any(row is None for row in rows):
            return None
        if len({row.shape for row in rows if row is not None}) != 1:
            return None
        return np.array(rows)
    return np.array(float(value)) if abs(value) < 1e300 else None


def _fits(found: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    """Return whether a shape is the wanted one, None standing for any count."""
    return len(found) == len(wanted) and all(
        size is None or size == count for count, size in zip(found, wanted, strict=True)
    )


def _shape_text(shape: tuple[int | None, ...]) -> str:
    """Return in words what a shape asks for."""
    if not shape:
        return "one finite number"
    if len(shape) == 1:
        return f"a list of {shape[0]} finite numbers" if shape[0] else "a list, one per rotor"
    return f"one list of {shape[1]} finite numbers per rotor"


def _shape_example(shape: tuple[int | None, ...]) -> str:
    """Return a value of the shape."""
    if not shape:
        return "0.5"
    if len(shape) == 1:
        return str([1] * (shape[0] or 4))
    return "[[0.1, 0.1], [-0.1, -0.1], [0.1, -0.1], [-0.1, 0.1]]"


def _tuples(array: np.ndarray[Any, Any]) -> Any:
    """Return a float, or nested tuples of floats."""
    if array.ndim == 0:
        return float(array)
    return tuple(_tuples(entry) for entry in array)
