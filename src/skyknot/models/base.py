"""Contract of the models room: what flies, as xdot = f(x, u).

Whoever adds a model owes the following.

1.  Subclass `Model` in a file of its own named by its noun; make it a final, frozen object, valid
    when built. Tweak a model by wrapping it, never by overriding a written method.
2.  `dynamics(x, u)` returns a list with one entry per state, in the order of `state_names`.
    Components come first: `x[i]` may be a CasADi SX, MX or DM entry, a float, a complex number, or
    an array of any shape, so that one text serves solvers, complex-step tests and vectorised
    simulation. Pass time-first arrays as `dynamics(states.T, controls.T)`. Use
    `skyknot.models.elementary` for sine and cosine and Python floats for constants; branch on
    nothing.
3.  It takes exactly two arguments and has no side effects: same input, same output.
4.  SI units and the NED frame: x north, y east, z down; body axes forward, right, down; thrust
    along minus body z; ZYX Euler angles. Conversions belong to whoever reads or writes another
    frame.
5.  `state_names`, `state_units`, `control_names`, `control_units` are what messages and figures
    say: every name short, unique, and as the literature writes it.
6.  `trim_state`, `trim_control` is a hover: `dynamics(trim_state, trim_control)` is zero to
    rounding in still air.
7.  `control_bounds` are finite and enclose `trim_control` strictly; `state_bounds` carry ±inf where
    the state is free and enclose `trim_state`.
8.  `state_scales`, `control_scales` are positive typical magnitudes in the same units.
9.  `rotor_thrusts(u)` maps controls, time first, to the thrust of every rotor in newtons.
10. `singularity_note` says in a sentence where the model stops being valid ("" if nowhere).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Expression: TypeAlias = Any
"""A CasADi entry, a real or complex number, or an array of them."""

Vector: TypeAlias = NDArray[np.float64]
"""A one-dimensional array of floats."""

Bounds: TypeAlias = tuple[Vector, Vector]
"""Lower and upper bounds, one entry per component."""

UNIT_SCALES = {"m": 10.0, "m/s": 3.0, "rad": 1.0, "rad/s": 2.0}
"""Typical magnitudes where neither a bound nor the trim tells one."""


class Model(ABC):
    """A vehicle's equations of motion with names, units, bounds and a hover."""

    frame = "NED"
    singularity_note = ""

    @property
    @abstractmethod
    def name(self) -> str:
        """Return the name of the model."""

    @property
    @abstractmethod
    def state_names(self) -> tuple[str, ...]:
        """Return the names of the states, in order."""

    @property
    @abstractmethod
    def state_units(self) -> tuple[str, ...]:
        """Return the units of the states, in order."""

    @property
    @abstractmethod
    def control_names(self) -> tuple[str, ...]:
        """Return the names of the controls, in order."""

    @property
    @abstractmethod
    def control_units(self) -> tuple[str, ...]:
        """Return the units of the controls, in order."""

    @abstractmethod
    def dynamics(self, x: Sequence[Expression], u: Sequence[Expression]) -> list[Expression]:
        """Return the time derivative of every state, components first.

        Parameters
        ----------
        x : sequence of nx components
            CasADi symbols, numbers (real or complex) or equally shaped arrays, in `state_units`.
        u : sequence of nu components
            As x, in `control_units`.
        """

    @property
    @abstractmethod
    def trim_state(self) -> Vector:
        """Return a hovering state at the origin, shape (nx,)."""

    @property
    @abstractmethod
    def trim_control(self) -> Vector:
        """Return the control that holds `trim_state`, shape (nu,)."""

    @property
    @abstractmethod
    def state_bounds(self) -> Bounds:
        """Return lower and upper state bounds, shape (nx,) each, ±inf where free."""

    @property
    @abstractmethod
    def control_bounds(self) -> Bounds:
        """Return lower and upper control bounds, shape (nu,) each, finite."""

    @abstractmethod
    def rotor_thrusts(self, u: Expression) -> Expression:
        """Return the thrust of each rotor, N, shape (..., rotors), for controls (..., nu).

        A CasADi column of controls gives a CasADi column of thrusts.
        """

    @property
    def state_scales(self) -> Vector:
        """Return positive typical magnitudes of the states, shape (nx,)."""
        return typical_magnitudes(self.trim_state, self.state_bounds, self.state_units)

    @property
    def control_scales(self) -> Vector:
        """Return positive typical magnitudes of the controls, shape (nu,)."""
        return typical_magnitudes(self.trim_control, self.control_bounds, self.control_units)


def typical_magnitudes(trim: Vector, bounds: Bounds, units: Sequence[str]) -> Vector:
    """Return the larger of |trim| and half the bounded range, or the unit's own scale if free.

    Parameters
    ----------
    trim : array, shape (n,)
        Values at hover.
    bounds : pair of arrays, shape (n,) each
        Lower and upper bounds, ±inf where free.
    units : sequence of n str
        Unit names; those in `UNIT_SCALES` have a scale of their own, others 1.
    """
    lower, upper = bounds
    half_range = 0.5 * (upper - lower)
    fallback = np.array([UNIT_SCALES.get(unit, 1.0) for unit in units])
    return np.where(np.isfinite(half_range), np.maximum(half_range, np.abs(trim)), fallback)
