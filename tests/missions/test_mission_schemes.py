"""Claim: a mission flies with every scheme that its file can name, certified."""

from __future__ import annotations

import re

import pytest

import skyknot as sk
from skyknot import missions
from skyknot.missions.mission import FOLDER

SCHEMES = {
    "lobatto": 'name = "lobatto"\npoints = 5\nsegments = 12\n',
    "lobatto, from one segment": 'name = "lobatto"\npoints = 8\nsegments = 1\n',
    "lobatto, own": 'name = "lobatto"\npoints = 5\nsegments = 12\ncontrols = "discontinuous"\n',
    "radau": 'name = "radau"\npoints = 4\nsegments = 12\n',
    "chebyshev": 'name = "chebyshev"\npoints = 5\nsegments = 12\n',
    "trapezoid": 'name = "trapezoid"\nsegments = 40\n',
}


@pytest.fixture(scope="module")
def usual() -> sk.Solution:
    mission = missions.load("yaw_point_transfer")
    return sk.solve(mission.problem, **mission.settings())


@pytest.mark.parametrize("name", SCHEMES)
def test_the_mission_is_certified_and_costs_the_same(name: str, usual: sk.Solution) -> None:
    text = (FOLDER / "yaw_point_transfer.toml").read_text(encoding="utf-8")
    chosen, count = re.subn(
        r"\[scheme\]\n.*?(?=\n\[|\Z)", f"[scheme]\n{SCHEMES[name]}", text, flags=re.DOTALL
    )
    assert count == 1
    mission = missions.parse(chosen, "yaw_point_transfer", folder=FOLDER)
    solution = sk.solve(mission.problem, **mission.settings())
    assert solution.success, solution.message
    assert solution.objective == pytest.approx(usual.objective, rel=1e-3)
    certificate = solution.verify()
    assert certificate.passed, certificate.sentence
