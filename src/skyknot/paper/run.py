"""All claims in a row: each finding is kept in a file, so that a run can be taken up again."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from skyknot.paper.base import Finding, Scale
from skyknot.paper.claims_page import claims_page
from skyknot.paper.numbered_figures import numbered_figures
from skyknot.paper.registry import EXPERIMENTS
from skyknot.report.figures import rendered, write_bytes
from skyknot.version import __version__

KEPT = "experiments"
"""Folder of the findings kept."""

Progress = Callable[[str, int, int], None]
"""Told before each step: what comes, how many steps are done, how many there are."""


def run_claims(
    directory: Path, scale: Scale | None = None, progress: Progress | None = None
) -> dict[str, Finding]:
    """Run every experiment that is not kept yet; write claims, figures and page; return findings.

    Parameters
    ----------
    directory : made when it does not exist; holds ``claims.json``, ``index.html``, ``figure-*.svg``
        and the findings kept under ``experiments``
    scale : how much work to do; full when None
    progress : see ``Progress``

    Raises
    ------
    UserError
        When the folder cannot be written.
    RuntimeError
        When a solve that a number rests on fails.
    """
    chosen, tell = scale or Scale(), progress or _silent
    total = len(EXPERIMENTS) + 1
    findings = {}
    for done, name in enumerate(EXPERIMENTS):
        tell(name.replace("_", " "), done, total)
        findings[name] = kept_or_run(directory, name, chosen)
    tell("figures and page", len(EXPERIMENTS), total)
    write(directory, findings, chosen)
    tell("done", total, total)
    return findings


def kept_or_run(directory: Path, name: str, scale: Scale) -> Finding:
    """Return the finding kept by an earlier run of the same version and scale, or run it now."""
    path = directory / KEPT / f"{name}.json"
    kept = _read(path)
    same = {"version": __version__, "quick": scale.quick}
    if kept is not None and all(kept.get(key) == value for key, value in same.items()):
        return Finding.from_dict(kept["finding"])
    finding = EXPERIMENTS[name](scale)
    write_bytes(path, _encoded(same | {"finding": finding.as_dict()}))
    return finding


def write(directory: Path, findings: dict[str, Finding], scale: Scale) -> None:
    """Write claims.json, the figures and the page."""
    claims = [finding.as_dict()["claim"] | {"experiment": n} for n, finding in findings.items()]
    told = {"version": __version__, "quick": scale.quick, "claims": claims}
    write_bytes(directory / "claims.json", _encoded(told))
    figures = numbered_figures(findings, scale)
    for picture in figures:
        write_bytes(directory / f"{picture.kind}.svg", rendered(picture.figure, "svg"))
    page = claims_page(findings, figures, scale)
    write_bytes(directory / "index.html", page.encode())


def _read(path: Path) -> dict[str, Any] | None:
    """Return a finding kept, or None when there is none that can be read."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return content if isinstance(content, dict) else None


def _encoded(content: dict[str, Any]) -> bytes:
    return (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode()


def _silent(_step: str, _done: int, _total: int) -> None:
    return None
