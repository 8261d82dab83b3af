"""From where to where, in what time, at what price, within which limits."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from skyknot.missions.section import (
    NotNegative,
    Number,
    Positive,
    Section,
    Triple,
    Weights,
)

Turn = Annotated[float, Field(gt=0, lt=90)]
Steep = Annotated[float, Field(gt=0, lt=math.pi / 2)]


class Place(Section):
    """A point: three NED numbers, or two and an altitude."""

    position: Annotated[list[Number], Field(min_length=2, max_length=3)] = Field(
        description="north, east, down [m]; down is negative above ground; "
        "or north, east only, together with altitude"
    )
    altitude: Number | None = Field(
        default=None, description="height above ground [m], instead of the third entry of position"
    )

    @property
    def ned(self) -> tuple[float, float, float]:
        """North, east, down, m."""
        down = self.position[2] if self.altitude is None else -self.altitude
        return (self.position[0], self.position[1], down)


class Heading(Place):
    """A point with a heading and a velocity."""

    yaw: Number | None = Field(default=None, description="heading [rad], 0 is north, π/2 is east")
    yaw_degrees: Number | None = Field(default=None, description="heading [deg], instead of yaw")
    velocity: Triple = Field(
        default=[0.0, 0.0, 0.0], description="velocity north, east, down [m/s]"
    )

    @property
    def psi(self) -> float:
        """Heading, rad; north when none is given."""
        if self.yaw_degrees is not None:
            return math.radians(self.yaw_degrees)
        return 0.0 if self.yaw is None else self.yaw


class Start(Heading):
    """Where the flight begins, level and without body rates."""


class Goal(Heading):
    """Where the flight ends."""

    reach: Literal["exact", "position", "cost"] = Field(
        default="exact",
        description="'exact' fixes the whole end state (level, no body rates), 'position' the "
        "position only, 'cost' nothing: the tracking objective pulls towards the goal",
    )


class Waypoint(Place):
    """A point to fly by, in the order given."""

    name: str | None = Field(
        default=None, description="what messages call it; 'waypoint 1' by default"
    )
    tolerance: Positive = Field(default=1.0, description="greatest distance from the point [m]")
    at: Annotated[float, Field(gt=0, lt=1)] | None = Field(
        default=None,
        description="when: fraction of the horizon, above 0 and below 1; "
        "by default the share of the straight path flown until there",
    )


class Origin(Section):
    """The place on Earth of north = east = down = 0, WGS 84, for exports."""

    latitude: Annotated[float, Field(ge=-90, le=90)] = Field(description="north is positive [deg]")
    longitude: Annotated[float, Field(ge=-180, le=180)] = Field(
        description="east is positive [deg]"
    )
    altitude: Number = Field(default=0.0, description="above mean sea level [m]")


class FreeHorizon(Section):
    """A duration that the optimiser chooses."""

    lower: Positive = Field(description="shortest duration allowed [s]")
    upper: Positive = Field(description="longest duration allowed [s]")
    guess: Positive | None = Field(
        default=None,
        description="duration to start the search from [s]; by default the geometric middle",
    )


class Horizon(Section):
    """How long the flight takes: a duration, or bounds within which it is free."""

    duration: Positive | None = Field(default=None, description="duration [s]")
    free: FreeHorizon | None = Field(
        default=None, description="bounds of a duration to be optimised [s]"
    )


class Objective(Section):
    """What is minimised.

    The sum of: the term of ``kind``; (u − u_hover)ᵀ diag(R) (u − u_hover) over time; and ``time``
    times the duration.
    """

    kind: Literal["tracking", "minimum-time", "effort", "energy"] = Field(
        description="'tracking': (x − x_goal)ᵀ diag(Q) (x − x_goal) over time plus the same with "
        "Q_final at the end; 'minimum-time': the duration [s]; 'effort': only R; "
        "'energy': shaft energy [kJ], power taken as hover power times (thrust/weight)^1.5"
    )
    Q: Weights | None = Field(
        default=None, description="tracking weights, one per state [1/unit²/s]"
    )
    R: Weights | None = Field(
        default=None,
        description="weights of the control's distance from hover, one per control [1/unit²/s]",
    )
    Q_final: Weights | None = Field(
        default=None, description="tracking weights of the end state, one per state [1/unit²]"
    )
    time: NotNegative = Field(default=0.0, description="price of a second of flight [1/s]")


class Limits(Section):
    """What must not be exceeded, besides the vehicle's own limits, which always hold."""

    speed: Positive | None = Field(default=None, description="greatest ground speed [m/s]")
    speed_per_axis: Annotated[list[Positive], Field(min_length=3, max_length=3)] | None = Field(
        default=None, description="greatest speed north, east, down, either way [m/s]"
    )
    climb: Positive | None = Field(
        default=None, description="greatest vertical speed upwards [m/s]"
    )
    descent: Positive | None = Field(
        default=None, description="greatest vertical speed downwards [m/s]"
    )
    tilt: Steep | None = Field(
        default=None, description="greatest angle of thrust from the vertical [rad], below π/2"
    )
    tilt_degrees: Turn | None = Field(default=None, description="the same [deg], instead of tilt")
    tilt_per_axis: Steep | None = Field(
        default=None, description="greatest roll and pitch angle, each [rad], below π/2"
    )
    body_rates: Annotated[list[Positive], Field(min_length=3, max_length=3)] | None = Field(
        default=None, description="greatest |p|, |q|, |r| [rad/s]"
    )
    acceleration_g: Positive | None = Field(
        default=None, description="greatest acceleration of the vehicle [g]"
    )
    felt_acceleration_g: Positive | None = Field(
        default=None,
        description="greatest departure of the force felt in the cabin (thrust and drag over "
        "mass, body axes) from that at rest [g]",
    )
    control_rates: Annotated[list[Positive], Field(min_length=1)] | None = Field(
        default=None, description="greatest rate of change of each control [unit/s]"
    )
