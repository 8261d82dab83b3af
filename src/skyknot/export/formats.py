"""All export formats by name, in the order of the documentation."""

from __future__ import annotations

from skyknot.export.base import Format
from skyknot.export.geojson import GEOJSON
from skyknot.export.ground_plan import PLAN
from skyknot.export.kml import KML
from skyknot.export.mavlink import MAVLINK_ATTITUDE, MAVLINK_POSITION
from skyknot.export.netcdf import NETCDF
from skyknot.export.ros_bag import ROS2
from skyknot.export.rpg_table import CSV

_ALL = (CSV, NETCDF, PLAN, MAVLINK_POSITION, MAVLINK_ATTITUDE, ROS2, GEOJSON, KML)

FORMATS: dict[str, Format] = {entry.name: entry for entry in _ALL}
"""Formats by name."""
