"""A tube's margin is never larger than the true one, and the tube is nearly as wide as asked."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from skyknot.errors import UserError
from skyknot.problem.airspace import tube

CORNERS = [[0.0, 0.0, 0.0], [0.0, 0.0, -60.0], [300.0, 40.0, -60.0], [300.0, 40.0, 0.0]]
RADIUS = 12.0
coordinate = st.floats(-400.0, 400.0)


def true_margin(position: np.ndarray) -> float:
    distances = []
    for a, b in zip(np.array(CORNERS[:-1]), np.array(CORNERS[1:]), strict=True):
        share = np.clip((position - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        distances.append(float(np.linalg.norm(position - a - share * (b - a))))
    return RADIUS - min(distances)


def margin(position: np.ndarray) -> float:
    return float(tube("lane", CORNERS, RADIUS).function(list(position), []))


@given(coordinate, coordinate, coordinate)
def test_the_margin_is_at_most_the_true_one(x: float, y: float, z: float) -> None:
    position = np.array([x, y, z])
    assert margin(position) <= true_margin(position) + 1e-9


@pytest.mark.parametrize("share", [0.0, 0.5, 0.9])
@pytest.mark.parametrize("center", [[0, 0, -30], [150, 20, -60], [300, 40, -30], [300, 40, 0]])
def test_nine_tenths_of_the_radius_are_inside(center: list[float], share: float) -> None:
    across = np.array([-40.0, 300.0, 0.0]) / np.hypot(300.0, 40.0)
    assert margin(np.array(center) + share * RADIUS * across) > 0


def test_the_margin_of_a_single_leg_is_zero_on_its_wall() -> None:
    wall = tube("lane", [[0, 0, 0], [100, 0, 0]], RADIUS).function([50, 0, -RADIUS], [])
    assert float(wall) == pytest.approx(0.0, abs=1e-6 * RADIUS)


def test_a_tube_with_one_corner_is_refused() -> None:
    with pytest.raises(UserError, match="'lane' has no size") as caught:
        tube("lane", CORNERS[:1], RADIUS)
    assert "length of a leg" in caught.value.where
