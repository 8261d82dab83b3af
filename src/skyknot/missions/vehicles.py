"""Vehicles by name or from a file of one's own.

The vehicles that come with the package lie beside this file in `vehicle_files`, one TOML file each,
every number with its unit and source. A file of one's own has the same form
(`skyknot.missions.vehicle_form`); files are data and never executed.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from skyknot.errors import UserError
from skyknot.missions.vehicle_form import LAYOUTS, QUANTITIES, Form, suggestion
from skyknot.models.allocation import Allocation
from skyknot.models.limits import HoverPower, Limits, WrenchLimits
from skyknot.models.vehicle import KINDS, Vehicle

FOLDER = Path(__file__).parent / "vehicle_files"

LARGEST_FILE = 1_000_000
"""Bytes beyond which a file is not a vehicle file and is not read."""

KEYS_OF_FIELDS = {
    "kind": "kind",
    "mass": "body.mass",
    "inertia": "body.inertia",
    "gravity": "body.gravity",
    "positions": "rotors.positions",
    "spins": "rotors.spins",
    "rotor positions and spins": "rotors.layout",
    "kappa": "rotors.kappa",
    "thrust_min": "rotors.thrust_min",
    "thrust_max": "rotors.thrust_max",
    "rotor_radius": "rotors.radius",
    "drag": "drag.linear",
    "speed": "limits.speed",
    "climb": "limits.climb",
    "descent": "limits.descent",
    "tilt": "limits.tilt",
    "body_rates": "limits.body_rates",
    "thrust": "wrench_limits.thrust",
    "torque": "wrench_limits.torque",
    "hover": "power.hover",
    "rated": "power.rated",
    "figure_of_merit": "power.figure_of_merit",
}
"""Where in the file the field stands that a `Vehicle` complains about."""


def names() -> list[str]:
    """Return the names of the vehicles that come with the package, in alphabetical order."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load(name_or_path: str | Path) -> Vehicle:
    """Return a vehicle by its name, or read from a TOML file.

    Parameters
    ----------
    name_or_path : str or Path
        One of `names()`; or a path, recognised by ".toml" at its end or a separator within.

    Raises
    ------
    UserError
        If there is no such vehicle or file, or the file is not a vehicle's; with line number.
    """
    text = str(name_or_path)
    if isinstance(name_or_path, Path) or text.endswith(".toml") or "/" in text or "\\" in text:
        return parse(_read(Path(name_or_path)), label=Path(name_or_path).name)
    if text not in names():
        raise UserError(
            f'There is no vehicle named "{text}".',
            where="vehicle",
            found=text,
            expected=", ".join(names()),
            do=suggestion(text, names(), "Choose one of them, or give a path that ends in .toml"),
        )
    return parse(_read(FOLDER / f"{text}.toml"), label=f"{text}.toml")


def parse(text: str, label: str = "vehicle file") -> Vehicle:
    """Return the vehicle that a TOML text describes.

    Parameters
    ----------
    text : str
        The text of a vehicle file.
    label : str
        What messages call the file.

    Raises
    ------
    UserError
        At the first thing that is not of the form, or cannot be a vehicle.
    """
    form = Form(label, text, _toml(text, label))
    form.check_keys()
    try:
        return _vehicle(form)
    except UserError as error:
        if error.where not in KEYS_OF_FIELDS:
            raise
        place = form.place(KEYS_OF_FIELDS[error.where])
        raise UserError(
            error.what, where=place, found=error.found, expected=error.expected, do=error.do
        ) from None


def _read(path: Path) -> str:
    """Return the text of a file, or raise a UserError."""
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise UserError(
                "The file is too large to be a vehicle file.",
                where=str(path),
                found=f"{path.stat().st_size} bytes",
                expected=f"at most {LARGEST_FILE} bytes",
                do="Check that the path names a vehicle file.",
            )
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not UTF-8 text"
        raise UserError(
            "The vehicle file cannot be read.",
            where=str(path),
            found=reason or type(error).__name__,
            expected="a readable TOML file in UTF-8",
            do=f"Check the path, or name one of: {', '.join(names())}.",
        ) from None


