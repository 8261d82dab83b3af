"""A mission: what a user wrote, checked, as a Problem with its settings."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from skyknot.errors import UserError
from skyknot.missions import vehicles
from skyknot.missions.faults import nearest, validated
from skyknot.missions.formulation import model_of, problem_of
from skyknot.missions.guess_lines import guess_of
from skyknot.missions.mission_text import MissionText
from skyknot.missions.placement import check_problem, check_velocities
from skyknot.missions.schema import MissionFile
from skyknot.missions.soundness import check_file
from skyknot.models.vehicle import Vehicle
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory

FOLDER = Path(__file__).parent / "library"

LARGEST_FILE = 1_000_000
"""Bytes beyond which a file is not a mission file and is not read."""


@dataclass(frozen=True)
class Mission:
    """A checked mission.

    Attributes
    ----------
    name : file name without its suffix
    file : what the mission file says, field by field
    vehicle : what flies
    problem : what is asked, in continuous time
    guess : where the search starts; None leaves it to the guess ladder
    text : the mission file as it was read
    """

    name: str
    file: MissionFile
    vehicle: Vehicle
    problem: Problem
    guess: Trajectory | None
    text: str

    @property
    def title(self) -> str:
        """One line for people."""
        return self.file.title

    @property
    def description(self) -> str:
        """What the mission is about."""
        return self.file.description

    def settings(self) -> dict[str, Any]:
        """Return the arguments of ``skyknot.solve`` besides the problem.

        ``solver`` is among them only when the mission names one; ``accuracy`` is None when the
        mission wants its first mesh alone.
        """
        scheme = self.file.scheme
        transcription: dict[str, Any] = {"scheme": scheme.name, "segments": scheme.segments}
        defaults = type(scheme)()
        for choice in ("points", "controls", "form", "enforce", "objective"):
            if getattr(scheme, choice) != getattr(defaults, choice):
                transcription[choice] = getattr(scheme, choice)
        settings = {
            "transcription": transcription,
            "tolerance": self.file.solver.tolerance,
            "guess": self.guess,
            "accuracy": None if scheme.accuracy == "off" else scheme.accuracy,
        }
        if self.file.solver.name is not None:
            settings["solver"] = self.file.solver.name
        return settings


def names() -> list[str]:
    """Return the names of the missions that come with the package, in alphabetical order."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load(name_or_path: str | Path, vehicle: str | Path | None = None) -> Mission:
    """Return a mission by its name, or read from a TOML file.

    Parameters
    ----------
    name_or_path : one of ``names()``; or a path, recognised by ".toml" or a separator
    vehicle : name or file of a vehicle to fly instead of the mission's own

    Raises
    ------
    UserError
        With file, line and field, at the first thing that cannot be a mission.
    """
    text = str(name_or_path)
    if isinstance(name_or_path, Path) or text.endswith(".toml") or "/" in text or "\\" in text:
        path = Path(name_or_path)
        return parse(_read(path), path.stem, path.name, path.parent, vehicle)
    if text not in names():
        raise UserError(
            f'There is no mission named "{text}".',
            where="mission",
            found=f'"{text}"',
            expected=", ".join(names()),
            do=nearest(text, names(), "Choose one of them, or give a path that ends in .toml."),
        )
    return parse(_read(FOLDER / f"{text}.toml"), text, f"{text}.toml", FOLDER, vehicle)


def parse(
    text: str,
    name: str = "mission",
    label: str = "mission file",
    folder: Path | None = None,
    vehicle: str | Path | None = None,
) -> Mission:
    """Return the mission that a TOML text describes.

    Parameters
    ----------
    text : the text of a mission file
    name : what the mission is called
    label : what messages call the file
    folder : where a vehicle file is looked for; the current folder by default
    vehicle : as for ``load``

    Raises
    ------
    UserError
        As for ``load``.
    """
    source = MissionText.parsed(text, label)
    file = validated(source)
    craft = _vehicle(source, file, folder or Path(), vehicle)
    check_file(source, file, craft)
    check_velocities(source, file, craft)
    problem = problem_of(name, file, craft)
    check_problem(source, file, problem)
    guess = guess_of(file, problem, model_of(file, craft))
    return Mission(name, file, craft, problem, guess, text)


def _vehicle(
    source: MissionText, file: MissionFile, folder: Path, instead: str | Path | None
) -> Vehicle:
    if instead is not None:
        return vehicles.load(instead)
    if file.vehicle.endswith(".toml") or "/" in file.vehicle:
        return vehicles.load(folder / file.vehicle)
    known = vehicles.names()
    if file.vehicle not in known:
        raise UserError(
            f'There is no vehicle named "{file.vehicle}".',
            where=source.where(("vehicle",)),
            found=f'"{file.vehicle}"',
            expected=", ".join(known),
            do=nearest(
                file.vehicle, known, "Choose one of them, or give a path that ends in .toml."
            ),
        )
    return vehicles.load(file.vehicle)


def _read(path: Path) -> str:
    """Return the text of a mission file, or raise a UserError."""
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise _unreadable(path, f"{path.stat().st_size} bytes")
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise _unreadable(path, error.strerror or type(error).__name__) from None
    except UnicodeDecodeError as error:
        raise _unreadable(path, f"a byte that is not UTF-8 at {error.start}") from None


def _unreadable(path: Path, found: str) -> UserError:
    close = nearest(path.stem, names(), "Check the path; 'skyknot missions' lists known names.")
    return UserError(
        "The mission file cannot be read.",
        where=str(path),
        found=found,
        expected=f"a TOML file in UTF-8 of at most {LARGEST_FILE} bytes",
        do=close,
    )
