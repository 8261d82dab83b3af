"""GeoJSON: the track with its times, and the airspace it was planned in.

Source: RFC 7946. Positions are longitude, latitude [deg, WGS 84], altitude [m]; outer rings run
counter-clockwise. GeoJSON knows no time, so the track's properties hold one time per position.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.export.base import Encoded, Format, Request
from skyknot.export.footprints import Footprint, footprints
from skyknot.export.geodesy import Origin

Array = NDArray[np.float64]

DEGREES, METRES = 10, 4
"""Decimals: 1e-10 deg is 0.01 mm."""


def encode(request: Request) -> Encoded:
    """Return the collection: the track first, then obstacles and corridors by name."""
    flight, place = request.sampled, request.place
    track = {
        "name": request.title,
        "kind": "track",
        "certificate": request.verdict,
        "times": [round(float(t), 9) for t in flight.times],
        "speeds": [round(float(v), 6) for v in np.linalg.norm(flight.velocity, axis=1)],
        "units": "times s, speeds m/s, altitudes m",
    }
    features = [_feature("LineString", coordinates(place, flight.position), track)]
    features += [_mapped(place, entry) for entry in footprints(request.solution.problem)]
    content = {"type": "FeatureCollection", "features": features}
    text = json.dumps(content, ensure_ascii=False, allow_nan=False, indent=1) + "\n"
    return Encoded(text.encode("utf-8"), "places to 0.1 mm")


def coordinates(place: Origin, position: Array) -> list[list[float]]:
    """Return positions (M, 3), NED, as lists of longitude, latitude, altitude."""
    return [
        [round(float(lon), DEGREES), round(float(lat), DEGREES), round(float(height), METRES)]
        for lat, lon, height in place.geodetic(position)
    ]


def _mapped(place: Origin, footprint: Footprint) -> dict[str, Any]:
    properties = {
        "name": footprint.name,
        "kind": footprint.kind,
        "use": "stay inside" if footprint.keep_in else "keep out",
        **footprint.sizes,
    }
    points = coordinates(place, footprint.points)
    if not footprint.outline:
        return _feature("LineString", points, properties)
    ring = points[::-1]
    return _feature("Polygon", [[*ring, ring[0]]], properties)


def _feature(kind: str, points: Any, properties: dict[str, Any]) -> dict[str, Any]:
    geometry = {"type": kind, "coordinates": points}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


GEOJSON = Format(
    name="geojson",
    title="GeoJSON with track, obstacles and corridors",
    file_name="flight.geojson",
    encode=encode,
    rate=5.0,
    needs=("origin",),
)
