"""The page of claims: one HTML file that needs nothing else, in the style of the reports."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

import skyknot.report.page as report_page
from skyknot.paper.base import CHANGED, FAILS, HOLDS, Claim, Finding, Scale
from skyknot.paper.stories import Story, stories
from skyknot.report.figures import Illustration
from skyknot.report.vector_image import inline_svg

SOURCE = (
    "V. P. Gautam and S. Nerella, Numerical Optimal Control of a UAM Vehicle using Hermite-Simpson"
    " Collocation, AOE 5404 final report, Virginia Tech"
)
MARKS = {HOLDS: ("✓", "good"), CHANGED: ("~", "changed"), FAILS: ("✗", "bad")}
"""Mark and mood of each verdict."""

CSS = Path(__file__).with_name("claims.css")


def claims_page(findings: dict[str, Finding], figures: Sequence[Illustration], scale: Scale) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    findings : by the name of their experiment, in the order of the page
    figures : with captions, named ``figure-01`` and so on
    scale : of the run, told in the heading
    """
    claims = [finding.claim for finding in findings.values()]
    report_css = Path(report_page.__file__).with_name("page.css").read_text(encoding="utf-8")
    css = report_css + CSS.read_text(encoding="utf-8")
    chapters = stories(findings)
    placed = {number for story in chapters for number in story.figures}
    drawn = {int(figure.kind.rpartition("-")[2]): figure for figure in figures}
    told = "\n".join(_story(story, drawn) for story in chapters)
    rest = _pictures([drawn[number] for number in sorted(set(drawn) - placed)])
    size = "quick run, small sizes" if scale.quick else "full run"
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{report_page.LOCKED}">\n'
        f"<title>The source report, claim by claim · skyknot</title>\n<style>\n{css}</style>\n"
        f'</head>\n<body>\n<main>\n<header>\n<p class="eyebrow">skyknot paper, {size}</p>\n'
        f"<h1>The source report, claim by claim</h1>\n<p>{escape(SOURCE)}. Every number below was"
        " measured in this run.</p>\n"
        f"{_tally(claims)}\n{_overview(claims)}\n</header>\n{told}\n"
        f"<section>\n<h2>The claims</h2>\n{_rows(claims)}\n</section>\n"
        f"<section>\n<h2>The other figures</h2>\n{rest}\n</section>\n"
        "</main>\n</body>\n</html>\n"
    )


def summary(claims: Sequence[Claim]) -> str:
    """Return how many claims hold, in one sentence."""
    count = {word: sum(claim.verdict == word for claim in claims) for word in MARKS}
    return (
        f"{len(claims)} claims run: {count[HOLDS]} hold, {count[CHANGED]} hold with a change,"
        f" {count[FAILS]} do not hold."
    )


def _tally(claims: Sequence[Claim]) -> str:
    cells = "".join(
        f'<div class="{mood}"><dt><span class="mark">{mark}</span> {word}</dt>'
        f"<dd>{sum(claim.verdict == word for claim in claims)}</dd></div>"
        for word, (mark, mood) in MARKS.items()
    )
    return f'<dl class="facts">{cells}</dl>'


def _overview(claims: Sequence[Claim]) -> str:
    """Return the claims in a line each, as links."""
    lines = "".join(
        f'<li class="{MARKS[claim.verdict][1]}"><a href="#claim-{i}">'
        f'<span class="mark" title="{claim.verdict}">{MARKS[claim.verdict][0]}</span>'
        f" {escape(claim.claim)}</a></li>"
        for i, claim in enumerate(claims, 1)
    )
    return f'<ol class="overview">{lines}</ol>'


def _story(story: Story, drawn: dict[int, Illustration]) -> str:
    words = "\n".join(f"<p>{escape(paragraph)}</p>" for paragraph in story.paragraphs)
    pictures = _pictures([drawn[number] for number in story.figures if number in drawn])
    return (
        f'<section class="story">\n<h2>{escape(story.title)}</h2>\n{words}\n{_table(story.table)}\n'
        f"{pictures}\n</section>"
    )


def _table(rows: tuple[tuple[str, ...], ...]) -> str:
    if not rows:
        return ""
    head = "".join(f"<th>{escape(cell)}</th>" for cell in rows[0])
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows[1:]
    )
    return (
        f'<div class="scroll"><table class="numbers"><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def _rows(claims: Sequence[Claim]) -> str:
    return "\n".join(_row(i, claim) for i, claim in enumerate(claims, 1))


def _row(i: int, claim: Claim) -> str:
    mark, mood = MARKS[claim.verdict]
    numbers = "".join(
        f"<tr><td>{escape(measure.name)}</td><td>{escape(measure.number)}</td></tr>"
        for measure in claim.measured
    )
    return (
        f'<article class="claim {mood}" id="claim-{i}">\n<h3><span class="mark">{mark}</span>'
        f" {escape(claim.claim)} <small>section {escape(claim.section)}</small>"
        f'<span class="badge">{claim.verdict}</span></h3>\n<div class="sides">\n<div>'
        f'<p class="said">“{escape(claim.said)}”</p><p>{escape(claim.why)}</p>'
        f'<p class="how">{escape(claim.how)}</p></div>\n'
        f"<table>{numbers}</table>\n</div>\n</article>"
    )


def _pictures(figures: Sequence[Illustration]) -> str:
    return '<div class="figures">\n' + "\n".join(_picture(f) for f in figures) + "\n</div>"


def _picture(picture: Illustration) -> str:
    return (
        f'<figure id="{picture.kind}">\n<h3>{escape(picture.title)}</h3>\n{inline_svg(picture)}\n'
        f"<figcaption>{escape(picture.caption)}</figcaption>\n</figure>"
    )
