"""The one-page report: a single HTML file that needs nothing else, online or off."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from skyknot.report.figures import illustrated, kinds_read, write_bytes
from skyknot.report.problem_card import (
    Rows,
    headline_facts,
    number,
    problem_rows,
    seconds,
    solution_rows,
)
from skyknot.report.reading import Reading
from skyknot.report.replay import replay_element, script_elements, script_hashes
from skyknot.report.vector_image import inline_svg
from skyknot.solution import Solution
from skyknot.trajectory import Trajectory

FILE_NAME = "report.html"

LOCKED = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
"""What the page may load: nothing from anywhere. Scripts are named by their hash, one by one."""

STYLES = (Path(__file__).with_name("page.css"), Path(__file__).parent / "web" / "replay.css")
"""The page's style sheets."""

WIDE = ("path", "overview")
"""Figures that take the page's whole width."""


def write_report(
    solution: Solution,
    path: str | Path,
    certificate: Any = None,
    title: str | None = None,
    guess: Trajectory | None = None,
    wind: Sequence[float] | None = None,
) -> Path:
    """Write the report and return its path.

    Parameters
    ----------
    solution : solved or not; from ``solve`` or read from a file
    path : an HTML file, or a folder in which ``report.html`` is written
    certificate : of this solution; made here when None and the solution carries its problem
    title : heading; the problem's name when None
    guess : where the search started, for the figure "before and after"
    wind : north, east, down, m/s, for the replay

    Raises
    ------
    UserError
        When the file cannot be written.
    """
    target = Path(path)
    if target.suffix.lower() not in (".html", ".htm"):
        target = target / FILE_NAME
    if certificate is None and solution.problem is not None:
        certificate = solution.verify()
    write_bytes(target, report_page(solution, certificate, title, guess, wind).encode())
    return target


def report_page(
    solution: Solution,
    certificate: Any = None,
    title: str | None = None,
    guess: Trajectory | None = None,
    wind: Sequence[float] | None = None,
) -> str:
    """Return the report as HTML; parameters as for ``write_report``."""
    reading = Reading(solution, guess)
    heading = title or solution.record.problem
    sections = [
        _head(reading, certificate, heading),
        _section("The problem", _card(problem_rows(reading))) if solution.problem else "",
        _section("The solution", _card(solution_rows(reading))),
        _section("The certificate", _checks(certificate)) if certificate is not None else "",
        _section("The flight", replay_element([reading], wind)) if reading.flies else "",
        _section("Figures", _figures(reading)),
        _section("How to reproduce", _reproduce(solution)),
    ]
    css = "".join(path.read_text(encoding="utf-8") for path in STYLES)
    body = "\n".join(section for section in sections if section)
    policy, scripts = LOCKED, ""
    if reading.flies:
        policy, scripts = f"{LOCKED}; script-src {script_hashes()}", script_elements()
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f"<title>{escape(heading)} · skyknot report</title>\n<style>\n{css}</style>\n</head>\n"
        f"<body>\n<main>\n{body}\n</main>\n{scripts}</body>\n</html>\n"
    )


def verdict(solution: Solution, certificate: Any) -> tuple[bool, str]:
    """Return whether all is well, and the sentence that says so."""
    if certificate is None:
        return solution.success, f"{solution.message} It has not been checked independently."
    finding = certificate.sentence.split(": ", 1)[-1]
    if not solution.success:
        return False, f"Not solved: {solution.status.value}. {solution.status.sentence} {finding}"
    if certificate.passed:
        return True, f"Solved and certified: {finding}"
    return False, f"Solved, but not certified: {finding}"


def _head(reading: Reading, certificate: Any, heading: str) -> str:
    well, sentence = verdict(reading.solution, certificate)
    facts = "".join(
        f"<div><dt>{escape(label)}</dt><dd>{escape(value)}</dd></div>"
        for label, value in headline_facts(reading)
    )
    return (
        f'<header>\n<p class="eyebrow">skyknot report</p>\n<h1>{escape(heading)}</h1>\n'
        f'<p class="verdict {_mood(well)}">{escape(sentence)}</p>\n'
        f'<dl class="facts">{facts}</dl>\n</header>'
    )


def _section(heading: str, content: str) -> str:
    return f"<section>\n<h2>{escape(heading)}</h2>\n{content}\n</section>"


def _card(rows: Rows) -> str:
    entries = "\n".join(
        f"<div><dt>{escape(label)}</dt><dd>{escape(text)}</dd></div>" for label, text in rows
    )
    return f'<dl class="card">\n{entries}\n</dl>'


def _checks(certificate: Any) -> str:
    entries = "\n".join(_check(check) for check in certificate.checks.values())
    return f'<ul class="checks">\n{entries}\n</ul>'


def _check(check: Any) -> str:
    share = min(1.0, check.load)
    unit = f" {check.unit}" if check.unit else ""
    measured = f"{check.value:.3g}{unit}".replace("-", "−") + f", limit {number(check.limit)}{unit}"
    worst = f"{check.worst}: " if check.worst else ""
    mark, word = ("✓", "passed") if check.passed else ("✗", "failed")
    return (
        f'<li class="{_mood(check.passed)}"><span class="mark" title="{word}">{mark}</span>'
        f'<div>{escape(check.name)}<span class="how">{escape(check.how)}</span></div>'
        f'<div class="measured">{escape(measured)}'
        f'<span class="load">{escape(worst + margin(check.load))}</span>'
        f'<meter-bar><i style="width: {100 * share:.3g}%"></i></meter-bar></div></li>'
    )


def margin(load: float) -> str:
    """Return in words how much of a limit is used."""
    if load == 0:
        return "nothing in excess"
    if load < 1e-3:
        return "under 0.1 % of the limit"
    if load <= 1:
        return f"{100 * load:.2g} % of the limit"
    return "not finite" if load == float("inf") else f"{load:.3g} times the limit"


def _figures(reading: Reading) -> str:
    parts = []
    for kind in kinds_read(reading):
        if kind == "overview":
            continue
        picture = illustrated(reading, kind)
        wide = ' class="wide"' if kind in WIDE else ""
        parts.append(
            f"<figure{wide}>\n<h3>{escape(picture.title)}</h3>\n{inline_svg(picture)}\n"
            f"<figcaption>{escape(picture.caption)}</figcaption>\n</figure>"
        )
    return '<div class="figures">\n' + "\n".join(parts) + "\n</div>"


def _reproduce(solution: Solution) -> str:
    record = solution.record
    versions = ", ".join(f"{name} {version}" for name, version in record.versions.items())
    timings = ", ".join(f"{name} {seconds(value)}" for name, value in record.timings.items())
    work = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in record.work.items())
    rows = [
        ("Versions", versions or "not recorded"),
        ("Inputs, SHA-256", record.inputs_hash or "not recorded"),
        ("Time spent", timings or "not recorded"),
        ("Work done", work or "not recorded"),
    ]
    snippet = (
        "import skyknot as sk\n\n"
        f"# problem: {record.problem!r}; scheme: {record.transcription},"
        f" {record.segments} segments\n"
        f"solution = sk.solve(problem, transcription, solver={record.solver!r},"
        f" tolerance={record.tolerance:g})\n"
        "assert solution.record.inputs_hash == "
        f'"{record.inputs_hash[:16]}…"  # the same finite program\n'
        "print(solution.verify().table())"
    )
    return f"{_card(rows)}\n<pre>{escape(snippet)}</pre>"


def _mood(well: bool) -> str:
    return "good" if well else "bad"
