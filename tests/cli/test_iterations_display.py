"""On a terminal iterations move in a table; elsewhere they are plain lines; for JSON, silence."""

from __future__ import annotations

from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from skyknot.cli.interruption import Interruption
from skyknot.cli.iterations import LiveTable, PlainLines, Silent, Watcher, progress_for
from skyknot.solvers.base import IterationRecord

RECORDS = [IterationRecord(i, 100.0 / (i + 1), 10.0**-i, np.nan) for i in range(20)]


def console(*, terminal: bool) -> Console:
    return Console(file=StringIO(), force_terminal=terminal, width=100, highlight=False)


def shown(target: Console) -> str:
    assert isinstance(target.file, StringIO)
    with progress_for(target, "a solver", quiet=False) as progress:
        for record in RECORDS:
            progress.show(record)
    return target.file.getvalue()


@pytest.mark.parametrize(
    ("terminal", "quiet", "kind"),
    [(True, False, LiveTable), (False, False, PlainLines), (True, True, Silent)],
)
def test_the_display_suits_the_console(terminal: bool, quiet: bool, kind: type) -> None:
    assert isinstance(progress_for(console(terminal=terminal), "solver", quiet=quiet), kind)


def test_a_terminal_shows_the_last_iterations_in_a_table() -> None:
    text = shown(console(terminal=True))
    last = text.rsplit("iteration", 1)[1]
    assert "  19 " in last
    assert "   7 " not in last
    assert "a solver" in text


def test_plain_lines_show_every_iteration_without_control_codes() -> None:
    text = shown(console(terminal=False))
    assert text.count("iteration") == len(RECORDS)
    assert "\x1b" not in text


def test_what_a_solver_does_not_tell_is_a_dash() -> None:
    assert "optimality         –" in shown(console(terminal=False))


def test_the_watcher_asks_to_stop_only_after_an_interruption() -> None:
    interruption = Interruption()
    watcher = Watcher(Silent(), interruption)
    assert watcher(RECORDS[0]) is False
    interruption.requested = True
    assert watcher(RECORDS[1]) is True
