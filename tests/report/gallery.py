"""Solutions to draw: a flight among every kind of obstacle, a rail, and their odd relatives."""

from dataclasses import replace
from functools import cache

import numpy as np

from skyknot.missions import vehicles
from skyknot.problem import airspace
from skyknot.problem.constraints import PathConstraint, PointConstraint
from skyknot.problem.problem import Problem
from skyknot.problem.variables import Control, State
from skyknot.solution import Solution
from skyknot.solve import solve
from skyknot.solvers.ipopt import Ipopt
from skyknot.trajectory import Trajectory
from skyknot.transcription import HermiteSimpson

SURROUNDINGS = (
    airspace.box("hall", (4.0, 9.0, -2.0), (3.0, 4.0, 4.0), yaw=0.3),
    airspace.cylinder("mast", (9.0, 1.0), 0.8),
    airspace.sphere("balloon", (2.0, 5.0, -8.0), 1.0),
    airspace.ellipsoid("tree", (8.0, 9.0, -1.5), (1.0, 1.0, 1.5)),
    airspace.half_space("fence", (1.0, 0.0, 0.0), -3.0),
    airspace.altitude_band("band", -0.5, 7.0),
    airspace.tube("lane", [(0, 0, 0), (4, 3, -3), (8, 6, -5)], 3.0),
    airspace.corridor("street", (0, 0, -2.5), (8, 6, -2.5), 6.0),
)


def flight_problem(model_name: str = "wrench", vehicle: str = "report", **changes) -> Problem:
    """Return a transfer of 11 m by one of the vehicle's models."""
    craft = vehicles.load(vehicle)
    model = {
        "wrench": craft.wrench_model,
        "rotor": craft.rotor_model,
        "yaw": craft.translational_yaw_model,
    }[model_name]()
    nx = len(model.state_names)
    choices = {
        "name": f"{model_name} transfer",
        "states": [State(*pair) for pair in zip(model.state_names, model.state_units, strict=True)],
        "controls": [
            Control(*pair) for pair in zip(model.control_names, model.control_units, strict=True)
        ],
        "dynamics": model.dynamics,
        "horizon": 6.0,
        "initial": [0.0] * nx,
        "final": [8.0, 6.0, -5.0] + [0.0] * (nx - 3),
        "running_cost": lambda x, u: sum(
            (u[i] - model.trim_control[i]) ** 2 for i in range(len(model.control_names))
        ),
        "control_bounds": model.control_bounds,
        "state_bounds": model.state_bounds,
        "vehicle": craft,
    }
    return Problem(**(choices | changes))


@cache
def flight(model_name: str = "wrench") -> Solution:
    """Return a solved flight; the wrench model flies among all surroundings."""
    path = SURROUNDINGS if model_name == "wrench" else ()
    return solve(flight_problem(model_name, path=path), HermiteSimpson(12))


@cache
def rail() -> Solution:
    """Return a solved problem without a vehicle."""
    problem = Problem(
        "rail",
        [State("x", "m"), State("v", "m/s")],
        [Control("a", "m/s²")],
        lambda x, u, p: [x[1], u[0] - p.drag * x[1]],
        2.0,
        initial=[0, 0],
        final=[1, 0],
        running_cost=lambda x, u: u[0] ** 2,
        state_bounds=(None, [None, 0.9]),
        control_bounds=(-3, 3),
        path=[PathConstraint("fence", lambda x, u: x[0], upper=1.2, unit="m")],
        points=[PointConstraint("gate", lambda x, u: x[0], at=0.5, lower=0.45, unit="m")],
        parameters={"drag": 0.2},
    )
    return solve(problem, HermiteSimpson(20))


@cache
def unsolved() -> Solution:
    """Return a flight given up after two iterations."""
    return solve(flight_problem(), HermiteSimpson(12), solver=Ipopt(max_iterations=2))


@cache
def without_problem() -> Solution:
    """Return a flight as it comes back from a file."""
    return replace(flight(), problem=None)


def flown_along(points, vehicle: str = "hummingbird", duration: float = 20.0) -> Solution:
    """Return a solution whose trajectory visits points (n, 3), NED, evenly; dynamics not heeded."""
    problem = flight_problem(vehicle=vehicle, horizon=duration, final=None)
    t = np.linspace(0.0, duration, 21)
    share = np.linspace(0, duration, len(points))
    states = np.zeros((21, 12))
    states[:, :3] = np.stack([np.interp(t, share, np.array(points)[:, i]) for i in range(3)], 1)
    states[:, 3:6] = np.gradient(states[:, :3], t, axis=0)
    controls = np.tile(problem.vehicle.hover, (21, 1))
    names = problem.state_names, problem.control_names
    trajectory = Trajectory(t, states, controls, None, *names)
    costates = np.zeros_like(states)
    return replace(unsolved(), problem=problem, trajectory=trajectory, costates=costates)


SOLUTIONS = {
    "flight": flight,
    "flight by rotors": lambda: flight("rotor"),
    "flight by a point": lambda: flight("yaw"),
    "rail": rail,
    "unsolved": unsolved,
    "from a file": without_problem,
    "hover": lambda: flown_along([(0, 0, -1), (0, 0, -1)], "crazyflie"),
    "climb": lambda: flown_along([(0, 0, 0), (0, 0, -40)]),
    "long haul": lambda: flown_along(
        [(0, 0, 0), (100, 50, -300), (12e3, 9e3, -300), (12e3, 9e3, 0)], "nasa_six_passenger", 600
    ),
}
