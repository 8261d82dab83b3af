"""Draw the pictures of README.md: the city mission, its replay, and the problem stated there.

Run: python docs/pictures/make_pictures.py (the replay needs Debian's chromium)
"""

import re
import shutil
import tempfile
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from playwright.sync_api import sync_playwright

import skyknot as sk

FOLDER = Path(__file__).parent
README = FOLDER.parents[1] / "README.md"
DOTS_PER_INCH = 110


def city_hop() -> Figure:
    """Return the path of the library's city mission."""
    mission = sk.missions.load("city_hop")
    return sk.solve(mission.problem, **mission.settings()).plot("path")


def round_the_tower() -> Figure:
    """Return the path that the first Python block of README.md computes."""
    block = re.search(r"^```python\n(.*?)^```$", README.read_text(), re.MULTILINE | re.DOTALL)
    if block is None:
        raise ValueError("README.md shows no Python block")
    names: dict[str, Any] = {}
    exec(compile(block.group(1), str(README), "exec"), names)
    return names["solution"].plot("path")


def replay(path: Path) -> None:
    """Write a picture of the city mission's replay, as a browser shows it."""
    mission = sk.missions.load("city_hop")
    solution = sk.solve(mission.problem, **mission.settings())
    flags = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        page_file = solution.report(Path(folder) / "report.html")
        browser = driver.chromium.launch(
            executable_path=shutil.which("chromium"), args=[*flags, "--enable-unsafe-swiftshader"]
        )
        page = browser.new_page(viewport={"width": 1160, "height": 860})
        page.goto(page_file.as_uri())
        page.locator("[data-part=scrub]").evaluate(
            "e => { e.value = 400; e.dispatchEvent(new Event('input')); }"
        )
        page.locator(".replay-view").screenshot(path=path)
        browser.close()


if __name__ == "__main__":
    replay(FOLDER / "replay.png")
    for draw in (city_hop, round_the_tower):
        draw().savefig(
            FOLDER / f"{draw.__name__}.png", dpi=DOTS_PER_INCH, metadata={"Software": None}
        )
