"""A point that accelerates and turns: the cheap model for first guesses.

Legend
------
x = [x y z vx vy vz ψ] : position, velocity (NED, m, m/s), yaw (rad).
u = [ax ay az ψ'] : acceleration (NED, m/s²) and yaw rate (rad/s).
g : gravity (m/s²). T : total thrust (N). m : mass (kg).

The source report (Gautam and Nerella, AOE 5404, section 2) mentions an early "simplified
translational-yaw model" but does not publish its equations. This is the simplest model of that
name whose trajectories lift to the 12-state quadrotor: position and yaw are the quadrotor's flat
outputs, so every smooth trajectory of this model is one of the full model
(`skyknot.models.flatness`). Thrust and tilt are algebraic in the acceleration; body rates need its
rate, torques its second rate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from skyknot.models.base import Bounds, Expression, Model, Vector


@dataclass(frozen=True, eq=False)
class TranslationalYaw(Model):
    """Double integrator in position, single integrator in yaw.

    Parameters
    ----------
    mass, gravity : float
        kg, m/s²; they only turn accelerations into rotor thrusts.
    rotor_count : int
        Number of rotors that share the thrust.
    acceleration_bounds : pair of (3,) arrays
        NED accelerations, m/s²; see `flyable_accelerations`.
    yaw_rate_limit : float
        Bound on |ψ'|, rad/s.
    velocity_bounds : pair of (3,) arrays, optional
        NED velocities, m/s; free by default.
    """

    mass: float
    gravity: float
    rotor_count: int
    acceleration_bounds: Bounds
    yaw_rate_limit: float
    velocity_bounds: Bounds | None = None
    name: str = "translational yaw"

    state_names = ("x", "y", "z", "vx", "vy", "vz", "psi")
    state_units = ("m",) * 3 + ("m/s",) * 3 + ("rad",)
    control_names = ("ax", "ay", "az", "psi_rate")
    control_units = ("m/s^2",) * 3 + ("rad/s",)
    singularity_note = (
        "None of its own, but the lift to the quadrotor fails in free fall (acceleration = "
        "gravity) and at 90 deg of tilt; the default acceleration bounds stay away from both."
    )

    def dynamics(self, x: Sequence[Expression], u: Sequence[Expression]) -> list[Expression]:
        """Return [v, a, ψ']."""
        return [x[3], x[4], x[5], u[0], u[1], u[2], u[3]]

    @property
    def trim_state(self) -> Vector:
        """Return rest at the origin, nose north."""
        return np.zeros(7)

    @property
    def trim_control(self) -> Vector:
        """Return no acceleration, no turn."""
        return np.zeros(4)

    @property
    def state_bounds(self) -> Bounds:
        """Return the velocity bounds, all else free, shape (7,) each."""
        lower, upper = np.full(7, -np.inf), np.full(7, np.inf)
        if self.velocity_bounds is not None:
            lower[3:6], upper[3:6] = self.velocity_bounds
        return lower, upper

    @property
    def control_bounds(self) -> Bounds:
        """Return the acceleration box and the yaw-rate limit, shape (4,) each."""
        lower, upper = self.acceleration_bounds
        return np.append(lower, -self.yaw_rate_limit), np.append(upper, self.yaw_rate_limit)

    def rotor_thrusts(self, u: Expression) -> Expression:
        """Return m |a − g e3| / n for every rotor, N: thrust without the torques' share."""
        acceleration = np.asarray(u)[..., :3] - np.array([0.0, 0.0, self.gravity])
        thrust = self.mass * np.linalg.norm(acceleration, axis=-1, keepdims=True)
        return np.repeat(thrust / self.rotor_count, self.rotor_count, axis=-1)


def flyable_accelerations(
    mass: float, gravity: float, thrust_max: float, tilt_max: float
) -> Bounds:
    """Return an acceleration box every corner of which needs no more than the thrust and tilt.

    Vertical first: half the spare thrust, at most g/4, up and down alike. The horizontal half-width
    is then the largest for which the corners (both horizontal axes at their limit) keep
    m|a − g e3| <= thrust_max when climbing and the tilt when descending.

    Parameters
    ----------
    mass, gravity : float
        kg, m/s².
    thrust_max : float
        Greatest total thrust, N, above the weight.
    tilt_max : float
        Greatest angle of the thrust from the vertical, rad, below π/2.
    """
    spare = thrust_max / mass - gravity
    vertical = min(0.5 * spare, 0.25 * gravity)
    by_thrust = np.sqrt((thrust_max / mass) ** 2 - (gravity + vertical) ** 2)
    by_tilt = (gravity - vertical) * np.tan(tilt_max)
    horizontal = min(by_thrust, by_tilt) / np.sqrt(2.0)
    return (
        np.array([-horizontal, -horizontal, -vertical]),
        np.array([horizontal, horizontal, vertical]),
    )
