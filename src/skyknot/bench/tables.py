"""Measurements as tables: on a terminal and in Markdown, from the same rows."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.table import Table

from skyknot.bench.measurement import Contest, Timing
from skyknot.bench.suite import Results

Rows = list[list[str]]

CAPTION = (
    "Warm: same process, solver object built, solved again from the same cold guess; medians by the"
    " clock, in turns. Own: Prepared(program).solve, Python wrapper included, without recovering"
    " costates and interpolant. Peers: the call of CasADi's solver object. Ratio: time of the peer"
    " over own; below 1 own is slower. Fatrop solves another program: multiple shooting with RK4."
)


def mission_rows(contests: Sequence[Contest]) -> tuple[list[str], Rows]:
    """Return head and rows: one row for each mission and contestant."""
    head = [
        "mission",
        "N",
        "solver",
        "build s",
        "warm ms",
        "iterations",
        "ms/it.",
        "rounds",
        "ratio",
    ]
    rows = [
        [
            contest.mission,
            str(contest.segments),
            timing.name,
            number(timing.build),
            number(1e3 * timing.median) if timing.answer else "",
            _ending(timing),
            number(1e3 * timing.per_iteration),
            str(len(timing.wall)),
            "" if timing.name == "own" else number(contest.ratio(timing.name)),
        ]
        for contest in contests
        for timing in contest.timings.values()
    ]
    return head, rows


def growth_rows(results: Results) -> tuple[list[str], Rows]:
    """Return head and rows: one row for each number of segments, the slopes last."""
    names = list(results.growth[0].timings) if results.growth else []
    head = ["N", *(f"{name} {what}" for name in names for what in ("ms", "ms/it.", "it."))]
    rows = [
        [str(contest.segments), *(cell for name in names for cell in _three(contest.timings[name]))]
        for contest in results.growth
    ]
    slopes = results.slopes()
    fitted = [
        cell
        for name in names
        for cell in (number(slopes[name]["time"]), number(slopes[name]["time_per_iteration"]), "")
    ]
    return head, [*rows, ["exponent of N", *fitted]]


def cold_rows(results: Results) -> tuple[list[str], Rows]:
    """Return head and rows of the cold starts."""
    own = results.cold.get("own", math.nan)
    rows = [[name, number(t), number(t / own)] for name, t in results.cold.items()]
    return ["new process: import, build, solve", "s", "ratio"], rows


def number(value: float) -> str:
    """Return three digits, or a dash for what is not known."""
    if not math.isfinite(value):
        return "–"
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def on_terminal(title: str, head: list[str], rows: Rows) -> Table:
    """Return a table for a terminal."""
    table = Table(title=title, title_justify="left", box=None, pad_edge=False)
    for i, name in enumerate(head):
        table.add_column(name, justify="left" if i == 0 else "right")
    for row in rows:
        table.add_row(*row)
    return table


def in_markdown(title: str, head: list[str], rows: Rows) -> str:
    """Return a table in Markdown under its title."""
    lines = [f"## {title}", "", _line(head), _line(["---"] * len(head)), *map(_line, rows), ""]
    return "\n".join(lines)


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _ending(timing: Timing) -> str:
    if timing.answer is None:
        return timing.refusal or "not built"
    count = str(timing.answer.iterations)
    return count if timing.answer.success else f"{count}, not solved"


def _three(timing: Timing) -> tuple[str, str, str]:
    return number(1e3 * timing.median), number(1e3 * timing.per_iteration), _ending(timing)
