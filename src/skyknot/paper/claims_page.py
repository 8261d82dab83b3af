"""The page of claims: one HTML file that needs nothing else, in the style of the reports."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

import skyknot.report.page as report_page
from skyknot.paper.base import CHANGED, FAILS, HOLDS, Claim, Scale
from skyknot.report.figures import Illustration
from skyknot.report.vector_image import inline_svg

SOURCE = (
    "V. P. Gautam and S. Nerella, Numerical Optimal Control of a UAM Vehicle using Hermite-Simpson"
    " Collocation, AOE 5404 final report, Virginia Tech"
)
MARKS = {HOLDS: ("✓", "good"), CHANGED: ("~", "changed"), FAILS: ("✗", "bad")}
"""Mark and mood of each verdict."""

EXTRA = """
.changed .mark, .changed .load { color: var(--muted); }
.said { display: block; font-style: italic; margin: .15rem 0; }
.measured ul { margin: .2rem 0 0; padding-left: 1.1rem; font-size: .86rem; }
.checks.claims li { grid-template-columns: 1.6rem minmax(0, 1fr) minmax(15rem, 26rem); }
@media (max-width: 640px) { .checks.claims li { grid-template-columns: 1.4rem 1fr; } }
"""


def claims_page(claims: Sequence[Claim], figures: Sequence[Illustration], scale: Scale) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    claims : in the order of the page
    figures : with captions
    scale : of the run, told in the heading
    """
    css = Path(report_page.__file__).with_name("page.css").read_text(encoding="utf-8") + EXTRA
    rows = "\n".join(_row(claim) for claim in claims)
    pictures = "\n".join(_picture(figure) for figure in figures)
    size = "quick run, small sizes" if scale.quick else "full run"
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{report_page.LOCKED}">\n'
        f"<title>The source report, claim by claim · skyknot</title>\n<style>\n{css}</style>\n"
        f'</head>\n<body>\n<main>\n<header>\n<p class="eyebrow">skyknot paper, {size}</p>\n'
        f'<h1>The source report, claim by claim</h1>\n<p class="verdict good">'
        f"{escape(summary(claims))}</p>\n<p>{escape(SOURCE)}.</p>\n</header>\n"
        f'<section>\n<h2>Claims</h2>\n<ul class="checks claims">\n{rows}\n</ul>\n</section>\n'
        f'<section>\n<h2>Figures</h2>\n<div class="figures">\n{pictures}\n</div>\n</section>\n'
        "</main>\n</body>\n</html>\n"
    )


def summary(claims: Sequence[Claim]) -> str:
    """Return how many claims hold, in one sentence."""
    count = {word: sum(claim.verdict == word for claim in claims) for word in MARKS}
    return (
        f"{len(claims)} claims run: {count[HOLDS]} hold, {count[CHANGED]} hold with a change,"
        f" {count[FAILS]} do not hold."
    )


def _row(claim: Claim) -> str:
    mark, mood = MARKS[claim.verdict]
    numbers = "".join(f"<li>{escape(measure.text)}</li>" for measure in claim.measured)
    return (
        f'<li class="{mood}"><span class="mark" title="{claim.verdict}">{mark}</span>'
        f"<div><strong>{escape(claim.claim)}</strong> (section {escape(claim.section)})"
        f'<span class="said">“{escape(claim.said)}”</span>{escape(claim.why)}'
        f'<span class="how">{escape(claim.how)}</span></div>'
        f'<div class="measured"><span class="load">{claim.verdict}</span>'
        f"<ul>{numbers}</ul></div></li>"
    )


def _picture(picture: Illustration) -> str:
    return (
        f"<figure>\n<h3>{escape(picture.title)}</h3>\n{inline_svg(picture)}\n"
        f"<figcaption>{escape(picture.caption)}</figcaption>\n</figure>"
    )
