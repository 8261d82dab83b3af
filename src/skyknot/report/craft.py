"""The craft, drawn from its rotor places, radius and attitude.

Legend: R body-to-inertial rotation, ZYX Euler angles, NED; body axes forward, right, down.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.report.camera import east_north_up
from skyknot.report.reading import Reading

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CraftShape:
    """A craft at one moment, as offsets from its centre: east, north, up, m.

    Attributes
    ----------
    arms : (n, 2, 3) from the middle to each hub
    discs : (n, k, 3) rims of the rotors
    hull : (k, 3) outline of the body
    front : (n,) whether the rotor lies ahead of the middle
    """

    arms: Array
    discs: Array
    hull: Array
    front: NDArray[np.bool_]


def craft_shape(vehicle: Any, angles: Array, scale: float) -> CraftShape:
    """Return the craft at roll, pitch, yaw ``angles`` (3,) [rad], ``scale`` times its size."""
    hubs = np.asarray(vehicle.rotor_positions, dtype=float)
    radius = rotor_radius(vehicle)
    rise = np.array([0.0, 0.0, -0.18 * radius])
    turn = np.linspace(0, 2 * np.pi, 30, endpoint=False)
    rim = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=-1)
    reach = float(np.max(np.linalg.norm(hubs, axis=1)))
    stretched = rim * np.array([0.34, 0.2, 0.0]) * reach

    def placed(body: Array) -> Array:
        return scale * east_north_up(body @ rotation(*angles).T)

    return CraftShape(
        arms=placed(np.stack([0 * hubs, hubs], axis=1)),
        discs=placed(hubs[:, None] + rise + radius * rim),
        hull=placed(stretched),
        front=hubs[:, 0] > 1e-9,
    )


def rotor_radius(vehicle: Any) -> float:
    """Return the rotor's radius, m; 0.42 of the least distance between hubs where not known."""
    if vehicle.rotor_radius is not None:
        return float(vehicle.rotor_radius)
    hubs = np.asarray(vehicle.rotor_positions, dtype=float)
    apart = np.linalg.norm(hubs[:, None] - hubs[None], axis=-1)
    return 0.42 * float(np.min(apart[apart > 0]))


def span(vehicle: Any) -> float:
    """Return the largest distance over the craft, rotors included, m."""
    hubs = np.asarray(vehicle.rotor_positions, dtype=float)
    return 2 * (float(np.max(np.linalg.norm(hubs, axis=1))) + rotor_radius(vehicle))


def attitude(reading: Reading, states: Array) -> Array:
    """Return (M, 3) roll, pitch, yaw; zero for angles that the model does not have."""
    angles = np.zeros((len(states), 3))
    for i, name in enumerate(("phi", "theta", "psi")):
        if reading.has(name):
            angles[:, i] = reading.columns(states, name)[:, 0]
    return angles


def rotation(roll: float, pitch: float, yaw: float) -> Array:
    """Return R of equation (5) of the source report as Rz(ψ) Ry(θ) Rx(φ)."""
    cosine, sine = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    Rx = np.array([[1, 0, 0], [0, cosine[0], -sine[0]], [0, sine[0], cosine[0]]])
    Ry = np.array([[cosine[1], 0, sine[1]], [0, 1, 0], [-sine[1], 0, cosine[1]]])
    Rz = np.array([[cosine[2], -sine[2], 0], [sine[2], cosine[2], 0], [0, 0, 1]])
    result: Array = Rz @ Ry @ Rx
    return result
