"""The page of ``skyknot live``: the scene, the inputs beside it, and the read-out."""

from __future__ import annotations

import contextlib
import io
from typing import Any

from skyknot.errors import UserError
from skyknot.live.adjustable import Place
from skyknot.live.planner import Plan, Planner
from skyknot.live.pursuit import Pursuit
from skyknot.live.view import View

HOST = "127.0.0.1"
"""Only this machine: the page is for its user, not for the network."""


class LivePage:
    """A page that keeps one mission solved while it is dragged about.

    Parameters
    ----------
    planner : of the mission, begun
    port : port to listen on; the next free one is taken

    Raises
    ------
    UserError
        When the extra that draws the page is not installed.
    """

    def __init__(self, planner: Planner, port: int = 8080) -> None:
        viser = _viser()
        self.planner = planner
        self._inputs: dict[str, list[Any]] = {}
        with _quietly():
            self._server = viser.ViserServer(host=HOST, port=port, label="skyknot live")
        # no button to share: that would go through a server elsewhere
        self._server.gui.configure_theme(show_logo=False, show_share_button=False)
        self._server.gui.main_panel.dock_right()
        self._view = View(self._server, planner.adjustable, self._dragged)
        self._pursuit = Pursuit(planner, self._show)
        self._build()
        if planner.latest is not None:
            self._show(planner.latest)

    @property
    def address(self) -> str:
        """Where the browser finds the page."""
        return f"http://{HOST}:{self._server.get_port()}"

    def close(self) -> None:
        """Stop planning and serving."""
        self._pursuit.close()
        with _quietly():
            self._server.stop()

    def _build(self) -> None:
        gui, adjustable = self._server.gui, self.planner.adjustable
        gui.add_markdown(f"**{adjustable.mission.title}**")
        self._verdict = gui.add_markdown("")
        self._numbers = gui.add_markdown("")
        for kind in ("goal", "start"):
            with gui.add_folder(kind.capitalize()):
                self._inputs[kind] = self._coordinates(kind)
        with gui.add_folder("Limits"):
            for limit in adjustable.limits:
                self._slider(limit)
        with gui.add_folder("Flight"):
            share = gui.add_slider("Time [%]", 0.0, 100.0, 0.5, 0.0)
            share.on_update(lambda _: self._view.place_craft(share.value / 100))
        if adjustable.wish.obstacles:
            with gui.add_folder("Obstacles", expand_by_default=False):
                for name in adjustable.wish.obstacles:
                    self._inputs[name] = self._shift(name)

    def _coordinates(self, kind: str) -> list[Any]:
        """Add north, east and height of an end, for the keyboard and for exact numbers."""
        north, east, down = getattr(self.planner.wish, kind)
        title = kind.capitalize()
        boxes = [
            self._server.gui.add_number(f"{title} {axis} [m]", round(value, 3), step=0.1)
            for axis, value in (("north", north), ("east", east), ("height", -down))
        ]

        def typed(event: Any) -> None:
            if event.client is None:  # set by the page itself, after a drag
                return
            place = (boxes[0].value, boxes[1].value, -boxes[2].value)
            self._view.put(kind, "", place)
            self._ask(kind, "", place)

        for box in boxes:
            box.on_update(typed)
        return boxes

    def _shift(self, name: str) -> list[Any]:
        """Add the shift of an obstacle, north and east."""
        boxes = [
            self._server.gui.add_number(f"{name}: {axis} [m]", 0.0, step=0.5)
            for axis in ("north", "east")
        ]

        def typed(event: Any) -> None:
            if event.client is None:
                return
            down = self.planner.wish.obstacles[name][2]
            place = (boxes[0].value, boxes[1].value, down)
            self._view.put("obstacle", name, place)
            self._ask("obstacle", name, place)

        for box in boxes:
            box.on_update(typed)
        return boxes

    def _slider(self, limit: Any) -> None:
        steps = (limit.greatest - limit.least) / 200
        slider = self._server.gui.add_slider(
            f"{limit.name.capitalize()} [{limit.unit}]",
            limit.least,
            limit.greatest,
            steps,
            limit.value,
        )
        slider.on_update(
            lambda event: (
                None
                if event.client is None
                else self._pursuit.ask(
                    limits={limit.name: min(max(slider.value, limit.least), limit.greatest)}
                )
            )
        )

    def _dragged(self, kind: str, name: str, place: Place) -> None:
        """Take over what a handle says, and write it into the inputs."""
        shown = (place[0], place[1], -place[2]) if kind != "obstacle" else place[:2]
        for box, value in zip(self._inputs[name or kind], shown, strict=True):
            box.value = round(value, 3)
        self._ask(kind, name, place)

    def _ask(self, kind: str, name: str, place: Place) -> None:
        if kind == "obstacle":
            self._pursuit.ask(obstacles={name: place})
        elif kind == "goal":
            self._pursuit.ask(goal=place)
        else:
            self._pursuit.ask(start=place)

    def _show(self, plan: Plan) -> None:
        with self._server.atomic():
            self._view.show(plan, self.planner.certified)
            self._verdict.content = verdict(plan, self.planner.certified)
            self._numbers.content = numbers(plan, self.planner)


def verdict(plan: Plan, certified: Plan | None) -> str:
    """Return the verdict for the page; where a plan failed, what stays on the screen."""
    kept = ""
    if not plan.solved and certified is not None:
        place = certified.wish.goal
        kept = (
            f"\n\nOn screen (grey): the last certified plan, to north {place[0]:.1f},"
            f" east {place[1]:.1f}, height {-place[2]:.1f} m."
        )
    return plan.sentence + kept


def numbers(plan: Plan, planner: Planner) -> str:
    """Return the read-out: times, iterations, rate, mesh."""
    times = " + ".join(f"{name} {1e3 * spent:.0f}" for name, spent in plan.seconds.items())
    rate = f"{planner.rate:.0f} per second" if planner.rate == planner.rate else "none yet"
    flight = "none" if plan.trajectory is None else f"{plan.trajectory.duration:.2f} s"
    return (
        f"Flight time: **{flight}**  \n"
        f"Planned in: **{1e3 * plan.total:.0f} ms** ({times or 'nothing solved'})  \n"
        f"Iterations: **{plan.iterations}** on {planner.segments} segments  \n"
        f"Re-plans: **{rate}** (median of the last)"
    )


def _quietly() -> contextlib.redirect_stdout[io.StringIO]:
    """Keep the server's own announcements from standard output, whose lines are ours."""
    return contextlib.redirect_stdout(io.StringIO())


def _viser() -> Any:
    try:
        import viser
    except ImportError:
        raise UserError(
            "The live page needs a package that is not installed.",
            where="skyknot live",
            found="no package 'viser'",
            expected="the extra 'live'",
            do="pip install 'skyknot[live]'",
        ) from None
    return viser
