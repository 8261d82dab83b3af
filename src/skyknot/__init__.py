"""Optimal trajectories of multirotor and urban-air-mobility vehicles: computed, proved, shown."""

from skyknot import missions
from skyknot.errors import UserError
from skyknot.missions import vehicles
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
from skyknot.solvers.ipopt import Ipopt
from skyknot.status import Status
from skyknot.storage import load, write_csv
from skyknot.trajectory import Trajectory
from skyknot.transcription import Euler, HermiteSimpson, Transcription, Trapezoid
from skyknot.version import __version__

__all__ = [
    "Control",
    "Euler",
    "Free",
    "HermiteSimpson",
    "Ipopt",
    "PathConstraint",
    "PointConstraint",
    "Problem",
    "QuadraticTracking",
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
    "load",
    "missions",
    "solve",
    "solve_many",
    "speed_limit",
    "sphere",
    "tilt_limit",
    "vehicles",
    "write_csv",
]
