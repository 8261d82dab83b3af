"""Claim: the report tells the meshes of a refinement, and nothing of it where there was none."""

from __future__ import annotations

import skyknot as sk
from skyknot import bank as problems
from skyknot.report.page import verdict
from skyknot.report.problem_card import solution_rows
from skyknot.report.reading import Reading


def rows_of(accuracy):
    problem = problems.cart_pole().problem
    return dict(solution_rows(Reading(sk.solve(problem, sk.HermiteSimpson(8), accuracy=accuracy))))


def test_the_report_tells_the_meshes_and_the_error_reached():
    told = rows_of(1e-3)["Refinement"]
    assert told.startswith("meshes of 8, ")
    assert told.endswith("0.001 asked for")


def test_an_accuracy_out_of_reach_is_the_verdict():
    problem = problems.cart_pole().problem
    solution = sk.solve(problem, sk.HermiteSimpson(8), accuracy=sk.Refinement(1e-8, rounds=1))
    well, sentence = verdict(solution, solution.verify())
    assert not well
    assert sentence.startswith("Solved, not as accurately as asked: Refinement ended at the limit")


def test_one_mesh_is_no_refinement():
    assert "Refinement" not in rows_of(None)
