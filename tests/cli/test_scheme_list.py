"""Claim: ``skyknot schemes`` lists every scheme as its table tells it, and draws its region."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from skyknot.cli.main import app
from skyknot.transcription import DOORS
from skyknot.transcription.schemes import SCHEMES

RUNNER = CliRunner()


def run(*arguments: str) -> Any:
    return RUNNER.invoke(app, ["schemes", *arguments])


def test_the_list_names_every_scheme_with_order_stability_and_source() -> None:
    listed = json.loads(run("--json").stdout)["schemes"]
    assert [entry["scheme"] for entry in listed] == list(DOORS)
    for entry in listed:
        table = SCHEMES[entry["scheme"]]
        assert entry["order"] == table.orders[table.default_controls].states
        assert entry["A-stable"] == (entry["scheme"] != "euler")
        assert entry["L-stable"] == (entry["scheme"] == "radau")
        assert entry["source"] == table.source
    told = run().stdout
    assert all(name in told for name in DOORS)
    assert told.splitlines()[-1].startswith(f"{len(DOORS)} schemes; ")


def test_one_scheme_is_told_in_full() -> None:
    told = run("radau", "--points", "2").stdout
    assert "R(z) = (1 +0.333333 z) / (1 -0.666667 z +0.166667 z^2)" in told
    assert "linear control: states 3, controls 2, costates 3" in told
    assert told.splitlines()[-1] == "Radau, 2 points: order 3, A-stable and L-stable."
    assert run("euler").stdout.splitlines()[-1] == "explicit Euler: order 1, not A-stable."


@pytest.mark.parametrize(
    ("suffix", "magic"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")]
)
def test_the_region_is_drawn_in_the_format_asked(suffix: str, magic: bytes, tmp_path: Path) -> None:
    path = tmp_path / "pictures" / f"region.{suffix}"
    result = run("chebyshev", "--points", "6", "--plot", str(path))
    assert result.exit_code == 0
    assert path.read_bytes().startswith(magic)
    assert str(path) in result.stdout


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (("simpson",), "no scheme of this name"),
        (("euler", "--points", "3"), "its own number of points"),
        (("lobatto", "--points", "1"), "cannot have this number of points"),
        (("--points", "3"), "belongs to one scheme"),
        (("lobatto", "--plot", "region.jpeg"), "cannot be written in this format"),
    ],
)
def test_mistakes_are_told(words: tuple[str, ...], what: str) -> None:
    result = run(*words)
    assert result.exit_code == 2
    assert what in result.stderr
