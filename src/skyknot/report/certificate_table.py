"""The section "The certificate": every check with its value, limit and margin."""

from __future__ import annotations

from html import escape
from typing import Any

from skyknot.report.markup import mood
from skyknot.report.problem_card import number


def checks_list(certificate: Any) -> str:
    """Return the checks as HTML, whatever checks a certificate has."""
    entries = "\n".join(_check(check) for check in certificate.checks.values())
    return f'<ul class="checks">\n{entries}\n</ul>'


def _check(check: Any) -> str:
    share = min(1.0, check.load)
    unit = f" {check.unit}" if check.unit else ""
    measured = f"{check.value:.3g}{unit}".replace("-", "−") + f", limit {number(check.limit)}{unit}"
    worst = f"{check.worst}: " if check.worst else ""
    mark, word = ("✓", "passed") if check.passed else ("✗", "failed")
    return (
        f'<li class="{mood(check.passed)}"><span class="mark" title="{word}">{mark}</span>'
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
