"""What a vehicle must not exceed, apart from its rotors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from skyknot.models.base import Bounds
from skyknot.models.quadrotor import PITCH_LIMIT


@dataclass(frozen=True)
class Limits:
    """Limits of flight; None where nothing is known.

    Parameters
    ----------
    speed : float or None
        Ground speed, m/s.
    climb, descent : float or None
        Greatest vertical speed up and down, m/s, both positive.
    tilt : float or None
        Greatest angle of thrust from the vertical, rad, below π/2.
    body_rates : (3,) floats or None
        Greatest |p|, |q|, |r|, rad/s.
    """

    speed: float | None = None
    climb: float | None = None
    descent: float | None = None
    tilt: float | None = None
    body_rates: tuple[float, float, float] | None = None

    def velocity_bounds(self) -> Bounds:
        """Return NED velocity bounds, (3,) each: per axis, so a box around the true speed ball.

        Up is negative z. The norm |v| <= speed is a path constraint and left to the problem.
        """
        speed = np.inf if self.speed is None else self.speed
        climb = speed if self.climb is None else min(self.climb, speed)
        descent = speed if self.descent is None else min(self.descent, speed)
        return np.array([-speed, -speed, -climb]), np.array([speed, speed, descent])

    def state_bounds(self) -> Bounds:
        """Return the bounds of the 12 quadrotor states, ±inf where free.

        |θ| never exceeds 85 deg. A tilt limit bounds φ and θ each, a box around the true cone
        cos φ cos θ >= cos(tilt), which is left to a path constraint of the problem.
        """
        lower, upper = np.full(12, -np.inf), np.full(12, np.inf)
        lower[3:6], upper[3:6] = self.velocity_bounds()
        if self.tilt is not None:
            upper[6] = self.tilt
        upper[7] = PITCH_LIMIT if self.tilt is None else min(self.tilt, PITCH_LIMIT)
        if self.body_rates is not None:
            upper[9:] = self.body_rates
        lower[6:] = -upper[6:]
        return lower, upper


@dataclass(frozen=True)
class WrenchLimits:
    """A wrench box that is given rather than derived from the rotors.

    Parameters
    ----------
    thrust : (2,) floats
        Least and greatest total thrust, N.
    torque : (3,) floats
        Greatest |τx|, |τy|, |τz|, N m.
    """

    thrust: tuple[float, float]
    torque: tuple[float, float, float]

    def box(self) -> Bounds:
        """Return lower and upper [T, τx, τy, τz], (4,) each."""
        torque = np.array(self.torque)
        return np.array([self.thrust[0], *-torque]), np.array([self.thrust[1], *torque])


@dataclass(frozen=True)
class HoverPower:
    """What hovering costs, where it is known.

    Parameters
    ----------
    hover : float
        Shaft power of all rotors in hover at sea level, W.
    rated : float or None
        Rated shaft power of all rotors together, W.
    figure_of_merit : float or None
        Ideal over actual hover power.
    """

    hover: float
    rated: float | None = None
    figure_of_merit: float | None = None
