"""Readers of exported files: other people's libraries, and arithmetic of their own."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

HOME = (37.2296, -80.4139, 634.0)
"""Where the test flights begin on Earth."""


@dataclass(frozen=True)
class Read:
    """What a file says: times, and whatever else is in it, in its own frame.

    ``quaternions`` have w first, whatever the file's order; ``text`` is all the words in it.
    """

    frame: str
    text: str
    times: np.ndarray
    position: np.ndarray
    velocity: np.ndarray | None = None
    acceleration: np.ndarray | None = None
    quaternions: np.ndarray | None = None
    rates: np.ndarray | None = None
    angular_acceleration: np.ndarray | None = None
    world_rates: np.ndarray | None = None
    yaw: np.ndarray | None = None
    yaw_rate: np.ndarray | None = None
    rotors: np.ndarray | None = None


def read_csv(path: Path) -> Read:
    lines = path.read_text(encoding="utf-8").splitlines()
    words = [line for line in lines if line.startswith("#")]
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))

    def columns(*names):
        return np.array([[float(row[name]) for name in names] for row in rows])

    def vector(quantity):
        return columns(*(f"{quantity}_{axis}" for axis in "xyz"))

    text = "\n".join(words)
    return Read(
        frame="enu" if "frame: ENU" in text else "ned",
        text=text,
        times=columns("t")[:, 0],
        position=vector("p"),
        velocity=vector("v"),
        acceleration=vector("a_lin"),
        quaternions=columns("q_w", "q_x", "q_y", "q_z"),
        rates=vector("w"),
        angular_acceleration=vector("a_rot"),
        rotors=columns("u_1", "u_2", "u_3", "u_4"),
    )


READERS = {"csv": read_csv}
"""A reader for every format."""
