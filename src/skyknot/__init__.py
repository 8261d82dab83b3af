"""Optimal trajectories of multirotor and urban-air-mobility vehicles: computed, proved, shown."""

from __future__ import annotations

import importlib
from types import ModuleType
from typing import TYPE_CHECKING

from skyknot.errors import UserError
from skyknot.problem.airspace import (
    altitude_band,
    box,
    corridor,
    cylinder,
    ellipsoid,
    half_space,
    speed_limit,
    sphere,
    tilt_limit,
)
from skyknot.problem.constraints import PathConstraint, PointConstraint
from skyknot.problem.costs import QuadraticTracking
from skyknot.problem.guess import initial_guess
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.problem.variables import Control, State
from skyknot.solution import Solution
from skyknot.solve import solve
from skyknot.solve_many import solve_many
from skyknot.solvers.interior_point import InteriorPoint
from skyknot.solvers.ipopt import Ipopt
from skyknot.solvers.projected_gradient import ProjectedGradient
from skyknot.status import Status
from skyknot.storage import load, write_csv
from skyknot.trajectory import Trajectory
from skyknot.transcription import (
    Chebyshev,
    Euler,
    HermiteSimpson,
    Lobatto,
    Radau,
    Transcription,
    Trapezoid,
    iteration_matrix_norm,
    stability,
)
from skyknot.transcription.refinement import Refinement
from skyknot.version import __version__

if TYPE_CHECKING:
    from skyknot import missions
    from skyknot.missions import vehicles

__all__ = [
    "Chebyshev",
    "Control",
    "Euler",
    "Free",
    "HermiteSimpson",
    "InteriorPoint",
    "Ipopt",
    "Lobatto",
    "PathConstraint",
    "PointConstraint",
    "Problem",
    "ProjectedGradient",
    "QuadraticTracking",
    "Radau",
    "Refinement",
    "Solution",
    "State",
    "Status",
    "Trajectory",
    "Transcription",
    "Trapezoid",
    "UserError",
    "__version__",
    "altitude_band",
    "box",
    "corridor",
    "cylinder",
    "ellipsoid",
    "half_space",
    "initial_guess",
    "iteration_matrix_norm",
    "load",
    "missions",
    "solve",
    "solve_many",
    "speed_limit",
    "sphere",
    "stability",
    "tilt_limit",
    "vehicles",
    "write_csv",
]

# Rooms entered on request: reading mission files needs pydantic, a third of the import's time.
_ON_REQUEST = {"missions": "skyknot.missions", "vehicles": "skyknot.missions.vehicles"}


def __getattr__(name: str) -> ModuleType:
    """Return a room entered on request."""
    if name in _ON_REQUEST:
        return importlib.import_module(_ON_REQUEST[name])
    raise AttributeError(f"module 'skyknot' has no attribute '{name}'")
