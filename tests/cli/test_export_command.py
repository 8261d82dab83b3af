"""Claim: skyknot export writes what is certified, refuses the rest, and says which is which."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from cli.small_missions import mission_text
from skyknot.cli.main import app
from skyknot.export import FORMATS

RUNNER = CliRunner()


def export(*words: object):
    return RUNNER.invoke(app, ["export", *(str(word) for word in words)])


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_is_written_into_the_run(name: str, run: Path) -> None:
    result = export(run, "--to", name, *_needed(name))
    assert result.exit_code == 0, result.output
    told = result.stdout.splitlines()[-1]
    assert told.startswith(f"Written to {run / FORMATS[name].file_name}")
    assert told.endswith("Certified.")
    assert (run / FORMATS[name].file_name).stat().st_size > 500


def test_the_file_can_go_elsewhere_at_another_rate(run: Path, tmp_path: Path) -> None:
    path = tmp_path / "new" / "hop.csv"
    result = export(run, "--to", "csv", "--rate", 4, "--frame", "enu", "--out", path, "--json")
    facts = json.loads(result.stdout)
    assert (facts["samples"], facts["path"], facts["exit_status"]) == (41, str(path), 0)
    assert "frame: ENU" in path.read_text(encoding="utf-8")


def test_a_run_that_is_not_certified_is_refused(run: Path) -> None:
    _tamper(run)
    result = export(run, "--to", "csv")
    assert result.exit_code == 4
    assert "This run is not certified" in result.stderr
    assert "--uncertified" in result.stderr
    assert not (run / "flight.csv").exists()
    marked = export(run, "--to", "csv", "--uncertified")
    assert marked.exit_code == 0
    assert "UNCERTIFIED: " in marked.stdout
    assert "# UNCERTIFIED: " in (run / "flight.csv").read_text(encoding="utf-8")


def test_json_tells_a_refusal_too(run: Path) -> None:
    _tamper(run)
    result = export(run, "--to", "csv", "--json")
    facts = json.loads(result.stdout)
    assert (result.exit_code, facts["exit_status"]) == (4, 4)
    assert set(facts["error"]) == {"what", "where", "found", "expected", "do"}


def test_a_run_that_is_not_solved_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "limited.toml"
    path.write_text(
        mission_text("report_transfer").replace("[solver]", "[solver]\nmax_iterations = 2"),
        encoding="utf-8",
    )
    folder = tmp_path / "run"
    assert RUNNER.invoke(app, ["solve", str(path), "--out", str(folder)]).exit_code == 3
    result = export(folder, "--to", "csv")
    assert result.exit_code == 3
    assert "not solved" in result.stderr


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (("--to", "pdf"), "no such export format"),
        (("--to", "csv", "--frame", "body"), "cannot be written in this frame"),
        (("--to", "csv", "--rate", "-1"), "rate cannot be sampled"),
        (("--to", "csv", "--origin", "here"), "origin cannot be read"),
    ],
)
def test_mistakes_are_told_in_five_parts(words: tuple[str, ...], what: str, run: Path) -> None:
    result = export(run, *words)
    assert result.exit_code == 2
    assert what in result.stderr
    assert "do:" in result.stderr


def test_the_origin_of_the_mission_is_used_unless_another_is_given(tmp_path: Path) -> None:
    text = mission_text("yaw_point_transfer")
    place = "[origin]\nlatitude = 37.2\nlongitude = -80.4\naltitude = 630.0\n\n[start]"
    path = tmp_path / "placed.toml"
    path.write_text(text.replace("[start]", place), encoding="utf-8")
    run = tmp_path / "run"
    assert RUNNER.invoke(app, ["solve", str(path), "--out", str(run)]).exit_code == 0

    def home(*words: str) -> list[float]:
        assert export(run, "--to", "plan", *words).exit_code == 0
        plan = json.loads((run / "flight.plan").read_text(encoding="utf-8"))
        return plan["mission"]["plannedHomePosition"]

    assert home() == [37.2, -80.4, 630.0]
    assert home("--origin", "1,2,3") == [1.0, 2.0, 3.0]


def test_a_run_without_an_origin_is_told_what_to_do(run: Path) -> None:
    result = export(run, "--to", "kml")
    assert result.exit_code == 2
    assert "needs a place on Earth" in result.stderr
    assert "--origin LAT,LON,ALT" in result.stderr
    assert "[origin]" in result.stderr


def test_what_is_no_run_is_refused(tmp_path: Path) -> None:
    result = export(tmp_path, "--to", "csv")
    assert result.exit_code == 2
    assert "not the folder of a run" in result.stderr


def test_the_help_lists_every_format() -> None:
    told = "".join(RUNNER.invoke(app, ["export", "--help"], env={"COLUMNS": "200"}).stdout.split())
    for name in FORMATS:
        assert f"{name}:" in told


def _needed(name: str) -> list[str]:
    return ["--origin", "37.2,-80.4,630"] if "origin" in FORMATS[name].needs else []


def _tamper(run: Path) -> None:
    with np.load(run / "solution.npz") as stored:
        arrays = {name: stored[name] for name in stored.files}
    arrays["states"][20, 0] += 0.5
    np.savez(run / "solution.npz", **arrays)
