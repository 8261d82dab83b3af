"""A headless Chromium for the tests of pages: Debian's, driven by Playwright.

Where there is none the tests are skipped with a sentence; with SKYKNOT_NEEDS_BROWSER set, as
.ci/run sets it, they fail instead.
"""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import pytest

import skyknot as sk
from skyknot import missions
from skyknot.report import write_report

ROOT = Path(__file__).parents[2]
SCREENS = ROOT / "build" / "screenshots"
FLAGS = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",  # WebGL without a graphics card
    "--enable-unsafe-swiftshader",
    "--force-device-scale-factor=1",
)
MISSING = "needs a browser: install Debian's 'chromium' and 'pip install playwright' (extra dev)"


@dataclass
class Visit:
    """A page opened from disk, with all it said and asked for."""

    page: object
    said: list[str] = field(default_factory=list)
    asked_for: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Report:
    """A mission solved once, and its report on disk."""

    solution: sk.Solution
    path: Path


@pytest.fixture(scope="session")
def chromium():
    """Return a running browser, one for the session."""
    program = shutil.which("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        program = None
    if program is None:
        (pytest.fail if os.environ.get("SKYKNOT_NEEDS_BROWSER") else pytest.skip)(MISSING)
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=list(FLAGS))
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def reports(tmp_path_factory):
    """Return a function that solves a mission and writes its report, each once in a session."""
    folder, made = tmp_path_factory.mktemp("reports"), {}

    def report_of(name):
        if name not in made:
            mission = missions.load(name)
            solution = sk.solve(mission.problem, **mission.settings())
            path = write_report(
                solution, folder / f"{name}.html", title=mission.title, guess=mission.guess
            )
            made[name] = Report(solution, path)
        return made[name]

    return report_of


@pytest.fixture(scope="session")
def visit(chromium):
    """Return a function that opens a page from disk and listens to it."""
    contexts = []

    def visited(path, width=1280, height=860, before=None, **settings):
        context = chromium.new_context(viewport={"width": width, "height": height}, **settings)
        contexts.append(context)
        if before is not None:
            context.add_init_script(before)
        seen = Visit(context.new_page())
        seen.page.on("console", lambda message: seen.said.append(f"{message.type}: {message.text}"))
        seen.page.on("pageerror", lambda error: seen.said.append(f"error: {error}"))
        seen.page.on("request", lambda request: seen.asked_for.append(request.url))
        seen.page.goto(path.as_uri())
        return seen

    yield visited
    for context in contexts:
        context.close()


@pytest.fixture(scope="session")
def screens():
    """Return the folder where screenshots are kept."""
    SCREENS.mkdir(parents=True, exist_ok=True)
    return SCREENS
