"""A vehicle written back as the text of its file, for archives and as a start for a new one."""

from __future__ import annotations

import json
from typing import Any

from skyknot.missions.vehicle_form import QUANTITIES, TEXTS
from skyknot.models.vehicle import Vehicle

NO_SOURCE = "not given"


def vehicle_text(vehicle: Vehicle) -> str:
    """Return a vehicle file, SI units and layout "custom", that `vehicles.parse` reads as equal.

    Parameters
    ----------
    vehicle : Vehicle
        Any vehicle, loaded or made in Python; numbers without a source say so.
    """
    values = _values(vehicle)
    lines = [f"{key} = {_quoted(getattr(vehicle, key))}" for key in TEXTS]
    lines.append(f"notes = [{', '.join(_quoted(note) for note in vehicle.notes)}]")
    section = ""
    for key, quantity in QUANTITIES.items():
        value = values.get(key)
        if value is None:
            continue
        head, _, name = key.partition(".")
        if head != section:
            section = head
            lines += ["", f"[{section}]"] + (['layout = "custom"'] if section == "rotors" else [])
        unit = next(iter(quantity.units))
        source = _quoted(_source(vehicle, key))
        lines.append(f'{name} = {{value = {_listed(value)}, unit = "{unit}", source = {source}}}')
    return "\n".join(lines) + "\n"


def _values(vehicle: Vehicle) -> dict[str, Any]:
    """Return the SI value of every key of the form, None where the vehicle has none."""
    limits, wrench, power = vehicle.limits, vehicle.wrench_limits, vehicle.power
    return {
        "body.mass": vehicle.mass,
        "body.inertia": vehicle.inertia,
        "body.gravity": vehicle.gravity,
        "rotors.positions": vehicle.allocation.positions,
        "rotors.spins": vehicle.allocation.spins,
        "rotors.kappa": vehicle.allocation.kappa,
        "rotors.thrust_min": vehicle.thrust_min,
        "rotors.thrust_max": vehicle.thrust_max,
        "rotors.radius": vehicle.rotor_radius,
        "drag.linear": vehicle.drag if any(vehicle.drag) else None,
        "limits.speed": limits.speed,
        "limits.climb": limits.climb,
        "limits.descent": limits.descent,
        "limits.tilt": limits.tilt,
        "limits.body_rates": limits.body_rates,
        "wrench_limits.thrust": wrench and wrench.thrust,
        "wrench_limits.torque": wrench and wrench.torque,
        "power.hover": power and power.hover,
        "power.rated": power and power.rated,
        "power.figure_of_merit": power and power.figure_of_merit,
    }


def _source(vehicle: Vehicle, key: str) -> str:
    """Return the source of a key; that of the arm or levers for the positions they gave."""
    keys = (key, "rotors.arm", "rotors.levers") if key == "rotors.positions" else (key,)
    return next((vehicle.sources[name] for name in keys if name in vehicle.sources), NO_SOURCE)


def _listed(value: Any) -> str:
    """Return a number, or nested tuples of numbers, as TOML that reads back to the bit."""
    if isinstance(value, tuple):
        return f"[{', '.join(_listed(entry) for entry in value)}]"
    return repr(value)


def _quoted(text: str) -> str:
    """Return a TOML basic string."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
