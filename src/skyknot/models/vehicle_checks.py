"""What makes the numbers of a vehicle impossible, each told as a UserError."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from skyknot.errors import UserError
from skyknot.models.allocation import Allocation
from skyknot.models.envelope import inscribed_box
from skyknot.models.limits import HoverPower, Limits, WrenchLimits


def check_kind(kind: str, kinds: Sequence[str]) -> None:
    """Raise a UserError unless the kind is one of the kinds."""
    if kind not in kinds:
        _refuse(
            "The kind of vehicle is not known.",
            ("kind", kind, " or ".join(kinds)),
            'Write "passenger" for craft that carry people, "small" for all others.',
        )


def _refuse(what: str, case: tuple[str, object, str], do: str) -> None:
    """Raise a UserError; case is (where, found, expected)."""
    where, found, expected = case
    raise UserError(what, where=where, found=found, expected=expected, do=do)


def check_positive(where: str, value: float, unit: str) -> None:
    """Raise unless the value is finite and above zero."""
    if not (np.isfinite(value) and value > 0.0):
        _refuse(
            f"The {where.replace('_', ' ')} is not positive.",
            (where, f"{value:g} {unit}", f"a finite number above zero, in {unit}"),
            f"Give the {where.replace('_', ' ')} in {unit}, without a sign.",
        )


def check_inertia(inertia: tuple[float, float, float]) -> None:
    """Raise unless the moments are positive and obey the triangle inequality.

    For any mass distribution Ixx + Iyy - Izz = 2 ∫ z² dm >= 0, and so for the other pairs.
    """
    shown = "Ixx, Iyy, Izz = " + ", ".join(f"{moment:g}" for moment in inertia) + " kg m^2"
    if not all(np.isfinite(moment) and moment > 0.0 for moment in inertia):
        _refuse(
            "The inertia is not positive definite.",
            ("inertia", shown, "three moments above zero"),
            "Give the principal moments about the centre of mass, in kg m^2.",
        )
    largest = max(inertia)
    if largest > (1.0 + 1e-9) * (sum(inertia) - largest):
        _refuse(
            "No rigid body has this inertia: one moment exceeds the sum of the other two.",
            ("inertia", shown, "each moment at most the sum of the other two"),
            "Check the units and that all three moments are about the same point.",
        )


def check_rotors(
    allocation: Allocation, thrust_min: float, thrust_max: float, weight: float
) -> None:
    """Raise unless every rotor has room around its hover thrust."""
    if not (np.isfinite(thrust_min) and thrust_min >= 0.0):
        _refuse(
            "The least rotor thrust is negative.",
            ("thrust_min", f"{thrust_min:g} N", "zero or more, in N"),
            "Rotors push one way only; write 0 if the least thrust is not known.",
        )
    check_positive("thrust_max", thrust_max, "N")
    inscribed_box(allocation, thrust_min, thrust_max, weight)


def check_drag(drag: tuple[float, float, float]) -> None:
    """Raise unless the drag coefficients are finite and zero or more."""
    if not all(np.isfinite(entry) and entry >= 0.0 for entry in drag):
        _refuse(
            "The drag would push the craft along.",
            ("drag", list(drag), "three coefficients of zero or more, in N s/m"),
            "Write drag coefficients without a sign.",
        )


def check_limits(limits: Limits) -> None:
    """Raise unless every known limit is positive and the tilt below 90 deg."""
    for where, value, unit in (
        ("speed", limits.speed, "m/s"),
        ("climb", limits.climb, "m/s"),
        ("descent", limits.descent, "m/s"),
        ("tilt", limits.tilt, "rad"),
    ):
        if value is not None:
            check_positive(where, value, unit)
    for rate in limits.body_rates or ():
        check_positive("body_rates", rate, "rad/s")
    if limits.tilt is not None and limits.tilt >= 0.5 * np.pi:
        _refuse(
            "The tilt limit reaches the singularity of the Euler angles.",
            ("tilt", f"{np.rad2deg(limits.tilt):.4g} deg", "less than 90 deg"),
            "Leave the limit out, or give it below 90 deg.",
        )


def check_wrench_limits(limits: WrenchLimits, weight: float) -> None:
    """Raise unless the given box holds hover in its inside."""
    low, high = limits.thrust
    if not low < weight < high:
        _refuse(
            "The given thrust limits do not hold the weight.",
            ("thrust", f"{low:g} to {high:g} N", f"limits around m g = {weight:.4g} N"),
            "Widen the thrust limits or check the mass.",
        )
    for torque in limits.torque:
        check_positive("torque", torque, "N m")


def check_power(power: HoverPower) -> None:
    """Raise unless power is positive, the figure of merit below one, the rating above hover."""
    check_positive("hover", power.hover, "W")
    if power.rated is not None and not power.rated > power.hover:
        _refuse(
            "The rated power does not suffice to hover.",
            ("rated", f"{power.rated:g} W", f"more than the hover power, {power.hover:g} W"),
            "Give both for all rotors together, at the shaft.",
        )
    merit = power.figure_of_merit
    if merit is not None and not 0.0 < merit <= 1.0:
        _refuse(
            "The figure of merit is not a fraction of one.",
            ("figure_of_merit", f"{merit:g}", "above 0, at most 1"),
            "Divide ideal hover power by actual hover power.",
        )
