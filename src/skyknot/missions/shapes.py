"""Path constraints of the airspace that a mission file describes."""

from __future__ import annotations

import math
from typing import Any

from skyknot.missions.schema_airspace import (
    Airspace,
    Box,
    Building,
    Corridor,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    Sphere,
)
from skyknot.problem import airspace as shapes
from skyknot.problem.constraints import PathConstraint

ALTITUDE_BAND = "altitude band"


def airspace_constraints(airspace: Airspace) -> list[PathConstraint]:
    """Return one constraint per obstacle, then per corridor, then the altitude band."""
    found = [obstacle_constraint(obstacle) for obstacle in airspace.obstacles]
    found += [corridor_constraint(corridor) for corridor in airspace.corridors]
    if airspace.altitude is not None:
        band = airspace.altitude
        found.append(shapes.altitude_band(ALTITUDE_BAND, band.lowest, band.highest))
    return found


def corridor_constraint(corridor: Corridor) -> PathConstraint:
    """Return the tube around a corridor's legs."""
    return shapes.tube(corridor.name, corridor.points, corridor.radius)


def obstacle_constraint(obstacle: Any) -> PathConstraint:
    """Return the constraint that keeps out of an obstacle."""
    if isinstance(obstacle, HalfSpace):
        return shapes.half_space(obstacle.name, obstacle.normal, obstacle.offset)
    name, clearance = obstacle.name, obstacle.clearance
    if isinstance(obstacle, Cylinder):
        return shapes.cylinder(name, obstacle.center, obstacle.radius, clearance=clearance)
    if isinstance(obstacle, Sphere):
        return shapes.sphere(name, obstacle.center, obstacle.radius, clearance=clearance)
    if isinstance(obstacle, Ellipsoid):
        return shapes.ellipsoid(name, obstacle.center, obstacle.semi_axes, clearance=clearance)
    center, size = _extent(obstacle)
    yaw = math.radians(obstacle.yaw_degrees)
    return shapes.box(name, center, size, yaw=yaw, clearance=clearance)


def _extent(obstacle: Box | Building) -> tuple[list[float], list[float]]:
    """Return center and full size of a box, NED, m; a building stands on the ground."""
    if isinstance(obstacle, Box):
        return obstacle.center, obstacle.size
    return [*obstacle.center, -0.5 * obstacle.height], [*obstacle.size, obstacle.height]
