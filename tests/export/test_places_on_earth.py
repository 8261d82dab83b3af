"""Claim: latitude and longitude are those of WGS 84, and the altitude is kept."""

from __future__ import annotations

import numpy as np
import pymap3d
import pytest

from skyknot.errors import UserError
from skyknot.export.geodesy import Origin, parsed_origin

PLACES = [
    (37.2296, -80.4139, 634.0),
    (0.0, 179.9999, 0.0),
    (-89.9, 12.0, 2800.0),
    (60.0, 0.0, -5.0),
]


@pytest.mark.parametrize("place", PLACES)
def test_places_agree_with_pymap3d(place):
    position = np.random.default_rng(3).uniform(-2e4, 2e4, (50, 3)) * [1, 1, 0.02]
    found = Origin(*place).geodetic(position)
    latitude, longitude, _ = pymap3d.ned2geodetic(*position.T, *place)
    np.testing.assert_allclose(found[:, 0], latitude, atol=1e-11)
    np.testing.assert_allclose(found[:, 1], longitude, atol=1e-11)
    np.testing.assert_array_equal(found[:, 2], place[2] - position[:, 2])


def test_north_is_larger_latitude_east_larger_longitude_down_lower():
    home = Origin(37.0, -80.0, 600.0)
    north, east, down = home.geodetic(100.0 * np.eye(3))
    assert (north[0] > 37, abs(north[1] + 80) < 1e-12) == (True, True)
    assert (east[1] > -80, abs(east[0] - 37) < 1e-5) == (True, True)
    assert (down[2], abs(down[0] - 37) < 1e-12) == (500.0, True)


def test_a_metre_is_a_metre():
    """Meridian radius a(1 − e²)/(1 − e² sin²φ)^1.5 and prime vertical radius a/√(1 − e² sin²φ)."""
    a, e2, phi = 6378137.0, 0.00669437999014, np.radians(37.0)
    W = np.sqrt(1 - e2 * np.sin(phi) ** 2)
    moved = Origin(37.0, -80.0).geodetic(np.eye(3)) - [37.0, -80.0, 0.0]
    np.testing.assert_allclose(np.radians(moved[0, 0]) * a * (1 - e2) / W**3, 1.0, rtol=1e-6)
    np.testing.assert_allclose(np.radians(moved[1, 1]) * a / W * np.cos(phi), 1.0, rtol=1e-6)


def test_a_level_flight_stays_level_over_the_curved_earth():
    far = Origin(37.0, -80.0, 600.0).geodetic(np.array([[20e3, 0.0, -50.0]]))
    assert far[0, 2] == 650.0
    rises = pymap3d.ned2geodetic(20e3, 0.0, -50.0, 37.0, -80.0, 600.0)[2] - 650.0
    assert 31.0 < rises < 32.0  # what docs/exports.md tells of the plane itself


@pytest.mark.parametrize("text", ["37.2,-80.4,634", " 37.2 , -80.4 , 634.0 "])
def test_an_origin_is_read(text):
    assert parsed_origin(text) == Origin(37.2, -80.4, 634.0)
    assert parsed_origin("37.2,-80.4") == Origin(37.2, -80.4, 0.0)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("here", "cannot be read"),
        ("1,2,3,4", "cannot be read"),
        ("7", "cannot be read"),
        ("91,0,0", "no place on Earth"),
        ("0,181", "no place on Earth"),
        ("0,0,inf", "no place on Earth"),
        ("nan,0", "no place on Earth"),
    ],
)
def test_what_is_no_origin_is_refused(text, what):
    with pytest.raises(UserError, match=what):
        parsed_origin(text)
