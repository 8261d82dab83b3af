"""Figure "overview": four pictures on one sheet."""

from __future__ import annotations

from typing import Any

from skyknot.report.actuation import CONTROLS_FIGURE, ROTORS_FIGURE, STATES_FIGURE
from skyknot.report.base import Kind
from skyknot.report.comparison import COMPARISON_FIGURE
from skyknot.report.motion_figures import POSITION_FIGURE, VELOCITY_FIGURE
from skyknot.report.path_figure import PATH_FIGURE, draw_path
from skyknot.report.progress import HISTORY_FIGURE
from skyknot.report.reading import Reading

ORDER = (PATH_FIGURE, STATES_FIGURE, POSITION_FIGURE, ROTORS_FIGURE, CONTROLS_FIGURE)
REST = (HISTORY_FIGURE, COMPARISON_FIGURE, VELOCITY_FIGURE)


def chosen_kinds(reading: Reading) -> list[Kind]:
    """Return the four kinds that say most: where it goes, what drives it, how it was found."""
    first = [kind for kind in ORDER if kind.applies(reading)]
    if ROTORS_FIGURE in first:
        first.remove(CONTROLS_FIGURE)
    return [*first, *(kind for kind in REST if kind.applies(reading))][:4]


def draw_overview(figure: Any, reading: Reading) -> str:
    """Draw the four pictures that say most."""
    kinds = chosen_kinds(reading)
    sheets = figure.subfigures(2, 2, wspace=0.04, hspace=0.04).ravel()
    for sheet, kind in zip(sheets, kinds, strict=False):
        sheet.set_facecolor("none")
        sheet.suptitle(kind.title, x=0.02, ha="left", fontsize=11, fontweight="bold")
        if kind is PATH_FIGURE:
            draw_path(sheet, reading, few=True)
        else:
            kind.draw(sheet, reading)
    names = ", ".join(kind.title.lower() for kind in kinds)
    return f"{reading.solution.record.problem}: {names}. {reading.solution.message}"


OVERVIEW_FIGURE = Kind("overview", "Overview", (13.0, 10.0), lambda _reading: True, draw_overview)
