"""skyknot live: drag the goal, and watch the path follow."""

from __future__ import annotations

import time
import webbrowser
from typing import Annotated

import typer

from skyknot import missions
from skyknot.cli.exits import Exit, command
from skyknot.live.live_page import LivePage
from skyknot.live.planner import Planner


@command
def live(
    mission: Annotated[
        str, typer.Argument(metavar="MISSION", help="Name of a mission, or path of a .toml file.")
    ],
    port: Annotated[
        int, typer.Option(min=1, max=65535, help="Port of the page; the next free one is taken.")
    ] = 8080,
    no_open: Annotated[bool, typer.Option("--no-open", help="Do not open a browser.")] = False,
) -> Exit:
    """Open a page on which goal, start, obstacles and limits move and the path follows.

    The page is served to this machine only and needs no network. A re-plan starts from the last
    answer; at rest the mesh is refined and the full certificate made. Where there is no path the
    page says why, and the last certified plan stays. Ctrl-C stops it. Needs the extra "live".

    Examples
    --------
      skyknot live city_hop

      skyknot live city_hop --port 9000 --no-open

    Exit status: 0 stopped, 2 a mistake in the input.
    """
    loaded = missions.load(mission)
    planner = Planner(loaded)
    page = LivePage(planner, port)
    try:
        assert planner.latest is not None
        typer.echo(planner.latest.sentence)
        typer.echo(f"The page is at {page.address} (Ctrl-C stops it).")
        if not no_open:
            webbrowser.open(page.address)
        while True:
            time.sleep(0.2)
    except KeyboardInterrupt:
        pass
    finally:
        page.close()
    rate = f" at {planner.rate:.0f} re-plans per second" if planner.rate == planner.rate else ""
    typer.echo(f"Stopped{rate}.")
    return Exit.GOOD
