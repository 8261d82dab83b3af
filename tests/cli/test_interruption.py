"""Ctrl-C ends a solve cleanly: exit status 3, a verdict, and an earlier run untouched."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from skyknot.cli import iterations
from skyknot.cli.interruption import Interruption
from skyknot.cli.main import app
from skyknot.missions.mission import FOLDER
from skyknot.solvers.base import IterationRecord

RUNNER = CliRunner()
ENTRY = "from skyknot.cli.main import main; main()"


@pytest.fixture
def endless(tmp_path: Path) -> Path:
    """Return a mission whose solve outlasts the test: many segments, an unreachable tolerance."""
    text = (FOLDER / "minimum_time.toml").read_text(encoding="utf-8")
    text = text.replace("segments = 40", "segments = 300")
    path = tmp_path / "endless.toml"
    path.write_text(text.replace("tolerance = 1e-6", "tolerance = 1e-15"), encoding="utf-8")
    return path


@pytest.fixture
def solving(endless: Path) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-c", ENTRY, "solve", str(endless), "--solver", "ipopt"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        yield process
        process.kill()


def test_ctrl_c_during_a_solve_returns_the_best_iterate(solving: subprocess.Popen[str]) -> None:
    assert solving.stdout is not None
    while not solving.stdout.readline().startswith("iteration"):
        assert solving.poll() is None
    solving.send_signal(signal.SIGINT)
    output, errors = solving.communicate(timeout=60)
    assert solving.returncode == 3
    assert output.splitlines()[-1].startswith("Not solved: Interrupted")
    assert "Traceback" not in errors


def test_an_interrupted_solve_leaves_the_earlier_run_untouched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "run"
    arguments = ["solve", "yaw_point_transfer", "--out", str(folder), "--solver", "ipopt"]
    assert RUNNER.invoke(app, arguments).exit_code == 0
    before = (folder / "run.json").read_bytes()

    def press_ctrl_c(_self: object, record: IterationRecord) -> None:
        if record.iteration == 2:
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(iterations.PlainLines, "show", press_ctrl_c)
    result = RUNNER.invoke(app, arguments)
    assert result.exit_code == 3
    assert "Interrupted" in result.stdout.splitlines()[-1]
    assert (folder / "run.json").read_bytes() == before


def test_ctrl_c_before_a_solve_ends_with_130(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("skyknot.missions.load", interrupted)
    result = RUNNER.invoke(app, ["solve", "yaw_point_transfer"])
    assert result.exit_code == 130
    assert result.stderr.splitlines()[-1].startswith("Interrupted: nothing was written")


def test_the_second_ctrl_c_stops_at_once_and_the_handler_is_put_back() -> None:
    before = signal.getsignal(signal.SIGINT)
    with Interruption() as interruption:
        os.kill(os.getpid(), signal.SIGINT)
        assert interruption.requested
        with pytest.raises(KeyboardInterrupt, match=r"^$"):
            os.kill(os.getpid(), signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is before
