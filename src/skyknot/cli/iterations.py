"""The iterations as they happen: a live table on a terminal, plain lines elsewhere, or nothing."""

from __future__ import annotations

import math
from collections import deque
from types import TracebackType
from typing import Protocol

from rich.console import Console
from rich.live import Live
from rich.table import Table

from skyknot.cli.interruption import Interruption
from skyknot.solvers.base import IterationRecord

ROWS = 12
COLUMNS = ("iteration", "objective", "constraint violation", "optimality", "step")


class Progress(Protocol):
    """What a solve reports to."""

    def __enter__(self) -> Progress:
        """Begin."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End."""

    def show(self, record: IterationRecord) -> None:
        """Show one iteration."""


class Silent:
    """Shows nothing, for JSON output."""

    def __enter__(self) -> Silent:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def show(self, record: IterationRecord) -> None:
        """Show nothing."""


class PlainLines:
    """One line an iteration."""

    def __init__(self, console: Console) -> None:
        self.console = console

    def __enter__(self) -> PlainLines:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def show(self, record: IterationRecord) -> None:
        """Print one line."""
        self.console.out(
            "  ".join(f"{n} {v}" for n, v in zip(COLUMNS, _cells(record), strict=True))
        )


class LiveTable:
    """The last iterations in a table that moves."""

    def __init__(self, console: Console, title: str) -> None:
        self.title = title
        self.records: deque[IterationRecord] = deque(maxlen=ROWS)
        # drawn by the clock, not by the iteration: a fast solver is not slowed down
        self.live = Live(get_renderable=self._table, console=console, refresh_per_second=12)

    def __enter__(self) -> LiveTable:
        self.live.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.live.__exit__(kind, error, trace)

    def show(self, record: IterationRecord) -> None:
        """Add one row."""
        self.records.append(record)

    def _table(self) -> Table:
        table = Table(title=self.title, title_justify="left", caption="Ctrl-C stops cleanly")
        for name in COLUMNS:
            table.add_column(name, justify="right")
        for record in tuple(self.records):
            table.add_row(*_cells(record))
        return table


def progress_for(console: Console, title: str, *, quiet: bool) -> Progress:
    """Return the way of showing that suits the console."""
    if quiet:
        return Silent()
    return LiveTable(console, title) if console.is_terminal else PlainLines(console)


class Watcher:
    """The solver's callback: shows each iteration, and stops the solve when asked to."""

    def __init__(self, progress: Progress, interruption: Interruption) -> None:
        self.progress, self.interruption = progress, interruption

    def __call__(self, record: IterationRecord) -> bool:
        """Show the record; return True to stop."""
        self.progress.show(record)
        return self.interruption.requested


def _cells(record: IterationRecord) -> tuple[str, ...]:
    """Return one row; a dash where the solver does not tell."""
    optimality, step = record.dual_infeasibility, record.step
    return (
        f"{record.iteration:4d}",
        f"{record.objective:14.7g}",
        f"{record.primal_infeasibility:9.2e}",
        f"{optimality:9.2e}" if math.isfinite(optimality) else f"{'–':>9}",
        f"{step:7.2g}" if step else f"{'–':>7}",
    )
