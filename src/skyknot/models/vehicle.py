"""A vehicle: the numbers of one craft, checked, with its models.

A `Vehicle` is data. Its public dynamics are those of the wrench model (12 states,
[T, τx, τy, τz]); `rotor_model()` is the same craft with a thrust per rotor,
`translational_yaw_model()` the cheap one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from skyknot.models.allocation import Allocation
from skyknot.models.base import Bounds, Expression, Vector
from skyknot.models.envelope import bounding_box, inscribed_box
from skyknot.models.limits import HoverPower, Limits, WrenchLimits
from skyknot.models.quadrotor import Quadrotor
from skyknot.models.rotor_quadrotor import RotorQuadrotor
from skyknot.models.translational_yaw import TranslationalYaw, flyable_accelerations
from skyknot.models.vehicle_checks import (
    check_drag,
    check_inertia,
    check_kind,
    check_limits,
    check_positive,
    check_power,
    check_rotors,
    check_wrench_limits,
)

KINDS = ("small", "passenger")
"""Classes of vehicle: research and delivery craft, and craft that carry people."""

NO_LIMITS = Limits()
"""What a vehicle of which no limits are known has."""

AIR_DENSITY = 1.225
"""At sea level in the standard atmosphere, kg/m³."""

GUESS_TILT = float(np.deg2rad(30.0))
"""Tilt, rad, that the translational-yaw model plans with at most."""

GUESS_YAW_RATE = 1.0
"""Yaw rate, rad/s, of the translational-yaw model when no limit on r is known."""


@dataclass(frozen=True)
class Vehicle:
    """One craft: mass, inertia, rotors, limits, in SI units and body FRD axes.

    Parameters
    ----------
    name, title : str
        Short name, as in its file; one line for people.
    kind : str
        "small" or "passenger".
    mass, gravity : float
        kg, m/s².
    inertia : (3,) floats
        Ixx, Iyy, Izz about the centre of mass, kg m².
    allocation : Allocation
        Rotor places, spins, torque coefficient.
    thrust_min, thrust_max : float
        Limits of one rotor, N.
    drag : (3,) floats
        Linear drag in body axes, N s/m; part of the dynamics unless zero.
    limits : Limits
        Speed, climb, descent, tilt, body rates.
    wrench_limits : WrenchLimits, optional
        A given wrench box; by default it is inscribed in what the rotors can do.
    rotor_radius : float, optional
        m.
    power : HoverPower, optional
        Facts about hover power.
    notes : tuple of str
        What to know before trusting the numbers.
    sources : dict
        Where each number comes from, by its key in the vehicle file.

    Raises
    ------
    UserError
        If a number cannot belong to a rigid craft that hovers.
    """

    name: str
    title: str
    kind: str
    mass: float
    inertia: tuple[float, float, float]
    gravity: float
    allocation: Allocation
    thrust_min: float
    thrust_max: float
    drag: tuple[float, float, float] = (0.0, 0.0, 0.0)
    limits: Limits = NO_LIMITS
    wrench_limits: WrenchLimits | None = None
    rotor_radius: float | None = None
    power: HoverPower | None = None
    notes: tuple[str, ...] = ()
    sources: dict[str, str] = field(default_factory=dict, compare=False)

    def __post_init__(self) -> None:
        check_kind(self.kind, KINDS)
        check_positive("mass", self.mass, "kg")
        check_positive("gravity", self.gravity, "m/s^2")
        check_inertia(self.inertia)
        check_rotors(self.allocation, self.thrust_min, self.thrust_max, self.weight)
        check_drag(self.drag)
        check_limits(self.limits)
        if self.rotor_radius is not None:
            check_positive("rotor_radius", self.rotor_radius, "m")
        if self.wrench_limits is not None:
            check_wrench_limits(self.wrench_limits, self.weight)
        if self.power is not None:
            check_power(self.power)

    # --- the wrench model, at hand -------------------------------------------------------------

    @cached_property
    def _wrench(self) -> Quadrotor:
        return Quadrotor(
            mass=self.mass,
            inertia=self.inertia,
            gravity=self.gravity,
            allocation=self.allocation,
            wrench_bounds=self._wrench_box(),
            limits=self.limits.state_bounds(),
            drag=self.drag,
            name=self.name,
        )

    def _wrench_box(self) -> Bounds:
        if self.wrench_limits is not None:
            return self.wrench_limits.box()
        return inscribed_box(self.allocation, self.thrust_min, self.thrust_max, self.weight)

    def dynamics(self, x: Sequence[Expression], u: Sequence[Expression]) -> list[Expression]:
        """Return the derivatives of the 12 states under a wrench; see `Quadrotor.dynamics`."""
        return self._wrench.dynamics(x, u)

    @property
    def weight(self) -> float:
        """Return m g, N."""
        return self.mass * self.gravity

    @property
    def thrust_to_weight(self) -> float:
        """Return the thrust of all rotors at their limit over the weight."""
        return self.allocation.rotor_count * self.thrust_max / self.weight

    @property
    def hover_power(self) -> float | None:
        """Return shaft power in hover, W: as known, else ideal by momentum theory, else None.

        Ideal: P = W sqrt(W / (2 ρ A)) with ρ = 1.225 kg/m³ and A the area of all discs.
        """
        if self.power is not None:
            return self.power.hover
        if self.rotor_radius is None:
            return None
        area = self.allocation.rotor_count * np.pi * self.rotor_radius**2
        return float(self.weight * np.sqrt(self.weight / (2 * AIR_DENSITY * area)))

    @property
    def hover(self) -> Vector:
        """Return the hover wrench [m g, 0, 0, 0], N and N m."""
        return self._wrench.trim_control

    @property
    def control_bounds(self) -> Bounds:
        """Return the wrench box, (4,) each.

        Given by the file (`wrench_limits`), or else inscribed: every wrench in it is within the
        rotor limits (`skyknot.models.envelope`). The whole envelope is
        `rotor_model().control_bounds`.
        """
        return self._wrench.control_bounds

    @property
    def wrench_hull(self) -> Bounds:
        """Return the box around all wrenches the rotors can make, (4,) each.

        Only right together with thrust_min <= rotor_thrusts(u) <= thrust_max as a path constraint.
        """
        return bounding_box(self.allocation, self.thrust_min, self.thrust_max)

    @property
    def state_bounds(self) -> Bounds:
        """Return the bounds of the 12 states from the limits, ±inf where free."""
        return self._wrench.state_bounds

    @property
    def rotor_positions(self) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        """Return the rotor hubs in body FRD, m, shape (n, 3)."""
        return self.allocation.rotor_positions

    def rotor_thrusts(self, u: Expression) -> Expression:
        """Return rotor thrusts, N, (..., n), of wrenches (..., 4); CasADi column to column."""
        return self.allocation.rotor_thrusts(u)

    # --- the models ----------------------------------------------------------------------------

    def wrench_model(self) -> Quadrotor:
        """Return the 12-state model commanded by [T, τx, τy, τz]."""
        return self._wrench

    def rotor_model(self) -> RotorQuadrotor:
        """Return the 12-state model commanded by rotor thrusts."""
        return RotorQuadrotor(
            body=self._wrench,
            thrust_min=self.thrust_min,
            thrust_max=self.thrust_max,
            name=f"{self.name} by rotors",
        )

    def translational_yaw_model(self) -> TranslationalYaw:
        """Return the point-and-yaw model within thrust and tilt, at most 30 deg."""
        tilt = GUESS_TILT if self.limits.tilt is None else min(self.limits.tilt, GUESS_TILT)
        rates = self.limits.body_rates
        thrust_max = float(self.control_bounds[1][0])
        return TranslationalYaw(
            mass=self.mass,
            gravity=self.gravity,
            rotor_count=self.allocation.rotor_count,
            acceleration_bounds=flyable_accelerations(self.mass, self.gravity, thrust_max, tilt),
            yaw_rate_limit=GUESS_YAW_RATE if rates is None else min(rates[2], GUESS_YAW_RATE),
            velocity_bounds=self.limits.velocity_bounds(),
            name=f"{self.name} translational yaw",
        )
