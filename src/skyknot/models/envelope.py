r"""Boxes of wrenches for a craft whose rotors are what is limited.

Legend
------
w = [T, τx, τy, τz] : wrench. f : rotor thrusts, f_min <= f_i <= f_max. B = A⁺ : f = B w, (n, 4).
f_h : largest or smallest rotor thrust at hover. δ : thrust per rotor set aside for torques, N.

What the rotors can do is the polytope {A f}. Two boxes describe it:

*inscribed* : every wrench of the box can be flown. δ = ½ min(f_h − f_min, f_max − f_h); torque j
may use the share c_j of it, τ_j = c_j δ / max_i |B_ij| with c = (0.4, 0.4, 0.2), and the thrust
keeps clear of the rest, (f_min + δ)/B_i1 <= T <= (f_max − δ)/B_i1 for all i. Then
Σ_j |B_ij| τ_j <= δ for every rotor, which proves the claim. It gives up the corners of the
envelope.

*bounding* : no wrench outside it can be flown, but most of its corners cannot either. It is only
right together with the path constraint f_min <= B w <= f_max.

A vehicle bounds its wrench by the inscribed box, because a plan made with a plain box and nothing
else must be flyable. For the whole envelope use the rotor model, whose control box is exact.
"""

from __future__ import annotations

import numpy as np

from skyknot.errors import UserError
from skyknot.models.allocation import Allocation
from skyknot.models.base import Bounds

TORQUE_RESERVE = 0.5
"""Part of the rotor's margin around hover that is set aside for torques."""

TORQUE_SHARES = np.array([0.4, 0.4, 0.2])
"""How roll, pitch and yaw divide the reserve; yaw least, since it acts on no position."""


def inscribed_box(
    allocation: Allocation, thrust_min: float, thrust_max: float, weight: float
) -> Bounds:
    """Return a wrench box, (4,) each, all of which maps to rotor thrusts within limits.

    Parameters
    ----------
    allocation : Allocation
        Rotor places and spins.
    thrust_min, thrust_max : float
        Limits of one rotor, N.
    weight : float
        m g, N; lies strictly inside the thrust range returned.

    Raises
    ------
    UserError
        If some rotor is outside its limits at hover.
    """
    B = allocation.inverse
    hover = B[:, 0] * weight
    margin = min(float(hover.min()) - thrust_min, thrust_max - float(hover.max()))
    if margin <= 0.0:
        raise UserError(
            "The vehicle cannot hover within its rotor limits.",
            where="thrust_max",
            found=f"hover needs {hover.min():.4g} to {hover.max():.4g} N per rotor",
            expected=f"strictly between {thrust_min:.4g} and {thrust_max:.4g} N",
            do="Check mass, rotor limits and rotor positions (centre of mass at the origin).",
        )
    reserve = TORQUE_RESERVE * margin
    torque = TORQUE_SHARES * reserve / np.abs(B[:, 1:]).max(axis=0)
    lower = float(np.max((thrust_min + reserve) / B[:, 0]))
    upper = float(np.min((thrust_max - reserve) / B[:, 0]))
    return np.array([lower, *-torque]), np.array([upper, *torque])


def bounding_box(allocation: Allocation, thrust_min: float, thrust_max: float) -> Bounds:
    """Return the least wrench box, (4,) each, that holds every wrench the rotors can make."""
    A = allocation.matrix
    positive, negative = np.maximum(A, 0.0).sum(axis=1), np.minimum(A, 0.0).sum(axis=1)
    lower = positive * thrust_min + negative * thrust_max
    upper = positive * thrust_max + negative * thrust_min
    return lower, upper
