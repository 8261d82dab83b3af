"""The replay on a page: its frame of controls, its data, and the scripts that move it.

The scripts stand in ``web/``: ``three.bundle.js`` (built once from three.js, see
``web/make_three_bundle.sh``) and the replay's own, shipped as they are written.
"""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Sequence
from functools import cache
from hashlib import sha256
from html import escape
from pathlib import Path
from typing import Any

from skyknot.report.reading import Reading
from skyknot.report.replay_data import replay_data

WEB = Path(__file__).with_name("web")

OWN = ("palette", "surroundings", "craft_model", "viewpoint", "replay")
"""The replay's own scripts, in the order in which they need one another."""

WITHOUT = (
    "The flight cannot be shown in motion, because this browser runs no scripts here or offers no"
    " WebGL 2. The picture of the path, among the figures, shows the same scene."
)
"""What stands in the replay's place until it runs."""

CAPTIONS = {
    "flown": "What moves is the independent re-simulation: the controls flown open loop. Thin: the"
    " plan.",
    "lost": "What moves is the independent re-simulation, the controls flown open loop; it ends"
    " where that flight is lost. Thin: the plan.",
    "plan": "What moves is the plan, by the scheme's own interpolant: the equations to fly it again"
    " are not at hand.",
}
"""What is said of the flight shown, by its source."""


@cache
def scripts() -> tuple[str, str]:
    """Return the two scripts of the replay: three.js, and its own."""
    own = "\n".join((WEB / f"{name}.js").read_text(encoding="utf-8") for name in OWN)
    three = (WEB / "three.bundle.js").read_text(encoding="utf-8")
    return three, f'(() => {{\n"use strict";\n{own}}})();\n'


def script_hashes() -> str:
    """Return the scripts' hashes, as a content security policy names what may run."""
    digests = (b64encode(sha256(script.encode()).digest()).decode() for script in scripts())
    return " ".join(f"'sha256-{digest}'" for digest in digests)


def script_elements() -> str:
    """Return the script elements, to stand at the end of a page."""
    return "\n".join(f"<script>{script}</script>" for script in scripts())


def replay_element(readings: Sequence[Reading], wind: Sequence[float] | None = None) -> str:
    """Return the replay of one or several flights as HTML, without the scripts.

    Parameters
    ----------
    readings : flights with positions of a vehicle, at least one
    wind : north, east, down, m/s
    """
    data = replay_data(readings, wind)
    # In a script element only "<" can end the data.
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    first = data["vehicles"][0]
    colors = ", ".join(data["colors"])
    blanks = {
        "names": escape(", ".join(str(vehicle["name"]) for vehicle in data["vehicles"])),
        "thrust_scale": _thrust_scale(first, colors),
        "fastest": _short(max(first["speeds"])),
        "colors": colors,
        "without": WITHOUT,
        "caption": CAPTIONS[first["source"]],
        "data": text,
    }
    frame = (WEB / "replay_frame.html").read_text(encoding="utf-8")
    # In one pass: what is filled in is never looked at again.
    return re.sub(r"\{(\w+)\}", lambda blank: blanks[blank[1]], frame)


def _thrust_scale(vehicle: dict[str, Any], colors: str) -> str:
    """Return the scale of the rotors' thrust; empty where the model knows no rotors."""
    if vehicle["thrusts"] is None:
        return ""
    return (
        '<span class="gap">rotor thrust 0</span>'
        f'<i style="background: linear-gradient(90deg, {colors})"></i>'
        f"<span>{_short(vehicle['thrustMax'])} N</span>"
    )


def _short(value: float) -> str:
    """Return a number in three digits, never as a power of ten."""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"
