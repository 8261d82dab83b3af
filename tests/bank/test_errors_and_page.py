"""Claim: errors against mesh size show the orders, and the page of the documents is in step."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import skyknot as sk
from skyknot.bank import CATALOGUE, judged
from skyknot.bank.answers_page import HEAD, family, known, page, source_lines
from skyknot.bank.mesh_errors import MESHES, mesh_errors
from skyknot.report.error_picture import error_figure

PAGE = Path(__file__).parents[2] / "docs" / "bank.md"
REMAKE = "run: skyknot bank --markdown docs/bank.md"


def errors_of(name, *arguments):
    return mesh_errors(name, CATALOGUE[name](), *arguments)


@pytest.mark.parametrize("name", ["hager", "garg", "brachistochrone", "zermelo", "oscillator"])
def test_smooth_problems_show_order_four(name):
    assert errors_of(name).order == pytest.approx(4.0, abs=0.1)


def test_a_jump_inside_a_segment_shows_order_two():
    assert errors_of("minimum-time").order == pytest.approx(2.0, abs=0.1)


def test_another_scheme_shows_its_own_order():
    assert errors_of("hager", MESHES, sk.Trapezoid).order == pytest.approx(2.0, abs=0.1)


def test_what_is_exact_on_every_mesh_shows_no_order():
    found = errors_of("minimum-energy", (3, 5, 7))
    assert found.exact
    assert np.isnan(found.order)


def test_errors_below_the_digits_known_show_no_order():
    found = errors_of("quadrotor-step-small", (20, 40, 80))
    assert np.isnan(found.order)
    assert not found.exact


def test_a_mesh_without_a_solution_has_no_error():
    found = errors_of("hang-glider", (10, 20))
    assert np.isnan(found.errors[0])


def tables():
    """Return the rows of the page's two tables, by the name of the problem."""
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in PAGE.read_text(encoding="utf-8").splitlines()
        if line.startswith("| ")
    ]
    heads = [i for i, row in enumerate(rows) if row[0] == "problem"]
    return rows[heads[0] : heads[1]], rows[heads[1] :]


def test_the_page_tells_every_problem_with_todays_reference():
    answers, errors = tables()
    assert answers[0] == HEAD
    assert [row[0] for row in answers[2:]] == list(CATALOGUE), REMAKE
    assert [row[0] for row in errors[2:]] == list(CATALOGUE), REMAKE
    for row in answers[2:]:
        reference = CATALOGUE[row[0]]()
        assert row[1:3] == [reference.kind, known(reference)], REMAKE
        assert abs(float(row[3]) - reference.optimum) <= reference.limit
        assert row[-1] == "reached"


def test_the_page_tells_errors_on_four_meshes():
    _, errors = tables()
    assert errors[0] == ["problem", *(f"N = {N}" for N in MESHES), "order"]
    assert len(MESHES) >= 4
    for row in errors[2:]:
        assert all(cell == "–" or float(cell) >= 0 for cell in row[1:-1])
        assert re.fullmatch(r"exact|–|-?\d+\.\d", row[-1])


def test_the_page_tells_every_source_and_every_printed_number():
    text = PAGE.read_text(encoding="utf-8")
    for name, make in CATALOGUE.items():
        for line in source_lines(name, make()):
            assert line in text, REMAKE


def test_the_page_counts_what_is_missed():
    reference = CATALOGUE["hager"]()
    reached = judged("hager", reference)
    made = page([reached], [errors_of("hager", (5, 10, 20))])
    assert "1 of 1 problems reach their reference." in made
    assert "| hager | closed form | 0.8641644977691 |" in made


def test_every_family_has_a_panel_with_its_problems():
    found = [errors_of(name, (5, 10, 20)) for name in ("hager", "cart", "brachistochrone")]
    families = {}
    for each in found:
        families.setdefault(family(each.name), {})[each.name] = (each.meshes, each.errors)
    figure = error_figure(families)
    panels = [axes for axes in figure.axes if axes.get_visible()]
    assert [axes.get_title(loc="left") for axes in panels] == ["smooth optima", "shortest times"]
    labels = [text.get_text() for axes in panels for text in axes.get_legend().get_texts()]
    assert labels == ["hager", "cart", "brachistochrone"]
    np.testing.assert_allclose(panels[0].lines[0].get_ydata(), found[0].errors)
