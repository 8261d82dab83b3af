"""The folder of a run: written beside its place, then renamed, so that it is whole or absent."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from skyknot import missions
from skyknot.cli.exits import finite
from skyknot.cli.trials import tried
from skyknot.errors import UserError
from skyknot.missions import Mission
from skyknot.missions.vehicle_text import vehicle_text
from skyknot.report import Enclosure, save_figures, write_report
from skyknot.solution import Solution
from skyknot.storage import load, write_csv
from skyknot.verification import Certificate

RUN_FILE = "run.json"
FORMAT = "skyknot run 1"


def check_target(folder: Path) -> None:
    """Raise a UserError when the folder holds anything but an earlier run."""
    if not folder.exists():
        return
    if folder.is_dir() and ((folder / RUN_FILE).is_file() or not any(folder.iterdir())):
        return
    raise UserError(
        "The output folder holds something that is not a run of skyknot.",
        where=f"--out {folder}",
        found="a file" if not folder.is_dir() else f"a folder without {RUN_FILE}",
        expected="a folder that does not exist yet, is empty, or holds an earlier run",
        do="Name another folder; skyknot replaces only its own.",
    )


def check_run(folder: Path) -> None:
    """Raise a UserError unless the folder is that of a run."""
    if not (folder / RUN_FILE).is_file():
        raise UserError(
            "This is not the folder of a run.",
            where=str(folder),
            found=f"no {RUN_FILE}" if folder.is_dir() else "no such folder",
            expected="a folder written by 'skyknot solve MISSION --out DIR'",
            do="Check the path, or solve the mission with --out.",
        )


def read_run(folder: Path) -> tuple[Mission, Solution]:
    """Return the mission of a run and its solution, which carries its problem.

    Raises
    ------
    UserError
        When the folder is not that of a run, or damaged.
    """
    check_run(folder)
    mission = missions.load(folder / "mission.toml", vehicle=folder / "vehicle.toml")
    return mission, replace(load(folder / "solution.npz"), problem=mission.problem)


def write_run(
    folder: Path, mission: Mission, solution: Solution, certificate: Certificate | None
) -> Path:
    """Write mission, vehicle, solution, table, certificate and report of a run; return the folder.

    Raises
    ------
    UserError
        When the folder cannot be written; an earlier run there is then untouched.
    """
    check_target(folder)
    replace_folder(folder, lambda part: _fill(part, mission, solution, certificate))
    return folder


def replace_folder(folder: Path, fill: Callable[[Path], None]) -> None:
    """Call ``fill`` on a new folder beside ``folder``, then put it in its place.

    Raises
    ------
    UserError
        When writing fails; what was in ``folder`` before is still there.
    """
    folder = folder.absolute()
    part = folder.with_name(f".{folder.name}.{os.getpid()}.part")
    old = folder.with_name(f".{folder.name}.{os.getpid()}.old")
    try:
        part.mkdir(parents=True)
        fill(part)
        _exchange(part, folder, old)
    except OSError as error:
        raise UserError(
            "The output folder cannot be written.",
            where=str(folder),
            found=f"{type(error).__name__}: {error.strerror}",
            expected="a writable place with enough space",
            do="Choose another --out, or free some space; an earlier run there is untouched.",
        ) from error
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _exchange(part: Path, folder: Path, old: Path) -> None:
    """Put ``part`` where ``folder`` is; on failure put the old folder back."""
    if not folder.exists():
        os.replace(part, folder)
        return
    os.replace(folder, old)
    try:
        os.replace(part, folder)
    except BaseException:
        os.replace(old, folder)
        raise
    shutil.rmtree(old, ignore_errors=True)


def _fill(
    part: Path, mission: Mission, solution: Solution, certificate: Certificate | None
) -> None:
    (part / "mission.toml").write_text(mission.text, encoding="utf-8")
    (part / "vehicle.toml").write_text(vehicle_text(mission.vehicle), encoding="utf-8")
    solution.save(part / "solution.npz")
    outputs = mission.file.outputs
    if outputs.trajectory_csv:
        write_csv(solution, part / "trajectory.csv")
    if certificate is not None:
        _write_json(part / "certificate.json", certificate.as_dict())
    if outputs.report:
        enclosed = Enclosure(
            mission.text,
            vehicle_text(mission.vehicle),
            mission.file.wind,
            tried(solution, mission.settings() | {"solver": solution.record.solver}),
        )
        write_report(solution, part, certificate, mission.title, mission.guess, enclosed)
    if outputs.figures:
        save_figures(solution, part / "figures", mission.guess)
    _write_json(part / RUN_FILE, run_facts(mission, solution))


def run_facts(mission: Mission, solution: Solution) -> dict[str, Any]:
    """Return what is told about a run besides its certificate, as plain data."""
    return {
        "format": FORMAT,
        "mission": mission.name,
        "title": mission.title,
        "vehicle": mission.vehicle.name,
        "status": solution.status.value,
        "success": solution.success,
        "message": solution.message,
        "objective": solution.objective,
        "duration_seconds": solution.trajectory.duration,
        "iterations": solution.iterations,
        "solve_time_seconds": solution.solve_time,
        "kkt_residual": solution.kkt_residual,
        "max_defect": solution.max_defect,
        "record": asdict(solution.record),
    }


def _write_json(path: Path, content: dict[str, Any]) -> None:
    text = json.dumps(finite(content), indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")
