"""`skyknot lint` accepts what is sound and refuses what is broken, in words and by exit status."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from broken_missions import BROKEN, SOUND, Broken
from typer.testing import CliRunner

from skyknot import missions
from skyknot.cli.main import app

RUNNER = CliRunner()


@pytest.mark.parametrize("broken", BROKEN, ids=lambda broken: broken.name)
def test_lint_tells_a_broken_mission_in_five_parts_and_exits_with_2(
    broken: Broken, tmp_path: Path
) -> None:
    path = tmp_path / "broken.toml"
    path.write_text(broken.text, encoding="utf-8")
    result = RUNNER.invoke(app, ["lint", str(path)])
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    for part, label in (
        (broken.what, "error:"),
        (broken.where, "where:"),
        (broken.found, "found:"),
        (broken.expected, "expected:"),
        (broken.do, "do:"),
    ):
        line = next(line for line in result.stderr.splitlines() if line.strip().startswith(label))
        assert part in line
    assert result.stderr.splitlines()[-1].startswith("Not started")


@pytest.mark.parametrize("name", missions.names())
def test_lint_accepts_every_mission_of_the_library(name: str) -> None:
    result = RUNNER.invoke(app, ["lint", name])
    assert result.exit_code == 0, result.stderr
    assert result.stdout.splitlines()[-1].startswith("Sound: '")


def test_lint_says_how_much_time_the_speed_limits_ask_for(tmp_path: Path) -> None:
    path = tmp_path / "sound.toml"
    path.write_text(SOUND, encoding="utf-8")
    result = RUNNER.invoke(app, ["lint", str(path)])
    # two legs of √(15² + 6² + 3²) m, less a tolerance of 1 m each, at 6 m/s
    seconds = 2 * (270**0.5 - 1) / 6
    assert f"at least {seconds:.3g} s are needed" in result.stdout


def test_lint_refuses_an_iteration_limit_that_the_solver_lacks_or_accepts_it(
    tmp_path: Path,
) -> None:
    path = tmp_path / "limited.toml"
    path.write_text(SOUND + '[solver]\nname = "ipopt"\nmax_iterations = 7\n', encoding="utf-8")
    result = RUNNER.invoke(app, ["lint", str(path)])
    assert result.exit_code == 0, result.stderr


def test_lint_answers_in_json(tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_text(BROKEN[1].text, encoding="utf-8")
    result = RUNNER.invoke(app, ["lint", str(path), "--json"])
    answer = json.loads(result.stdout)
    assert result.exit_code == answer["exit_status"] == 2
    assert set(answer["error"]) == {"what", "where", "found", "expected", "do"}
