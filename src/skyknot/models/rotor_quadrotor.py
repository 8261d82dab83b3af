"""The rigid-body multirotor with one thrust per rotor as control.

Legend
------
f = [f_1 ... f_n] : rotor thrusts, N. A : allocation matrix, [T, τx, τy, τz] = A f.

The exact set of wrenches a craft can make is the image of the box f_min <= f_i <= f_max under A: a
polytope that no box of wrenches describes. With rotor thrusts as controls that set is the plain
control box, so this is the model for manoeuvres near the limits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from skyknot.models.base import Bounds, Expression, Model, Vector
from skyknot.models.quadrotor import SINGULARITY_NOTE, STATE_NAMES, STATE_UNITS, Quadrotor


@dataclass(frozen=True, eq=False)
class RotorQuadrotor(Model):
    """A `Quadrotor` flown by its n rotor thrusts.

    Parameters
    ----------
    body : Quadrotor
        The rigid body, with its allocation, drag, wind and state limits.
    thrust_min, thrust_max : float
        Least and greatest thrust of one rotor, N.
    """

    body: Quadrotor
    thrust_min: float
    thrust_max: float
    name: str = "rotor quadrotor"

    state_names = STATE_NAMES
    state_units = STATE_UNITS
    singularity_note = SINGULARITY_NOTE

    @property
    def control_names(self) -> tuple[str, ...]:
        """Return f1 ... fn."""
        return tuple(f"f{i + 1}" for i in range(self.body.allocation.rotor_count))

    @property
    def control_units(self) -> tuple[str, ...]:
        """Return newtons, n times."""
        return ("N",) * self.body.allocation.rotor_count

    def dynamics(self, x: Sequence[Expression], u: Sequence[Expression]) -> list[Expression]:
        """Return the time derivative of the 12 states, the body's under the wrench A u."""
        return self.body.dynamics(x, self.body.allocation.wrench_components(u))

    def with_wind(self, wind: Sequence[Expression]) -> RotorQuadrotor:
        """Return the same craft in a wind, NED, m/s; entries may be CasADi parameters."""
        return replace(self, body=self.body.with_wind(wind))

    @property
    def trim_state(self) -> Vector:
        """Return hover at the origin, level, nose north."""
        return self.body.trim_state

    @property
    def trim_control(self) -> Vector:
        """Return the rotor thrusts that carry the weight without torque, N."""
        return np.asarray(self.body.rotor_thrusts(self.body.trim_control))

    @property
    def state_bounds(self) -> Bounds:
        """Return the body's state bounds."""
        return self.body.state_bounds

    @property
    def control_bounds(self) -> Bounds:
        """Return thrust_min and thrust_max for every rotor, N."""
        ones = np.ones(self.body.allocation.rotor_count)
        return self.thrust_min * ones, self.thrust_max * ones

    def rotor_thrusts(self, u: Expression) -> Expression:
        """Return the controls themselves, N."""
        return u
