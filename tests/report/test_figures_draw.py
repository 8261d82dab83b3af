"""Every figure draws for every solution, without warning, with units, and not blank."""

import io
import re
from dataclasses import replace
from functools import cache

import matplotlib as mpl
import numpy as np
import pytest
from gallery import SOLUTIONS, flight, rail, without_problem
from matplotlib.image import imread

from skyknot.errors import UserError
from skyknot.report import KINDS, draw, kinds_of, save_figures
from skyknot.report.figures import illustrate, rendered
from skyknot.report.style import styled

VARIANTS = {"flight by rotors", "flight by a point", "hover", "climb"}
"""Flights that differ from the others in these kinds of figures only."""

OF_VARIANTS = {"path", "rotors", "controls", "power"}

CASES = [
    (name, kind)
    for name, make in SOLUTIONS.items()
    for kind in kinds_of(make())
    if name not in VARIANTS or kind in OF_VARIANTS
]

WITHOUT_UNIT = {"iteration", "objective", "infeasibility"}
"""Names that are dimensionless, or in the user's own units, by themselves."""


@cache
def picture_of(name, kind):
    return illustrate(SOLUTIONS[name](), kind)


def pixels(figure):
    stream = io.BytesIO()
    with styled():
        figure.savefig(stream, format="png", dpi=60)
    return imread(io.BytesIO(stream.getvalue()))[:, :, :3]


def drawn_axes(figure):
    return [axes for axes in figure.axes if axes.axison]


@pytest.mark.parametrize(("name", "kind"), CASES, ids=[f"{n}: {k}" for n, k in CASES])
def test_a_figure_is_not_blank_and_says_what_it_shows(name, kind):
    picture = picture_of(name, kind)
    image = pixels(picture.figure)
    assert np.mean(np.any(image < 0.9, axis=2)) > 0.01
    assert len(np.unique((image * 15).astype(int) @ [256, 16, 1])) > 8
    assert picture.caption.endswith(".")
    assert picture.title


@pytest.mark.parametrize(("name", "kind"), CASES, ids=[f"{n}: {k}" for n, k in CASES])
def test_every_axis_carries_a_name_and_a_unit(name, kind):
    for axes in drawn_axes(picture_of(name, kind).figure):
        shared = (
            axes.get_shared_y_axes().get_siblings(axes),
            axes.get_shared_x_axes().get_siblings(axes),
        )
        labels = (
            [other.get_ylabel() for other in shared[0]],
            [other.get_xlabel() for other in shared[1]],
        )
        if axes.get_label() == "<colorbar>":
            labels = ([axes.get_xlabel()],)
        for of_one_axis in labels:
            told = [label for label in of_one_axis if label]
            assert told, f"an axis of {kind} has no label"
            for label in told:
                assert label in WITHOUT_UNIT or re.fullmatch(r"\S.*\s\[[^\]]+\]", label), label


@pytest.mark.parametrize("name", ["flight", "climb", "long haul"])
def test_the_picture_in_space_names_its_three_axes_with_units(name):
    texts = [text.get_text() for text in draw(SOLUTIONS[name](), "path").axes[0].texts]
    assert {"east y [m]", "north x [m]", "altitude −z [m]"} <= set(texts)


def test_a_vehicle_gets_all_figures_of_a_flight_and_a_rail_those_that_make_sense():
    assert set(kinds_of(flight())) == set(KINDS) - {"states", "limits", "power"}
    assert kinds_of(rail()) == (
        *("states", "controls", "limits", "mesh", "history", "costates", "before_after"),
        "overview",
    )
    assert kinds_of(without_problem()) == ("states", "controls", "history", "overview")
    assert "rotors" not in kinds_of(flight("yaw"))


def test_a_kind_that_does_not_apply_is_refused_with_those_that_do():
    with pytest.raises(UserError, match=r"(?s)no such figure.*'rotors'.*states, controls"):
        draw(rail(), "rotors")
    with pytest.raises(UserError, match=r"(?s)no such figure.*'pie'.*path, position"):
        draw(flight(), "pie")


def test_drawing_leaves_the_global_style_alone():
    before = dict(mpl.rcParams)
    rendered(draw(flight(), "position"), "png")
    assert dict(mpl.rcParams) == before


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_the_same_solution_gives_the_same_bytes(suffix):
    first, second = (rendered(draw(rail(), "history"), suffix) for _ in range(2))
    assert first == second


def test_saved_figures_are_png_and_pdf_of_every_kind(tmp_path):
    solution = replace(rail(), problem=None)
    written = save_figures(solution, tmp_path / "figures")
    expected = [f"{kind}.{suffix}" for kind in kinds_of(solution) for suffix in ("png", "pdf")]
    assert [path.name for path in written] == expected
    assert all(path.stat().st_size > 5000 for path in written)
    assert written[0].read_bytes().startswith(b"\x89PNG")
    assert written[1].read_bytes().startswith(b"%PDF")


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "figures").write_text("a file in the way")
    with pytest.raises(UserError, match=r"(?s)cannot be written.*figures.*Choose another place"):
        save_figures(rail(), tmp_path / "figures")
