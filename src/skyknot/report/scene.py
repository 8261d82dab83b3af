"""A flight with its surroundings: what stands on the stage, and what hides what.

Legend: points are (…, 3), east, north, up, m.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.report.camera import east_north_up
from skyknot.report.craft import span
from skyknot.report.reading import Reading
from skyknot.report.solids import Solid, solids_of
from skyknot.report.stage import Stage, stage_for

Array = NDArray[np.float64]

SAMPLES = 420
"""Points of the path; enough for a smooth line, few enough for a small file."""


@dataclass(frozen=True)
class Scene:
    """A flight with its surroundings, east, north, up.

    Attributes
    ----------
    reading : the solution
    few : whether the picture is small
    """

    reading: Reading
    few: bool = False

    @cached_property
    def times(self) -> Array:
        """(SAMPLES,) s."""
        nodes = self.reading.trajectory.times
        return np.linspace(nodes[0], nodes[-1], SAMPLES)

    @cached_property
    def states(self) -> Array:
        """(SAMPLES, nx)."""
        return self.reading.trajectory.state(self.times)

    @cached_property
    def path(self) -> Array:
        """(SAMPLES, 3) m."""
        return self.place(self.states)

    @cached_property
    def flown(self) -> Array:
        """(K, 3) the open-loop flight, m, as long as it stays on the stage; maybe empty."""
        if self.reading.flown is None:
            return np.zeros((0, 3))
        flown = self.place(self.reading.flown)
        low, high = self.stage.low - 1e-6, self.stage.high + 1e-6
        low[2] -= 0.02 * (high[2] - low[2])  # a landing may end a little below the ground
        gone = ~np.all((flown >= low) & (flown <= high), axis=1)  # true of NaN as well
        return flown[: int(np.argmax(gone)) if np.any(gone) else None]

    def place(self, states: Array) -> Array:
        """Return positions (…, 3), east, north, up."""
        return east_north_up(self.reading.columns(states, "x", "y", "z"))

    @cached_property
    def speed(self) -> Array:
        """(SAMPLES,) m/s; zero where the model has no velocities."""
        if not self.reading.has("vx", "vy", "vz"):
            return np.zeros(SAMPLES)
        velocity = self.reading.columns(self.states, "vx", "vy", "vz")
        result: Array = np.linalg.norm(velocity, axis=1)
        return result

    @property
    def shapes(self) -> list[tuple[str, Any]]:
        """Name and shape of every path constraint that has one."""
        if self.reading.problem is None:
            return []
        return [(g.name, g.shape) for g in self.reading.problem.path if g.shape is not None]

    def solids(self, floor: float, top: float) -> list[Solid]:
        """Return all bodies; those of unlimited height between floor and top."""
        return [solid for name, s in self.shapes for solid in solids_of(name, s, floor, top)]

    @property
    def floor(self) -> float:
        """Height of the ground: zero unless the flight is far above it or below it."""
        low, high = float(self.path[:, 2].min()), float(self.path[:, 2].max())
        standing = any(shape.kind in ("box", "cylinder") for _, shape in self.shapes)
        size = max(high - low, float(np.max(np.ptp(self.path[:, :2], axis=0))), self.smallest)
        if low >= 0 and not standing and low > 2 * size:
            return low - 0.2 * size
        return min(0.0, low)

    @property
    def smallest(self) -> float:
        """Least width of the stage, m: a craft that stays where it is still has room."""
        return 6 * span(self.reading.vehicle)

    @cached_property
    def goal(self) -> Array | None:
        """(3,) the place aimed at, or None."""
        target = self.reading.target
        if target is None:
            return None
        place = self.place(target)
        return None if np.any(np.isnan(place)) else place

    @property
    def misses_by(self) -> float:
        """Distance from the end of the path to the goal, m; zero without a goal."""
        return 0.0 if self.goal is None else float(np.linalg.norm(self.goal - self.path[-1]))

    @cached_property
    def stage(self) -> Stage:
        """Extent and camera."""
        high = float(self.path[:, 2].max())
        bodies = self.solids(self.floor, high)
        others = [solid.vertices for solid in bodies]
        others += [] if self.goal is None else [self.goal[None]]
        around = np.concatenate(others) if others else np.zeros((0, 3))
        return stage_for(self.path, around, self.floor, self.smallest, self.solids, self.few)

    @cached_property
    def bodies(self) -> list[Solid]:
        """All bodies on the stage, the farthest first."""
        camera = self.stage.camera
        found = self.solids(self.stage.floor, self.stage.top)
        return sorted(found, key=lambda solid: float(camera.depth(solid.vertices.mean(axis=0))))

    def hidden(self, P: Array) -> NDArray[np.bool_]:
        """Return (M,) whether an obstacle stands before each point (M, 3)."""
        result = np.zeros(len(P), dtype=bool)
        for solid in self.bodies:
            if not solid.keep_in:
                result |= solid.hides(P, self.stage.camera.ray)
        return result
