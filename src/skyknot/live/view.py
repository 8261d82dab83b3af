"""What stands in the page's 3-D scene: ground, obstacles, paths, craft and the handles to drag.

All positions that enter are NED; ``east_north_up`` turns them, and is its own inverse.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.live.adjustable import Adjustable, Place
from skyknot.live.planner import Plan
from skyknot.report.camera import east_north_up
from skyknot.report.craft import craft_shape, span
from skyknot.report.solids import Solid, solids_of
from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]

SAMPLES = 240
HOLDS, COARSE, CERTIFIED = (0, 114, 178), (230, 159, 0), (90, 90, 90)
"""Colours of a path that holds, of one too coarse, and of the last certified one (Okabe & Ito)."""

START, GOAL, BODY, ROOM = (0, 158, 115), (213, 94, 0), (150, 160, 175), (86, 180, 233)
AROUND = 20.0
"""Metres of ground shown around everything."""

CRAFT_SHARE = 0.03
"""Least size of the craft drawn, as a share of the scene."""


class View:
    """The scene of one mission.

    Parameters
    ----------
    server : a viser server
    adjustable : what is flown and what can be moved
    moved : called as ``moved(kind, name, place)`` when a handle is dragged: kind "start", "goal" or
        "obstacle", place NED (an obstacle's is its shift)
    """

    def __init__(
        self,
        server: Any,
        adjustable: Adjustable,
        moved: Callable[[str, str, Place], None],
    ) -> None:
        self._scene, self._adjustable, self._moved = server.scene, adjustable, moved
        wish = adjustable.wish
        self._ends = {"start": wish.start, "goal": wish.goal}
        self._trajectory: Trajectory | None = None
        self.share = 0.0
        self._bodies = self._solids()
        low, high = self._extent()
        self.size = float(np.max(high - low))
        self._scene.set_up_direction("+z")
        self._ground(low, high)
        self._paths = {name: self._line(name) for name in ("certified", "path", "craft")}
        self.handles = {name: self._handle(name, "", place) for name, place in self._ends.items()}
        self._obstacles = {name: self._obstacle(name, solid) for name, solid in self._bodies}
        self._look(server, low, high)

    def _look(self, server: Any, low: Array, high: Array) -> None:
        """Set the camera that every visitor begins with: from the south, high up."""
        middle, camera = 0.5 * (low + high), server.initial_camera
        camera.look_at = tuple(middle * [1, 1, 0])
        camera.position = tuple(middle * [1, 1, 0] + self.size * np.array([0.05, -0.62, 0.78]))

    def show(self, plan: Plan, certified: Plan | None) -> None:
        """Draw a plan, and the last certified one beneath it; a failed plan has no path."""
        self._draw("certified", None if certified is None else certified.trajectory, CERTIFIED)
        self._draw("path", plan.trajectory, HOLDS if plan.holds else COARSE)
        flown = plan if plan.trajectory is not None or certified is None else certified
        self._trajectory = flown.trajectory
        self.place_craft(self.share)

    def place_craft(self, share: float) -> None:
        """Put the craft where it is after a share of the flight's time, 0 to 1."""
        self.share = share
        vehicle, trajectory = self._adjustable.mission.vehicle, self._trajectory
        if trajectory is None:
            self._paths["craft"].visible = False
            return
        state = trajectory.state(trajectory.times[0] + share * trajectory.duration)
        names = self._adjustable.problem.state_names
        angles = np.array(
            [state[names.index(n)] if n in names else 0.0 for n in ("phi", "theta", "psi")]
        )
        scale = max(1.0, CRAFT_SHARE * self.size / span(vehicle))
        shape = craft_shape(vehicle, angles, scale)
        rims = np.stack([shape.discs, np.roll(shape.discs, -1, axis=1)], axis=2)
        lines = np.concatenate([shape.arms, rims.reshape(-1, 2, 3)])
        self._paths["craft"].points = (lines + east_north_up(state[:3])).astype(np.float32)
        self._paths["craft"].visible = True

    def put(self, kind: str, name: str, place: Place) -> None:
        """Move a handle, and an obstacle's body, to where something was put elsewhere."""
        if kind == "obstacle":
            self._obstacles[name](place)
        else:
            self.handles[kind].position = tuple(east_north_up(np.array(place)))

    def _draw(self, name: str, trajectory: Trajectory | None, color: tuple[int, int, int]) -> None:
        line = self._paths[name]
        if trajectory is None:
            line.visible = False
            return
        times = np.linspace(trajectory.times[0], trajectory.times[-1], SAMPLES)
        points = east_north_up(trajectory.state(times)[:, :3])
        line.points = np.stack([points[:-1], points[1:]], axis=1).astype(np.float32)
        line.colors = np.array(color, dtype=np.uint8)
        line.visible = True

    def _line(self, name: str) -> Any:
        thick = {"certified": 2.0, "path": 5.0, "craft": 2.0}[name]
        nothing = np.zeros((1, 2, 3), dtype=np.float32)
        return self._scene.add_line_segments(
            f"/{name}", nothing, (20, 20, 20), thickness=thick, thickness_units="screen"
        )

    def _handle(self, kind: str, name: str, place: Place) -> Any:
        """Return a handle at an end, with a ball to be seen from afar."""
        here = tuple(east_north_up(np.array(place)))
        handle = self._scene.add_transform_controls(
            f"/{kind}", scale=0.08 * self.size, disable_rotations=True, depth_test=False,
            position=here,
        )  # fmt: skip
        color = START if kind == "start" else GOAL
        self._scene.add_icosphere(f"/{kind}/ball", radius=0.01 * self.size, color=color)
        self._scene.add_label(f"/{kind}/label", kind)

        handle.on_update(lambda _: self._moved(kind, name, _down(handle.position)))
        return handle

    def _obstacle(self, name: str, solid: Solid) -> Callable[[Place], None]:
        """Add an obstacle with its handle; return what puts it to a shift (NED, m)."""
        here = solid.vertices.mean(axis=0)
        top = np.array([here[0], here[1], solid.vertices[:, 2].max()])
        index = len([each for each, _ in self._bodies if each <= name])
        body = self._mesh(f"/obstacle {index}", solid, here, BODY, 1.0)
        upright = self._shape(name).kind in ("box", "cylinder")
        handle = self._scene.add_transform_controls(
            f"/handle {index}", scale=0.04 * self.size, disable_rotations=True,
            active_axes=(True, True, not upright), depth_test=False, position=tuple(top),
        )  # fmt: skip
        self._scene.add_label(f"/handle {index}/label", name)

        def put(shift: Place) -> None:
            offset = east_north_up(np.array(shift))
            body.position, handle.position = tuple(here + offset), tuple(top + offset)

        def dragged(_event: Any) -> None:
            shift = east_north_up(np.asarray(handle.position) - top)
            body.position = tuple(here + east_north_up(shift))
            self._moved("obstacle", name, _triple(shift))

        handle.on_update(dragged)
        return put

    def _mesh(
        self, name: str, solid: Solid, here: Array, color: tuple[int, int, int], opacity: float
    ) -> Any:
        vertices, faces = triangles(solid)
        return self._scene.add_mesh_simple(
            name, vertices - here, faces, color=color, flat_shading=True, side="double",
            opacity=None if opacity == 1.0 else opacity, position=tuple(here),
        )  # fmt: skip

    def _ground(self, low: Array, high: Array) -> None:
        middle = 0.5 * (low + high)
        cell = 10.0 ** np.floor(np.log10(self.size / 5))
        self._scene.add_grid(
            "/ground", width=high[0] - low[0], height=high[1] - low[1], cell_size=cell,
            section_size=5 * cell, plane_color=(235, 238, 232), plane_opacity=1.0,
            position=(middle[0], middle[1], -0.02), fade_distance=20 * self.size,
        )  # fmt: skip
        for i, (name, solid) in enumerate(self._rooms):
            here = solid.vertices.mean(axis=0)
            self._mesh(f"/room {i}, {name}", solid, here, ROOM, 0.15)

    def _shape(self, name: str) -> Any:
        return next(g.shape for g in self._adjustable.problem.path if g.name == name)

    def _solids(self) -> list[tuple[str, Solid]]:
        """Return the obstacles; bodies without an upper end are drawn above both ends."""
        top = 3 * max(-self._adjustable.wish.start[2], -self._adjustable.wish.goal[2], 8.0)
        every = [
            (g.name, solid)
            for g in self._adjustable.problem.path
            if g.shape is not None
            for solid in solids_of(g.name, g.shape, 0.0, top)
        ]
        self._rooms = [(name, solid) for name, solid in every if solid.keep_in]
        return [(name, solid) for name, solid in every if not solid.keep_in]

    def _extent(self) -> tuple[Array, Array]:
        ends = east_north_up(np.array(list(self._ends.values())))
        corners = [ends, *(solid.vertices for _, solid in self._bodies)]
        every = np.concatenate(corners)
        margin = np.array([AROUND, AROUND, 0.0])
        return every.min(axis=0) - margin, every.max(axis=0) + margin


def triangles(solid: Solid) -> tuple[Array, NDArray[np.int64]]:
    """Return vertices (V, 3) and triangles (F, 3) of a solid's faces, each face as a fan."""
    faces, first = [], 0
    for face in solid.faces:
        inner = np.arange(1, len(face) - 1)
        faces.append(first + np.stack([0 * inner, inner, inner + 1], axis=1))
        first += len(face)
    return solid.vertices, np.concatenate(faces)


def _down(position: Any) -> Place:
    return _triple(east_north_up(np.asarray(position)))


def _triple(values: Array) -> Place:
    return float(values[0]), float(values[1]), float(values[2])
