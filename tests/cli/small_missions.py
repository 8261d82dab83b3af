"""Library missions that are quick to run."""

from __future__ import annotations

from skyknot.missions.mission import FOLDER


def mission_text(name: str) -> str:
    """Return a library mission that writes no report, which these tests do not look at."""
    text = (FOLDER / f"{name}.toml").read_text(encoding="utf-8")
    return text + "\n[outputs]\nreport = false\n"
