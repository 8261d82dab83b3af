"""Claim: maps show the track and the airspace where they are, as their standards ask."""

from __future__ import annotations

import json
from xml.etree import ElementTree

import numpy as np
import pytest

from export.flights import CERTIFIED, flown
from export.readers import HOME, from_home, read_kml
from report.gallery import SURROUNDINGS, flight
from skyknot.export import Origin, write_export
from skyknot.export.footprints import footprints


@pytest.fixture(scope="module")
def features(tmp_path_factory):
    path = tmp_path_factory.mktemp("maps") / "f.geojson"
    write_export(flight(), path, origin=Origin(*HOME), certificate=CERTIFIED)
    content = json.loads(path.read_text(encoding="utf-8"))
    assert content["type"] == "FeatureCollection"
    return {feature["properties"]["name"]: feature for feature in content["features"]}


def ring_of(feature):
    """Return the outer ring of a polygon: longitude, latitude, altitude."""
    assert feature["geometry"]["type"] == "Polygon"
    (ring,) = feature["geometry"]["coordinates"]
    return np.array(ring)


def test_obstacles_and_corridors_are_on_the_map(features):
    shown = {"hall", "mast", "balloon", "tree", "lane", "street"}
    assert set(features) == {"wrench transfer"} | shown
    assert {g.name for g in SURROUNDINGS} - shown == {"fence", "band"}  # no outline on the ground


@pytest.mark.parametrize("name", ["hall", "mast", "balloon", "tree"])
def test_rings_are_closed_and_run_counter_clockwise(features, name):
    """RFC 7946, section 3.1.6."""
    ring = ring_of(features[name])
    np.testing.assert_array_equal(ring[0], ring[-1])
    x, y = ring[:, 0], ring[:, 1]
    assert np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) > 0


@pytest.mark.parametrize("name", ["mast", "hall"])
def test_outlines_lie_where_the_constraint_has_no_margin(features, name):
    """The constraint itself, evaluated on the outline read back, at the height of the obstacle."""
    (constraint,) = (g for g in SURROUNDINGS if g.name == name)
    longitudes, latitudes, _ = ring_of(features[name]).T
    places = from_home(longitudes, latitudes, np.full(len(longitudes), HOME[2]))
    margins = [float(constraint.function([n, e, -2.0], None)) for n, e, _ in places]
    allowed = {"mast": 0.003, "hall": 0.5}[name]  # the box's margin is rounded at its corners
    assert np.abs(margins).max() < allowed


def test_the_box_stands_where_and_how_high_it_was_put(features):
    hall = features["hall"]
    assert (
        hall["properties"] | {"lowest": 0.0, "highest": 4.0, "use": "keep out"}
        == hall["properties"]
    )
    places = from_home(*ring_of(hall)[:-1].T)
    np.testing.assert_allclose(places.mean(axis=0)[:2], [4.0, 9.0], atol=1e-4)
    first = places[-1] - places[0]
    assert sorted([3.0, 4.0]) == pytest.approx(
        sorted([np.linalg.norm(first[:2]), np.linalg.norm(places[1] - places[0])]), abs=1e-3
    )


def test_a_corridor_is_its_centre_line_with_its_radius(features):
    lane = features["lane"]
    assert lane["geometry"]["type"] == "LineString"
    assert (lane["properties"]["radius"], lane["properties"]["use"]) == (3.0, "stay inside")
    found = from_home(*np.array(lane["geometry"]["coordinates"]).T)
    np.testing.assert_allclose(found, [(0, 0, 0), (4, 3, -3), (8, 6, -5)], atol=1e-4)


def test_times_and_speeds_go_with_the_places(features):
    track = features["wrench transfer"]
    count = len(track["geometry"]["coordinates"])
    assert len(track["properties"]["times"]) == len(track["properties"]["speeds"]) == count
    velocity = flight().trajectory.state(np.array(track["properties"]["times"]))[:, 3:6]
    np.testing.assert_allclose(
        track["properties"]["speeds"], np.linalg.norm(velocity, axis=1), atol=1e-6
    )


def test_a_problem_without_airspace_has_no_footprints():
    assert footprints(flight("yaw").problem) == []
    assert footprints(None) == []


def test_kml_gives_one_time_for_every_place_and_escapes_names(tmp_path):
    path = tmp_path / "f.kml"
    failed = type("Certificate", (), {"passed": False, "sentence": "x < 3 & y > 2"})
    options = {"origin": Origin(*HOME), "certificate": failed, "uncertified": True}
    write_export(flown("asymmetric path"), path, rate=3, **options)
    track = ElementTree.fromstring(path.read_bytes())[0].find(
        ".//{http://www.google.com/kml/ext/2.2}Track"
    )
    kinds = [child.tag.split("}")[1] for child in track]
    assert kinds == ["altitudeMode", *["when"] * 13, *["coord"] * 13]
    assert "x < 3 & y > 2" in read_kml(path).text