def _toml(text: str, label: str) -> dict[str, Any]:
    """Return the parsed TOML, or raise a UserError with the parser's line and column."""
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise UserError(
            "The vehicle file is not valid TOML.",
            where=label,
            found=str(error),
            expected="TOML 1.0",
            do="Mend the file at the line given.",
        ) from None


def _vehicle(form: Form) -> Vehicle:
    """Return the vehicle of a form whose keys are known."""
    number = form.number
    return Vehicle(
        name=form.text_of("name"),
        title=form.text_of("title"),
        kind=form.text_of("kind", KINDS),
        mass=number("body.mass"),
        inertia=number("body.inertia"),
        gravity=number("body.gravity"),
        allocation=_allocation(form),
        thrust_min=number("rotors.thrust_min"),
        thrust_max=number("rotors.thrust_max"),
        drag=number("drag.linear") or (0.0, 0.0, 0.0),
        limits=Limits(
            speed=number("limits.speed"),
            climb=number("limits.climb"),
            descent=number("limits.descent"),
            tilt=number("limits.tilt"),
            body_rates=number("limits.body_rates"),
        ),
        wrench_limits=_wrench_limits(form),
        rotor_radius=number("rotors.radius"),
        power=_power(form),
        notes=form.notes(),
        sources={key: source for key in QUANTITIES if (source := form.source(key)) is not None},
    )


def _allocation(form: Form) -> Allocation:
    """Return the allocation of the layout, with exactly the lengths that it needs."""
    layout, kappa = form.text_of("rotors.layout", LAYOUTS), form.number("rotors.kappa")
    arm, levers = form.number("rotors.arm"), form.number("rotors.levers")
    positions, spins = form.number("rotors.positions"), form.number("rotors.spins")
    given = {"arm": arm, "levers": levers, "positions": positions, "spins": spins}
    present = {key for key, value in given.items() if value is not None}
    wanted: dict[str, list[set[str]]] = {
        "x": [{"arm"}, {"levers"}],
        "plus": [{"arm"}],
        "custom": [{"positions", "spins"}],
    }
    if present not in wanted[layout]:
        form.refuse(
            f'The layout "{layout}" is not given by these lengths.',
            "rotors.layout",
            ", ".join(sorted(present)) or "no lengths",
            " or ".join(" and ".join(sorted(choice)) for choice in wanted[layout]),
            "Give arm (hub distance), or levers [forward, right] per axis for an X, or positions.",
        )
    if layout == "custom":
        whole = tuple(int(spin) if spin == int(spin) else spin for spin in spins)
        return Allocation(positions=positions, spins=whole, kappa=kappa)
    if layout == "plus":
        return Allocation.plus(arm, kappa)
    return (
        Allocation.x(arm, kappa)
        if levers is None
        else Allocation.x_levers(levers[0], levers[1], kappa)
    )


def _wrench_limits(form: Form) -> WrenchLimits | None:
    """Return the given wrench box, None if the file leaves it to the rotors."""
    if "wrench_limits" not in form.data:
        return None
    return WrenchLimits(
        thrust=_together(form, "wrench_limits.thrust"),
        torque=_together(form, "wrench_limits.torque"),
    )


def _power(form: Form) -> HoverPower | None:
    """Return the hover power facts, None if the file has none."""
    if "power" not in form.data:
        return None
    return HoverPower(
        hover=_together(form, "power.hover"),
        rated=form.number("power.rated"),
        figure_of_merit=form.number("power.figure_of_merit"),
    )


def _together(form: Form, key: str) -> Any:
    """Return a quantity that its section cannot do without."""
    value = form.number(key)
    if value is None:
        section = key.partition(".")[0]
        form.refuse(
            f"The section [{section}] does not give {key}.",
            key,
            "nothing",
            f"{key} in {next(iter(QUANTITIES[key].units))}",
            f"Add it, or leave the whole section [{section}] out.",
        )
    return value
