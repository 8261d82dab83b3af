"""Claim: the live page is served until Ctrl-C, and says what it needs when it cannot be."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from urllib.request import urlopen

import pytest

import skyknot as sk
from skyknot.live import live_page

COMMAND = "from skyknot.cli.main import main; main()"


def test_the_page_is_served_until_interrupted():
    pytest.importorskip("viser", reason="needs the extra 'live'")
    words = [
        sys.executable,
        "-c",
        COMMAND,
        "live",
        "report_transfer",
        "--port",
        "8951",
        "--no-open",
    ]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        try:
            lines = [run.stdout.readline() for _ in range(2)]
            (address,) = re.findall(r"The page is at (http://127\.0\.0\.1:\d+) ", lines[1])
            with urlopen(address, timeout=30) as answer:
                assert b"<html" in answer.read().lower()
            run.send_signal(signal.SIGINT)
            rest, complaints = run.communicate(timeout=60)
        finally:
            run.kill()
    assert run.returncode == 0, complaints
    assert rest.splitlines() == ["Stopped."]
    assert "Traceback" not in complaints


def test_a_missing_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(sk.UserError, match="needs a package that is not installed") as caught:
        live_page._viser()
    assert "skyknot[live]" in caught.value.do
    assert all(caught.value.parts().values())
