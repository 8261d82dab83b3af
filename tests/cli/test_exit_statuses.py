"""The exit status says how it went: 0 certified, 2 user error, 3 not solved, 4 not certified."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import skyknot as sk
from skyknot import missions
from skyknot.cli.main import app
from skyknot.cli.solving import certified, exit_of, verdict
from skyknot.missions.mission import FOLDER

RUNNER = CliRunner()
VERDICTS = {
    "yaw_point_transfer": (0, "Solved and certified"),
    "report_transfer": (0, "Solved and certified"),
    "report_transfer --accuracy off": (4, "Solved, not certified"),
}


def run(*arguments: str) -> Any:
    return RUNNER.invoke(app, list(arguments))


@pytest.mark.parametrize("words", VERDICTS)
def test_a_solved_mission_ends_by_its_certificate(words: str) -> None:
    status, verdict = VERDICTS[words]
    result = run("solve", *words.split())
    assert result.exit_code == status
    assert result.stdout.splitlines()[-1].startswith(verdict)


def test_an_accuracy_out_of_reach_ends_with_4_and_says_so() -> None:
    mission = missions.load("yaw_point_transfer")
    settings = mission.settings() | {"accuracy": sk.Refinement(1e-9, rounds=1)}
    solution = sk.solve(mission.problem, **settings)
    certificate = certified(mission, solution)
    assert certificate.passed
    assert exit_of(solution, certificate) == 4
    told = verdict(solution, certificate)
    assert told.startswith("Solved, not as accurately as asked: Accuracy not reached")
    assert "the limit of 1 meshes" in told


def test_the_meshes_of_a_refinement_are_shown() -> None:
    lines = run("solve", "report_transfer").stdout.splitlines()
    head = next(i for i, line in enumerate(lines) if line.split()[:2] == ["mesh", "segments"])
    first, second = lines[head + 1].split(), lines[head + 2].split()
    assert first[:2] == ["1", "40"]
    assert second[0] == "2"
    assert float(second[3]) < float(first[3])


def test_one_mesh_has_no_table_of_meshes() -> None:
    assert "  segments  " not in run("solve", "yaw_point_transfer", "--accuracy", "off").stdout


def test_an_unsolved_mission_ends_with_3_and_says_what_to_try(tmp_path: Path) -> None:
    path = limited(tmp_path)
    result = run("solve", str(path))
    assert result.exit_code == 3
    verdict = result.stdout.splitlines()[-1]
    assert verdict.startswith("Not solved: Iteration limit")
    assert "Raise the iteration limit" in verdict


@pytest.mark.parametrize(
    "arguments",
    [
        ["solve", "no_such_mission"],
        ["solve", "report_transfer", "--solver", "no-such-solver"],
        ["solve", "report_transfer", "--segments", "0"],
        ["solve", "report_transfer", "--tolerance", "-1"],
        ["solve", "report_transfer", "--accuracy", "fine"],
        ["solve", "report_transfer", "--accuracy", "-1e-4"],
        ["solve", "report_transfer", "--accuracy", "1e-30"],
        ["solve", "report_transfer", "--no-such-option"],
        ["solve"],
        ["verify", "no_such_folder"],
        ["no_such_command"],
    ],
    ids=" ".join,
)
def test_a_mistake_on_the_command_line_ends_with_2_and_no_traceback(arguments: list[str]) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert "Traceback" not in result.stderr
    assert result.stderr


def test_json_is_one_object_and_nothing_else() -> None:
    result = run("solve", "yaw_point_transfer", "--json")
    answer = json.loads(result.stdout)
    assert result.stdout.count("\n") == 1
    assert answer["exit_status"] == result.exit_code == 0
    assert answer["status"] == "solved"
    assert answer["certificate"]["passed"] is True
    assert answer["verdict"].startswith("Solved and certified")
    assert answer["record"]["accuracy"] == 1e-4
    assert answer["record"]["rounds"][-1]["segments"] == answer["record"]["segments"]


def test_json_of_an_unsolved_mission_has_no_certificate(tmp_path: Path) -> None:
    result = run("solve", str(limited(tmp_path)), "--json")
    answer = json.loads(result.stdout)
    assert answer["exit_status"] == result.exit_code == 3
    assert answer["success"] is False
    assert answer["certificate"] is None


def test_json_of_a_user_error_carries_its_five_parts() -> None:
    result = run("solve", "no_such_mission", "--json")
    answer = json.loads(result.stdout)
    assert answer["exit_status"] == result.exit_code == 2
    assert set(answer["error"]) == {"what", "where", "found", "expected", "do"}


def test_options_of_the_command_line_replace_those_of_the_mission() -> None:
    result = run(
        *["solve", "yaw_point_transfer", "--segments", "20", "--solver", "ipopt"],
        *["--tolerance", "1e-5", "--accuracy", "1e-3", "--json"],
    )
    record = json.loads(result.stdout)["record"]
    assert (record["solver"], record["tolerance"], record["accuracy"]) == ("ipopt", 1e-5, 1e-3)
    assert record["rounds"][0]["segments"] == 20


def test_verbose_shows_the_time_of_every_phase() -> None:
    result = run("solve", "yaw_point_transfer", "-v")
    for phase in ("transcription", "solver", "recovery"):
        assert any(
            line.split()[:1] == [phase] and line.endswith(" ms")
            for line in result.stdout.splitlines()
        )


def test_plain_output_has_one_line_for_each_iteration() -> None:
    result = run("solve", "yaw_point_transfer")
    lines = [line for line in result.stdout.splitlines() if line.startswith("iteration")]
    answer = json.loads(run("solve", "yaw_point_transfer", "--json").stdout)
    assert len(lines) >= answer["iterations"]
    assert "\x1b" not in result.stdout


def test_the_doctor_finds_this_installation_healthy() -> None:
    result = run("doctor", "--json")
    answer = json.loads(result.stdout)
    assert result.exit_code == 0, answer
    assert [trial["exact"] for trial in answer["trials"]] == [6.0, 4.0]
    assert all(trial["error"] < 1e-5 for trial in answer["trials"])
    assert run("doctor").stdout.splitlines()[-1].startswith("Healthy: ")


def test_the_lists_name_everything_there_is() -> None:
    listed = json.loads(run("missions", "--json").stdout)["missions"]
    assert [entry["name"] for entry in listed] == missions.names()
    told = run("vehicles").stdout
    assert all(name in told for name in missions.vehicles.names())


def test_schema_prints_the_schema() -> None:
    assert json.loads(run("schema").stdout) == missions.json_schema()


@pytest.mark.parametrize(
    "command", ["solve", "lint", "verify", "doctor", "missions", "vehicles", "schemes"]
)
def test_every_command_has_help(command: str) -> None:
    result = run(command, "--help")
    assert result.exit_code == 0
    assert "Usage:" in result.stdout


@pytest.mark.parametrize("command", ["solve", "lint", "verify", "missions", "schema"])
def test_help_teaches_by_example(command: str) -> None:
    assert f"skyknot {command}" in run(command, "--help").stdout.replace(
        "skyknot solve city_hop\n", "skyknot missions"
    )


def limited(folder: Path) -> Path:
    """Return a mission that is stopped after two iterations."""
    text = (FOLDER / "report_transfer.toml").read_text(encoding="utf-8")
    path = folder / "limited.toml"
    path.write_text(text.replace("[solver]", "[solver]\nmax_iterations = 2"), encoding="utf-8")
    return path
