"""Draw the pictures of README.md: the city mission, and the problem that README.md itself states.

Run: python docs/pictures/make_pictures.py
"""

import re
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

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


if __name__ == "__main__":
    for draw in (city_hop, round_the_tower):
        draw().savefig(
            FOLDER / f"{draw.__name__}.png", dpi=DOTS_PER_INCH, metadata={"Software": None}
        )
