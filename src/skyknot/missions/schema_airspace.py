"""What stands in the way, and where the flight must stay."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from skyknot.missions.section import NotNegative, Number, Pair, Position, Positive, Section, Triple

Name = Annotated[str, Field(min_length=1)]


class Cylinder(Section):
    """A vertical cylinder of unlimited height."""

    kind: Literal["cylinder"]
    name: Name = Field(description="what messages and figures call it")
    center: Pair = Field(description="north, east [m]")
    radius: Positive = Field(description="radius [m]")
    clearance: NotNegative = Field(default=0.0, description="distance to keep [m]")


class Sphere(Section):
    """A sphere."""

    kind: Literal["sphere"]
    name: Name = Field(description="what messages and figures call it")
    center: Position = Field(description="north, east, down [m]")
    radius: Positive = Field(description="radius [m]")
    clearance: NotNegative = Field(default=0.0, description="distance to keep [m]")


class Ellipsoid(Section):
    """An ellipsoid along the axes."""

    kind: Literal["ellipsoid"]
    name: Name = Field(description="what messages and figures call it")
    center: Position = Field(description="north, east, down [m]")
    semi_axes: Annotated[list[Positive], Field(min_length=3, max_length=3)] = Field(
        description="half lengths north, east, down [m]"
    )
    clearance: NotNegative = Field(default=0.0, description="added to every half length [m]")


class Building(Section):
    """A building: a box that stands on the ground."""

    kind: Literal["building"]
    name: Name = Field(description="what messages and figures call it")
    center: Pair = Field(description="north, east of the middle of the ground plan [m]")
    size: Annotated[list[Positive], Field(min_length=2, max_length=2)] = Field(
        description="length north and width east, before turning by yaw [m]"
    )
    height: Positive = Field(description="height above ground [m]")
    yaw_degrees: Number = Field(
        default=0.0, description="turn of the ground plan about the vertical [deg]"
    )
    clearance: NotNegative = Field(default=0.0, description="distance to keep [m]")


class Box(Section):
    """A box anywhere."""

    kind: Literal["box"]
    name: Name = Field(description="what messages and figures call it")
    center: Position = Field(description="north, east, down of the middle [m]")
    size: Annotated[list[Positive], Field(min_length=3, max_length=3)] = Field(
        description="full length north, east, down, before turning by yaw [m]"
    )
    yaw_degrees: Number = Field(default=0.0, description="turn about the vertical [deg]")
    clearance: NotNegative = Field(default=0.0, description="distance to keep [m]")


class HalfSpace(Section):
    """A wall: the flight stays where normal · position ≥ offset."""

    kind: Literal["half-space"]
    name: Name = Field(description="what messages and figures call it")
    normal: Triple = Field(description="direction of the allowed side, north, east, down")
    offset: Number = Field(description="distance of the plane from the origin along normal [m]")


Obstacle = Annotated[
    Cylinder | Sphere | Ellipsoid | Building | Box | HalfSpace, Field(discriminator="kind")
]


class Corridor(Section):
    """A tube around a path of straight legs; the flight stays inside."""

    name: Name = Field(description="what messages and figures call it")
    points: Annotated[list[Position], Field(min_length=2)] = Field(
        description="corners of the path, north, east, down [m]"
    )
    radius: Positive = Field(description="radius of the tube [m]")


class Band(Section):
    """Heights between which the flight stays."""

    lowest: Number = Field(description="lowest height above ground [m]")
    highest: Number = Field(description="greatest height above ground [m]")


class Airspace(Section):
    """Obstacles, corridors and the altitude band."""

    obstacles: list[Obstacle] = Field(default=[], description="what to keep out of")
    corridors: list[Corridor] = Field(
        default=[], description="what to stay inside; all of them at once"
    )
    altitude: Band | None = Field(
        default=None, description="heights above ground to stay between [m]"
    )
