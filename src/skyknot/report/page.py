"""The one-page report: a single HTML file that needs nothing else, online or off."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Any

from skyknot.report.binding import bindings_of
from skyknot.report.certificate_table import checks_list
from skyknot.report.enclosure import NOTHING, Enclosure
from skyknot.report.figures import illustrated, kinds_read, write_bytes
from skyknot.report.markup import anchor, card, mood, section
from skyknot.report.problem_card import headline_facts, problem_rows, solution_rows
from skyknot.report.reading import Reading
from skyknot.report.replay import replay_element, script_elements, script_hashes
from skyknot.report.reproduction import reproduction
from skyknot.report.vector_image import inline_svg
from skyknot.report.what_binds import binds_section
from skyknot.solution import Solution
from skyknot.status import Status
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
    enclosed: Enclosure = NOTHING,
) -> Path:
    """Write the report and return its path.

    Parameters
    ----------
    solution : solved or not; from ``solve`` or read from a file
    path : an HTML file, or a folder in which ``report.html`` is written
    certificate : of this solution; made here when None and the solution carries its problem
    title : heading; the problem's name when None
    guess : where the search started, for the figure "before and after"
    enclosed : mission file, wind, confirmed prices, companions, where there are any

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
    write_bytes(target, report_page(solution, certificate, title, guess, enclosed).encode())
    return target


def report_page(
    solution: Solution,
    certificate: Any = None,
    title: str | None = None,
    guess: Trajectory | None = None,
    enclosed: Enclosure = NOTHING,
) -> str:
    """Return the report as HTML; parameters as for ``write_report``."""
    reading = Reading(solution, guess)
    heading = title or solution.record.problem
    sections = _sections(reading, certificate, enclosed)
    body = "\n".join(section(name, content) for name, content in sections.items())
    css = "".join(path.read_text(encoding="utf-8") for path in STYLES)
    policy, scripts = LOCKED, ""
    if reading.flies:
        policy, scripts = f"{LOCKED}; script-src {script_hashes()}", script_elements()
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f"<title>{escape(heading)} · skyknot report</title>\n<style>\n{css}</style>\n</head>\n"
        f"<body>\n<main>\n{_head(reading, certificate, heading, tuple(sections))}\n{body}\n"
        f"</main>\n{scripts}</body>\n</html>\n"
    )


def _sections(reading: Reading, certificate: Any, enclosed: Enclosure) -> dict[str, str]:
    """Return the page's sections after the verdict, heading → HTML, in their order."""
    solution = reading.solution
    found: dict[str, str] = {}
    if solution.problem is not None:
        found["The problem"] = card(problem_rows(reading))
    found["The solution"] = card(solution_rows(reading))
    if certificate is not None:
        found["The certificate"] = checks_list(certificate)
    if reading.flies:
        companions = [Reading(other) for other in enclosed.companions]
        found["The flight"] = replay_element([reading, *companions], enclosed.wind)
    found["Figures"] = _figures(reading)
    if solution.problem is not None and solution.success and solution.witness is not None:
        prices = enclosed.prices
        if prices is None:
            prices = [(binding, None) for binding in bindings_of(solution)]
        found["What binds"] = binds_section(reading, prices)
    found["How to reproduce"] = reproduction(solution, enclosed)
    return found


def verdict(solution: Solution, certificate: Any) -> tuple[bool, str]:
    """Return whether all is well, and the sentence that says so."""
    if certificate is None:
        return solution.success, f"{solution.message} It has not been checked independently."
    finding = certificate.sentence.split(": ", 1)[-1]
    if solution.status is Status.INACCURATE:
        return False, f"Solved, not as accurately as asked: {solution.record.detail} {finding}"
    if not solution.success:
        return False, f"Not solved: {solution.status.value}. {solution.status.sentence} {finding}"
    if certificate.passed:
        return True, f"Solved and certified: {finding}"
    return False, f"Solved, but not certified: {finding}"


def _head(reading: Reading, certificate: Any, heading: str, sections: tuple[str, ...]) -> str:
    well, sentence = verdict(reading.solution, certificate)
    facts = "".join(
        f"<div><dt>{escape(label)}</dt><dd>{escape(value)}</dd></div>"
        for label, value in headline_facts(reading)
    )
    links = " ".join(f'<a href="#{anchor(name)}">{escape(name)}</a>' for name in sections)
    return (
        f'<header>\n<p class="eyebrow">skyknot report</p>\n<h1>{escape(heading)}</h1>\n'
        f'<p class="verdict {mood(well)}">{escape(sentence)}</p>\n'
        f'<dl class="facts">{facts}</dl>\n<nav aria-label="Sections">{links}</nav>\n</header>'
    )


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
