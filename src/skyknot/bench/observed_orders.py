"""Observed orders of the schemes, and the spectral decay of one long segment.

Legend: N segments, s points, order p: error ~ N^−p, the slope of a line through log error against
log N over three meshes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.bench.smooth_problems import SmoothProblem
from skyknot.solution import Solution
from skyknot.solve import solve
from skyknot.transcription import (
    Chebyshev,
    Euler,
    HermiteSimpson,
    Lobatto,
    Radau,
    Transcription,
    Trapezoid,
)
from skyknot.transcription.table import Orders

Array = NDArray[np.float64]

QUANTITIES = ("states", "controls", "costates")

# Meshes by the claimed order of the states: in the asymptotic range, and above rounding; the first
# row for the linear problem, the second for the curved one.
MESHES = {
    1: ((320, 640, 1280), (320, 640, 1280)),
    2: ((80, 160, 320), (80, 160, 320)),
    3: ((40, 80, 160), (160, 320, 640)),
    4: ((60, 90, 135), (160, 240, 360)),
    5: ((24, 36, 54), (60, 90, 135)),
    6: ((24, 36, 54), (80, 120, 180)),
    7: ((12, 18, 27), ()),
    8: ((12, 16, 24), (8, 12, 16)),
}
"""No mesh shows order 7 on the curved problem: its asymptotic range begins below rounding."""

ROUNDING = 1e-14
"""An error below it shows no order."""


@dataclass(frozen=True)
class Case:
    """A scheme with its own number of points and a control parametrisation.

    Attributes
    ----------
    scheme : name in mission files
    points : points of a segment where one can choose, else None
    controls : control parametrisation
    """

    scheme: str
    points: int | None
    controls: str

    def on(self, segments: int) -> Transcription:
        """Return the scheme on a uniform mesh."""
        if self.points is None:
            fixed = {"euler": Euler, "trapezoid": Trapezoid, "hermite-simpson": HermiteSimpson}
            made = fixed[self.scheme](segments)
            return Transcription(made.table, made.nodes, controls=self.controls)
        free = {"lobatto": Lobatto, "radau": Radau, "chebyshev": Chebyshev}
        return free[self.scheme](segments, self.points, controls=self.controls)

    @property
    def claimed(self) -> Orders:
        """What the table claims."""
        return self.on(1).table.orders[self.controls]


def cases() -> tuple[Case, ...]:
    """Return every scheme with every parametrisation; of the families two to four members."""
    members: dict[str, tuple[int | None, ...]] = {
        "euler": (None,),
        "trapezoid": (None,),
        "hermite-simpson": (None,),
        "lobatto": (3, 4, 5),
        "radau": (1, 2, 3, 4),
        "chebyshev": (4, 5, 6, 7),
    }
    return tuple(
        Case(scheme, points, controls)
        for scheme, counts in members.items()
        for points in counts
        for controls in Case(scheme, points, "hold").on(1).table.orders
    )


def errors(smooth: SmoothProblem, solution: Solution) -> Array:
    """Return the largest errors of states, controls and costates.

    States and costates at the nodes, controls at the scheme's own points.
    """
    inside, t = solution.trajectory.segments, solution.times
    assert inside is not None
    places = t[:-1, None] + np.diff(t)[:, None] * inside.control_points
    return np.array(
        [
            np.abs(solution.states[:, 0] - smooth.state(t)).max(),
            np.abs(inside.control_values[..., 0] - smooth.control(places)).max(),
            np.abs(solution.costates[:, 0] - smooth.costate(t)).max(),
        ]
    )


def observed(case: Case, smooth: SmoothProblem) -> dict[str, float]:
    """Return the observed orders of states, controls and costates over three meshes.

    Quantities are missing where no three meshes show an order in double precision.
    """
    meshes = MESHES[case.claimed.states][smooth.problem.name == "curved"]
    if not meshes:
        return {}
    found = np.array([errors(smooth, _solved(case.on(N), smooth)) for N in meshes])
    slopes = -np.polyfit(np.log(meshes), np.log(found), 1)[0]
    shown = found.min(axis=0) > ROUNDING
    return {name: float(slopes[i]) for i, name in enumerate(QUANTITIES) if shown[i]}


def decay(scheme: str, smooth: SmoothProblem, points: tuple[int, ...]) -> Array:
    """Return (len(points), 3) errors of states, controls and costates with one segment.

    States and controls are compared at 500 times, costates at the scheme's own points.
    """
    rows, t = [], np.linspace(0.0, smooth.problem.duration_guess, 500)
    for s in points:
        solution = _solved(Case(scheme, s, "polynomial").on(1), smooth)
        inside = solution.trajectory.segments
        assert inside is not None
        places = np.concatenate([[0.0], inside.interior_points, [1.0]]) * solution.times[-1]
        ends = solution.costates
        p = np.concatenate([ends[:1], solution.interior_costates[0], ends[1:]])
        rows.append(
            [
                np.abs(solution.state(t)[:, 0] - smooth.state(t)).max(),
                np.abs(solution.control(t)[:, 0] - smooth.control(t)).max(),
                np.abs(p[:, 0] - smooth.costate(places)).max(),
            ]
        )
    return np.array(rows)


def _solved(scheme: Transcription, smooth: SmoothProblem) -> Solution:
    return solve(smooth.problem, scheme, guess=smooth.guess, tolerance=1e-14)
