"""CSV with the columns of the Robotics and Perception Group's planners.

The thirty columns and their order are those that time-optimal planners and Agilicious exchange
(FSC-Lab/TOGT-Planner, MincoSnapTrajectory::save; uzh-rpg/rpg_time_optimal): time, position,
attitude quaternion with w first, velocity, body rates, linear and angular acceleration, the four
rotor thrusts, jerk, snap. Velocity, acceleration, jerk and snap are in world axes, rates and
angular acceleration in body axes. Lines before the header begin with "#".
"""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.export.base import Encoded, Format, Request
from skyknot.export.frames import enu_attitude_from_ned, enu_from_ned, flu_from_frd
from skyknot.export.samples import Attitude, Flight

Array = NDArray[np.float64]

AXES = {
    "ned": "frame: NED: world x north, y east, z down; body x forward, y right, z down",
    "enu": "frame: ENU: world x east, y north, z up; body x forward, y left, z up",
}


@dataclass(frozen=True)
class Columns:
    """A flight's vectors in the axes that are written.

    Attributes
    ----------
    world : (M, 3) position, velocity, acceleration, jerk, snap
    quaternions : (M, 4) w first
    rates, accelerations : (M, 3) body
    """

    world: tuple[Array, ...]
    quaternions: Array
    rates: Array
    accelerations: Array


def columns_of(flight: Flight, attitude: Attitude, frame: str) -> Columns:
    """Return a flight's vectors in the frame "ned" or "enu"."""
    vectors = (flight.position, flight.velocity, flight.acceleration, flight.jerk, flight.snap)
    turning = attitude.rates, attitude.accelerations
    if frame == "ned":
        return Columns(vectors, attitude.quaternions, *turning)
    return Columns(
        tuple(enu_from_ned(vector) for vector in vectors),
        enu_attitude_from_ned(attitude.quaternions),
        *(flu_from_frd(vector) for vector in turning),
    )


def encode(request: Request) -> Encoded:
    """Return the table; ``u_i`` are rotor thrusts in newtons, in the vehicle file's order."""
    flight = request.sampled
    assert flight.attitude is not None
    assert flight.rotor_thrusts is not None
    given = columns_of(flight, flight.attitude, request.frame)
    position, velocity, acceleration, jerk, snap = given.world
    rotors = flight.rotor_thrusts.shape[1]
    parts = {
        ("t",): flight.times[:, None],
        _named("p"): position,
        tuple(f"q_{axis}" for axis in "wxyz"): given.quaternions,
        _named("v"): velocity,
        _named("w"): given.rates,
        _named("a_lin"): acceleration,
        _named("a_rot"): given.accelerations,
        tuple(f"u_{i + 1}" for i in range(rotors)): flight.rotor_thrusts,
        _named("jerk"): jerk,
        _named("snap"): snap,
    }
    header = [
        f"# skyknot trajectory: {request.title}",
        f"# {request.verdict}",
        f"# {AXES[request.frame]}",
        "# units: s, m, rad, N; q: body to world, w first; w, a_rot: body axes; "
        f"u: thrusts of {rotors} rotors",
        ",".join(name for names in parts for name in names),
    ]
    stream = io.BytesIO()
    table = np.hstack(list(parts.values()))
    np.savetxt(stream, table, "%.17g", ",", header="\n".join(header), comments="", encoding="utf-8")
    return Encoded(stream.getvalue(), "numbers to their last bit")


def _named(quantity: str) -> tuple[str, ...]:
    return tuple(f"{quantity}_{axis}" for axis in "xyz")


CSV = Format(
    name="csv",
    title="CSV with the columns of the RPG planners",
    file_name="flight.csv",
    encode=encode,
    frames=("ned", "enu"),
    rate=100.0,
    needs=("attitude", "rotors"),
)
