"""Claim: ``skyknot bank`` tells, in words and numbers, which known answers are reached."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from typer.testing import CliRunner

from skyknot.bank import CATALOGUE
from skyknot.cli.main import app


def run(*arguments):
    return CliRunner().invoke(app, ["bank", *arguments])


def test_the_list_tells_every_problem_without_solving():
    told = run("--list")
    assert told.exit_code == 0
    assert all(name in told.output for name in CATALOGUE)
    assert told.output.splitlines()[-1].startswith(f"{len(CATALOGUE)} problems")


def test_two_problems_are_told_with_their_verdict():
    told = run("hager", "minimum-time")
    assert told.exit_code == 0
    assert "1/2 hager: 0.8641645" in told.output
    assert told.output.splitlines()[-1] == "2 of 2 references reached."


def test_json_is_one_object_with_errors_and_switches():
    told = run("minimum-time", "--mesh", "40,10,20", "--json")
    assert told.exit_code == 0
    facts = json.loads(told.output)
    problem, meshes = facts["problems"][0], facts["meshes"][0]
    assert problem["reached"] is True
    assert abs(problem["relative_error"]) < 1e-6
    assert problem["switching_error"] < 1e-3
    assert list(meshes["errors"]) == ["10", "20", "40"]
    assert meshes["order"] == pytest.approx(2, abs=0.1)


def test_the_folder_holds_page_numbers_and_figure(tmp_path):
    told = run("hager", "--out", str(tmp_path / "runs"), "--markdown", str(tmp_path / "bank.md"))
    assert told.exit_code == 0
    assert (tmp_path / "runs" / "errors.png").read_bytes().startswith(b"\x89PNG")
    assert json.loads((tmp_path / "runs" / "bank.json").read_text())["problems"]
    assert (tmp_path / "runs" / "bank.md").read_text() == (tmp_path / "bank.md").read_text()


def test_a_reference_that_is_missed_is_exit_status_3(monkeypatch):
    honest = CATALOGUE["hager"]()
    monkeypatch.setitem(CATALOGUE, "hager", lambda: replace(honest, optimum=0.9))
    told = run("hager")
    assert told.exit_code == 3
    assert told.output.splitlines()[-1] == "0 of 1 references reached; missed: hager."


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["hagar"], "There is no reference problem of this name."),
        (["hager", "--mesh", "10,x"], "The meshes are not numbers of segments."),
        (["hager", "--mesh", "0"], "The meshes are not numbers of segments."),
    ],
)
def test_mistakes_are_told_before_any_solve(arguments, what):
    told = run(*arguments)
    assert told.exit_code == 2
    assert what in told.output
