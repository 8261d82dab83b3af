"""Claim: copies of a problem in one program come out as if each were alone."""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot.bank import hager
from skyknot.bank.fleets import copies

MESH = sk.HermiteSimpson(20)


def test_every_copy_is_the_answer_of_one_alone():
    alone = sk.solve(hager().problem, MESH, tolerance=1e-11)
    several = sk.solve(copies(hager().problem, 4), MESH, tolerance=1e-11)
    assert several.objective == pytest.approx(4 * alone.objective, rel=1e-13)
    for i in range(4):
        np.testing.assert_allclose(several.states[:, i], alone.states[:, 0], atol=1e-12)
        np.testing.assert_allclose(several.costates[:, i], alone.costates[:, 0], atol=1e-12)


def test_copies_exchanged_are_answers_exchanged():
    problem = copies(hager().problem, 3)
    starts = np.array([1.0, -0.5, 2.0])
    order = [2, 0, 1]
    first = sk.solve(problem.varied(initial=list(starts)), MESH, tolerance=1e-11)
    second = sk.solve(problem.varied(initial=list(starts[order])), MESH, tolerance=1e-11)
    np.testing.assert_allclose(second.states, first.states[:, order], atol=1e-12)
    # a quadratic optimum grows with the square of the start
    assert first.objective == pytest.approx(hager().optimum * np.sum(starts**2), rel=1e-7)
