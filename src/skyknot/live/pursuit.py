"""Follows what is asked while it changes: the newest wish only, and thoroughly at rest."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from skyknot.errors import UserError
from skyknot.live.planner import Plan, Planner

REST = 0.4
"""Seconds without a change after which the thorough plan is made."""


class Pursuit:
    """Two threads behind a planner: one re-plans, one certifies when nothing moves.

    Wishes that arrive while a re-plan runs are merged, so that the next one is of the newest.

    Parameters
    ----------
    planner : what plans
    show : called with every plan, on a thread of this object
    """

    def __init__(self, planner: Planner, show: Callable[[Plan], None]) -> None:
        self.planner, self._show = planner, show
        self._news = threading.Condition()
        self._asked: dict[str, Any] = {}
        self._examined: Plan | None = None
        self._examiner: threading.Thread | None = None
        self._open, self._settled = True, True
        self._thread = threading.Thread(target=self._follow, name="re-plans", daemon=True)
        self._thread.start()

    def ask(
        self,
        start: Any = None,
        goal: Any = None,
        obstacles: Mapping[str, Any] | None = None,
        limits: Mapping[str, float] | None = None,
    ) -> None:
        """Ask for a plan after a change, as for ``Planner.replan``; returns at once."""
        with self._news:
            for name, place in (("start", start), ("goal", goal)):
                if place is not None:
                    self._asked[name] = place
            for name, values in (("obstacles", obstacles), ("limits", limits)):
                if values:
                    self._asked[name] = {**self._asked.get(name, {}), **values}
            self._news.notify()

    def close(self) -> None:
        """Stop both threads; a solve under way is waited for."""
        with self._news:
            self._open = False
            self._news.notify()
        self._thread.join()
        examiner = self._examiner
        if examiner is not None:
            examiner.join()

    def _follow(self) -> None:
        while self._open:
            with self._news:
                if not (self._asked or self._examined):
                    self._news.wait(None if self._settled or self._examining else REST)
                asked, self._asked = self._asked, {}
                examined, self._examined = self._examined, None
            if not self._open:
                return
            if examined is not None:
                self._adopt(examined)
            if asked:
                self._settled = False
                self._show(self._replanned(asked))
            elif examined is None and not (self._settled or self._examining):
                self._examine()

    @property
    def _examining(self) -> bool:
        examiner = self._examiner
        return examiner is not None and examiner.is_alive()

    def _replanned(self, asked: dict[str, Any]) -> Plan:
        planner = self.planner
        try:
            return planner.replan(**asked)
        except UserError as error:
            assert planner.latest is not None
            return Plan(planner.wish, planner.latest.problem, reason=f"{error.what} {error.do}")

    def _examine(self) -> None:
        wish = self.planner.wish

        def work() -> None:
            plan = self.planner.examine(wish)
            with self._news:
                self._examined, self._examiner = plan, None
                self._news.notify()

        self._examiner = threading.Thread(target=work, name="certificate", daemon=True)
        self._examiner.start()

    def _adopt(self, plan: Plan) -> None:
        """Show a thorough plan when it is still wanted; otherwise rest is waited for again."""
        self._settled = plan.wish == self.planner.wish
        self.planner.adopt(plan)
        if self._settled:
            self._show(plan)
        elif plan.certified and self.planner.latest is not None:
            self._show(replace(self.planner.latest))
