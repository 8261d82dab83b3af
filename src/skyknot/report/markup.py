"""Pieces of a page: sections, cards of label and text, escaped."""

from __future__ import annotations

from html import escape

from skyknot.report.problem_card import Rows


def section(heading: str, content: str) -> str:
    """Return a section with its heading; ``content`` is HTML."""
    return f'<section id="{anchor(heading)}">\n<h2>{escape(heading)}</h2>\n{content}\n</section>'


def anchor(heading: str) -> str:
    """Return the name by which a section is linked to."""
    return heading.lower().replace(" ", "-")


def card(rows: Rows) -> str:
    """Return rows of label and text as a list of descriptions."""
    entries = "\n".join(
        f"<div><dt>{escape(label)}</dt><dd>{escape(text)}</dd></div>" for label, text in rows
    )
    return f'<dl class="card">\n{entries}\n</dl>'


def mood(well: bool) -> str:
    """Return the class of what is well, or not."""
    return "good" if well else "bad"


def folded(heading: str, text: str) -> str:
    """Return plain text to unfold under a heading."""
    return f"<details>\n<summary>{escape(heading)}</summary>\n<pre>{escape(text)}</pre>\n</details>"
