"""Shared by the tests of commands that read a run: one small run, solved once."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cli.small_missions import mission_text
from skyknot.cli.main import app


@pytest.fixture(scope="session")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that nobody changes."""
    folder = tmp_path_factory.mktemp("runs")
    path = folder / "transfer.toml"
    path.write_text(mission_text("yaw_point_transfer"), encoding="utf-8")
    run = folder / "transfer"
    assert CliRunner().invoke(app, ["solve", str(path), "--out", str(run)]).exit_code == 0
    return run


@pytest.fixture
def run(kept: Path, tmp_path: Path) -> Path:
    """A copy of it for one test."""
    return Path(shutil.copytree(kept, tmp_path / "transfer"))
