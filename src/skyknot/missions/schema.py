"""The mission file as a whole: pure data in TOML, checked strictly, never executed.

Lengths are metres, times seconds, angles radians unless a key ends in ``_degrees``, accelerations
in g where a key ends in ``_g``. Positions are north, east, down (NED).
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from skyknot.missions.schema_airspace import Airspace
from skyknot.missions.schema_flight import Goal, Horizon, Limits, Objective, Origin, Start, Waypoint
from skyknot.missions.schema_solving import Guess, Outputs, Scheme, SolverChoice, Verification
from skyknot.missions.section import Section, Triple


class MissionFile(Section):
    """A skyknot mission: what to fly, from where to where, at what price, how solved."""

    title: Annotated[str, Field(min_length=1)] = Field(description="one line for people")
    description: str = Field(default="", description="what the mission is about")
    vehicle: Annotated[str, Field(min_length=1)] = Field(
        description="name of a vehicle, or path of a vehicle file, seen from the mission file"
    )
    model: Literal["wrench", "rotors", "translational-yaw"] = Field(
        default="wrench",
        description="what is commanded: total thrust and torques; a thrust per rotor; or "
        "acceleration and yaw rate of a point",
    )
    wind: Triple | None = Field(
        default=None,
        description="constant wind velocity north, east, down [m/s]; acts through drag",
    )
    origin: Origin | None = Field(
        default=None, description="where on Earth the axes begin; only exports ask for it"
    )
    start: Start = Field(description="where the flight begins")
    goal: Goal = Field(description="where it ends")
    waypoints: list[Waypoint] = Field(default=[], description="points to fly by, in order")
    horizon: Horizon = Field(description="how long it takes")
    objective: Objective = Field(description="what is minimised")
    limits: Limits = Field(default=Limits(), description="what must not be exceeded")
    airspace: Airspace = Field(
        default=Airspace(), description="obstacles, corridors, altitude band"
    )
    scheme: Scheme = Field(default=Scheme(), description="how it is made finite")
    solver: SolverChoice = Field(default=SolverChoice(), description="how it is solved")
    guess: Guess | None = Field(
        default=None, description="where the search starts; chosen by default"
    )
    verification: Verification = Field(
        default=Verification(), description="limits of the certificate"
    )
    outputs: Outputs = Field(default=Outputs(), description="what a run writes")


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of mission files, for editors."""
    schema = MissionFile.model_json_schema()
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": "skyknot mission",
    }
