"""A run's folder is whole or absent, never half written, and can be verified from its files."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from skyknot import missions
from skyknot.cli import run_folder
from skyknot.cli.main import app
from skyknot.missions import vehicles
from skyknot.missions.mission import FOLDER

RUNNER = CliRunner()
FILES = {
    "mission.toml",
    "vehicle.toml",
    "solution.npz",
    "trajectory.csv",
    "certificate.json",
    "report.html",
    "run.json",
}


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "transfer"
    result = RUNNER.invoke(app, ["solve", "yaw_point_transfer", "--out", str(folder)])
    assert result.exit_code == 0, result.output
    return folder


@pytest.fixture
def run(kept: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(kept, tmp_path / "transfer"))


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def solve_into(folder: Path, *more: str) -> int:
    return RUNNER.invoke(
        app, ["solve", "yaw_point_transfer", "--out", str(folder), *more]
    ).exit_code


def test_the_line_before_the_verdict_says_where_to_look(tmp_path: Path) -> None:
    folder = tmp_path / "seen"
    result = RUNNER.invoke(app, ["solve", "yaw_point_transfer", "--out", str(folder)])
    told = "".join(result.stdout.splitlines()[-3:-1])
    assert f"look at {folder / 'report.html'}" in told


def test_a_run_holds_everything(run: Path) -> None:
    assert set(contents(run)) == FILES
    facts = json.loads((run / "run.json").read_text(encoding="utf-8"))
    assert facts["success"] is True
    assert facts["mission"] == "yaw_point_transfer"
    original = (FOLDER / "yaw_point_transfer.toml").read_text(encoding="utf-8")
    assert (run / "mission.toml").read_text(encoding="utf-8") == original


def test_a_run_leaves_nothing_beside_its_folder(run: Path) -> None:
    assert solve_into(run) == 0
    assert [path.name for path in run.parent.iterdir()] == [run.name]


def test_a_run_is_verified_from_its_files_alone(run: Path) -> None:
    result = RUNNER.invoke(app, ["verify", str(run)])
    assert result.exit_code == 0
    assert result.stdout.splitlines()[-1].startswith("Certified: ")


def test_a_run_with_a_vehicle_file_carries_the_vehicle(tmp_path: Path) -> None:
    craft = (vehicles.FOLDER / "report.toml").read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(craft.replace("value = 1.2,", "value = 1.1,", 1), "utf-8")
    text = (FOLDER / "yaw_point_transfer.toml").read_text(encoding="utf-8")
    path = tmp_path / "hop.toml"
    path.write_text(text.replace('vehicle = "report"', 'vehicle = "mine.toml"'), encoding="utf-8")
    folder = tmp_path / "elsewhere" / "run"
    assert RUNNER.invoke(app, ["solve", str(path), "--out", str(folder)]).exit_code == 0
    (tmp_path / "mine.toml").unlink()
    assert RUNNER.invoke(app, ["verify", str(folder)]).exit_code == 0
    rebuilt = missions.load(folder / "mission.toml", vehicle=folder / "vehicle.toml")
    assert rebuilt.vehicle.mass == 1.1


def test_a_tampered_trajectory_is_not_certified(run: Path) -> None:
    with np.load(run / "solution.npz") as stored:
        arrays = {name: stored[name] for name in stored.files}
    arrays["states"][20, 0] += 0.5
    np.savez(run / "solution.npz", **arrays)
    result = RUNNER.invoke(app, ["verify", str(run)])
    assert result.exit_code == 4
    assert result.stdout.splitlines()[-1].startswith("Not certified: ")


def test_a_damaged_solution_is_a_user_error(run: Path) -> None:
    (run / "solution.npz").write_bytes(b"PK\x03\x04 damaged")
    result = RUNNER.invoke(app, ["verify", str(run)])
    assert result.exit_code == 2
    assert "not a readable skyknot solution" in result.stderr


def test_a_full_disk_leaves_the_earlier_run_untouched(
    run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_arguments: object, **_options: object) -> None:
        raise OSError(28, "No space left on device")

    before = contents(run)
    monkeypatch.setattr(run_folder, "write_report", full)
    result = RUNNER.invoke(app, ["solve", "yaw_point_transfer", "--out", str(run)])
    assert result.exit_code == 2
    assert "No space left on device" in result.stderr
    assert contents(run) == before
    assert [path.name for path in run.parent.iterdir()] == [run.name]


def test_a_full_verification_solves_again(kept: Path) -> None:
    result = RUNNER.invoke(app, ["verify", str(kept), "--full", "--json"])
    assert result.exit_code == 0, result.output
    full = json.loads(result.stdout)["checks"]
    known = json.loads((kept / "certificate.json").read_text(encoding="utf-8"))["checks"]
    assert set(full) - set(known) == {"mesh convergence", "sensitivity", "second solver"}


def test_a_failing_rename_puts_the_earlier_run_back(
    run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rename = os.replace

    def refuse(source: Path, target: Path) -> None:
        if str(source).endswith(".part") and Path(target) == run:
            raise OSError(5, "Input/output error")
        rename(source, target)

    before = contents(run)
    monkeypatch.setattr(run_folder.os, "replace", refuse)
    assert solve_into(run) == 2
    assert contents(run) == before
    assert [path.name for path in run.parent.iterdir()] == [run.name]


def test_an_interruption_while_writing_leaves_the_earlier_run_untouched(
    run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_arguments: object, **_options: object) -> None:
        raise KeyboardInterrupt

    before = contents(run)
    monkeypatch.setattr(run_folder, "write_csv", interrupt)
    assert solve_into(run) == 130
    assert contents(run) == before
    assert [path.name for path in run.parent.iterdir()] == [run.name]


@pytest.mark.parametrize("kind", ["folder", "file"])
def test_what_is_not_a_run_is_never_replaced(kind: str, tmp_path: Path) -> None:
    target = tmp_path / "precious"
    if kind == "folder":
        target.mkdir()
        (target / "diary.txt").write_text("dear diary", encoding="utf-8")
    else:
        target.write_text("dear diary", encoding="utf-8")
    result = RUNNER.invoke(app, ["solve", "yaw_point_transfer", "--out", str(target)])
    assert result.exit_code == 2
    assert "not a run of skyknot" in result.stderr
    diary = target / "diary.txt" if kind == "folder" else target
    assert diary.read_text(encoding="utf-8") == "dear diary"


def test_an_unsolved_run_is_written_without_a_certificate(tmp_path: Path) -> None:
    text = (FOLDER / "report_transfer.toml").read_text(encoding="utf-8")
    path = tmp_path / "limited.toml"
    path.write_text(text.replace("[solver]", "[solver]\nmax_iterations = 2"), encoding="utf-8")
    folder = tmp_path / "run"
    assert RUNNER.invoke(app, ["solve", str(path), "--out", str(folder)]).exit_code == 3
    assert "certificate.json" not in contents(folder)
    assert json.loads((folder / "run.json").read_text(encoding="utf-8"))["success"] is False
