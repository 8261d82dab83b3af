"""The section "The certificate": every check with its value, limit and margin."""

from __future__ import annotations

from html import escape
from typing import Any

from skyknot.report.markup import mood


def checks_list(certificate: Any) -> str:
    """Return the checks as HTML, whatever checks a certificate has."""
    entries = "\n".join(_check(check) for check in certificate.checks.values())
    return f'<ul class="checks">\n{entries}\n</ul>'


def _check(check: Any) -> str:
    if getattr(check, "information", False):
        return _information(check)
    share = min(1.0, check.load)
    measured = f"{_quantity(check.value, check.unit)}, limit {_quantity(check.limit, check.unit)}"
    worst = f"{check.worst}: " if check.worst else ""
    mark, word = ("✓", "passed") if check.passed else ("✗", "failed")
    return (
        f'<li class="{mood(check.passed)}"><span class="mark" title="{word}">{mark}</span>'
        f'<div>{escape(check.name)}<span class="how">{escape(check.how)}</span></div>'
        f'<div class="measured">{escape(measured)}'
        f'<span class="load">{escape(worst + margin(check.load))}</span>'
        f'<meter-bar><i style="width: {100 * share:.3g}%"></i></meter-bar></div></li>'
    )


def _information(check: Any) -> str:
    """Return a check that only tells something: no mark, no margin."""
    return (
        '<li><span class="mark" title="for information">·</span>'
        f'<div>{escape(check.name)}<span class="how">{escape(check.how)}</span></div>'
        f'<div class="measured">{escape(_quantity(check.value, check.unit))}'
        f'<span class="load">{escape(check.worst)}</span></div></li>'
    )


def _quantity(value: float, unit: str) -> str:
    return f"{value:.3g} {unit}".rstrip().replace("-", "−")


def margin(load: float) -> str:
    """Return in words how much of a limit is used."""
    if load == 0:
        return "nothing in excess"
    if load < 1e-3:
        return "under 0.1 % of the limit"
    if load <= 1:
        return f"{100 * load:.2g} % of the limit"
    return "not finite" if load == float("inf") else f"{load:.3g} times the limit"
