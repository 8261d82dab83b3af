"""From a checked mission file and its vehicle to a Problem.

Legend: x states, u controls, g gravity, a acceleration (NED), R body-to-inertial rotation,
T total thrust, W weight.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.missions.schema import MissionFile
from skyknot.missions.schema_flight import Heading
from skyknot.missions.shapes import airspace_constraints
from skyknot.models.base import Bounds, Model
from skyknot.models.quadrotor import rotation
from skyknot.models.translational_yaw import TranslationalYaw
from skyknot.models.vehicle import Vehicle
from skyknot.problem.airspace import speed_limit, tilt_limit
from skyknot.problem.constraints import PathConstraint, PointConstraint
from skyknot.problem.costs import QuadraticTracking
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.problem.variables import Control, State

Array = NDArray[np.float64]


def model_of(file: MissionFile, vehicle: Vehicle) -> Model:
    """Return the model asked for, in the mission's wind."""
    if file.model == "translational-yaw":
        return vehicle.translational_yaw_model()
    model = vehicle.wrench_model() if file.model == "wrench" else vehicle.rotor_model()
    return model if file.wind is None else model.with_wind(file.wind)


def problem_of(name: str, file: MissionFile, vehicle: Vehicle) -> Problem:
    """Return the Problem that a mission states.

    Raises
    ------
    UserError
        When ends and bounds do not agree.
    """
    model = model_of(file, vehicle)
    target = end_state(file.goal, model)
    lower, upper = state_bounds(file, model)
    limits = _path_limits(file, vehicle, model)
    return Problem(
        name=name,
        states=[
            State(n, unit, low, high, scale)
            for n, unit, low, high, scale in zip(
                model.state_names, model.state_units, lower, upper, model.state_scales, strict=True
            )
        ],
        controls=[
            Control(n, unit, low, high, scale)
            for n, unit, low, high, scale in zip(
                model.control_names,
                model.control_units,
                *model.control_bounds,
                model.control_scales,
                strict=True,
            )
        ],
        dynamics=model.dynamics,
        horizon=_horizon(file),
        initial=list(end_state(file.start, model)),
        final=_final(file, target),
        **_costs(file, vehicle, model, target),
        path=[*airspace_constraints(file.airspace), *limits],
        points=waypoints(file),
        rates=file.limits.control_rates,
        target=list(target),
        vehicle=vehicle,
    )


def end_state(end: Heading, model: Model) -> Array:
    """Return the state at rest attitude there, (nx,)."""
    state = np.zeros(len(model.state_names))
    state[:3], state[3:6] = end.ned, end.velocity
    state[model.state_names.index("psi")] = end.psi
    return state


def waypoint_times(file: MissionFile) -> list[float]:
    """Return when each waypoint is due: as given, else by its share of the straight path."""
    path = [file.start.ned, *(point.ned for point in file.waypoints), file.goal.ned]
    legs = np.linalg.norm(np.diff(path, axis=0), axis=1)
    flown = np.cumsum(legs)[:-1] / max(float(np.sum(legs)), 1e-12)
    return [
        float(share) if point.at is None else point.at
        for point, share in zip(file.waypoints, flown, strict=True)
    ]


def waypoint_name(file: MissionFile, index: int) -> str:
    """Return what messages call a waypoint."""
    return file.waypoints[index].name or f"waypoint {index + 1}"


def waypoints(file: MissionFile) -> list[PointConstraint]:
    """Return each waypoint as a bound on the distance from it at its time."""
    times = waypoint_times(file)
    return [
        PointConstraint(
            waypoint_name(file, i),
            partial(_distance, point.ned, 1e-3 * point.tolerance),
            at=times[i],
            upper=point.tolerance,
            unit="m",
        )
        for i, point in enumerate(file.waypoints)
    ]


def state_bounds(file: MissionFile, model: Model) -> Bounds:
    """Return the model's state bounds, tightened by the mission's limits."""
    lower, upper = model.state_bounds
    limits = file.limits
    if limits.speed is not None:
        _tighten(lower, upper, 3, [limits.speed] * 3)
    if limits.speed_per_axis is not None:
        _tighten(lower, upper, 3, limits.speed_per_axis)
    if limits.climb is not None:
        lower[5] = max(lower[5], -limits.climb)
    if limits.descent is not None:
        upper[5] = min(upper[5], limits.descent)
    if limits.tilt_per_axis is not None:
        _tighten(lower, upper, 6, [limits.tilt_per_axis] * 2)
    if limits.body_rates is not None:
        _tighten(lower, upper, 9, limits.body_rates)
    return lower, upper


def greatest_tilt(file: MissionFile, vehicle: Vehicle) -> float | None:
    """Return the tilt limit of mission and vehicle, rad; None when neither has one."""
    degrees = file.limits.tilt_degrees
    tilt = file.limits.tilt if degrees is None else math.radians(degrees)
    return _smallest(tilt, vehicle.limits.tilt)


def greatest_speed(file: MissionFile, vehicle: Vehicle) -> float | None:
    """Return the speed limit of mission and vehicle, m/s; None when neither has one."""
    return _smallest(file.limits.speed, vehicle.limits.speed)


def _tighten(lower: Array, upper: Array, first: int, sizes: Sequence[float]) -> None:
    here = slice(first, first + len(sizes))
    lower[here] = np.maximum(lower[here], -np.array(sizes))
    upper[here] = np.minimum(upper[here], sizes)


def _horizon(file: MissionFile) -> float | Free:
    free = file.horizon.free
    if free is None:
        return float(file.horizon.duration or 0.0)
    return Free(free.lower, free.upper, free.guess)


def _final(file: MissionFile, target: Array) -> list[float | None] | None:
    if file.goal.reach == "cost":
        return None
    fixed = len(target) if file.goal.reach == "exact" else 3
    return [float(value) if i < fixed else None for i, value in enumerate(target)]


def _path_limits(file: MissionFile, vehicle: Vehicle, model: Model) -> list[PathConstraint]:
    limits, found = file.limits, []
    speed = greatest_speed(file, vehicle)
    if speed is not None:
        found.append(speed_limit("speed limit", speed))
    rigid = "phi" in model.state_names
    tilt = greatest_tilt(file, vehicle)
    if tilt is not None and rigid:
        found.append(tilt_limit("tilt limit", tilt))
    for name, felt, most in (
        ("acceleration", False, limits.acceleration_g),
        ("felt acceleration", True, limits.felt_acceleration_g),
    ):
        if most is not None:
            function = partial(_acceleration, model, vehicle.gravity, felt, 1e-3 * most)
            found.append(PathConstraint(name, function, upper=most, unit="g"))
    return found


def _smallest(*values: float | None) -> float | None:
    return min((value for value in values if value is not None), default=None)


def _distance(center: Sequence[float], tiny: float, x: Any, _u: Any) -> Any:
    return ca.sqrt(sum((x[i] - center[i]) ** 2 for i in range(3)) + tiny**2)


def _acceleration(model: Model, g: float, felt: bool, tiny: float, x: Any, u: Any) -> Any:
    """Return |a|/g, or |Rᵀ(a − g e3) + g e3|/g: what the cabin feels beyond rest."""
    a = model.dynamics(x, u)[3:6]
    if felt:
        R = rotation(x[6], x[7], x[8])
        force = [a[0], a[1], a[2] - g]
        a = [sum(R[i][j] * force[i] for i in range(3)) for j in range(3)]
        a[2] = a[2] + g
    return ca.sqrt(sum((component / g) ** 2 for component in a) + tiny**2)


def _costs(file: MissionFile, vehicle: Vehicle, model: Model, target: Array) -> dict[str, Any]:
    """Return the cost callables of the Problem."""
    objective, nu = file.objective, len(model.control_names)
    tracking = objective.kind == "tracking"
    quadratic = QuadraticTracking(
        target,
        objective.Q if tracking and objective.Q is not None else np.zeros(len(target)),
        objective.R if objective.R is not None else np.zeros(nu),
        objective.Q_final,
        model.trim_control,
    )
    price = objective.time + (1.0 if objective.kind == "minimum-time" else 0.0)
    power = _power(vehicle, model) if objective.kind == "energy" else None

    def running_cost(x: Any, u: Any) -> Any:
        cost = quadratic.running_cost(x, u) + price
        return cost if power is None else cost + power(u)

    if objective.Q_final is None:
        return {"running_cost": running_cost}
    return {"running_cost": running_cost, "terminal_cost": quadratic.terminal_cost}


def _power(vehicle: Vehicle, model: Model) -> Callable[[Any], Any]:
    """Return power [kW] of a control: hover power times (thrust / weight)^1.5, rotor by rotor.

    Momentum theory in hover gives thrust to the power 1.5; what forward flight saves and climbing
    costs is left out. A share of 1e-6 keeps it smooth at zero thrust.
    """
    hover = (vehicle.hover_power or 0.0) / 1e3

    def power(u: Any) -> Any:
        if isinstance(model, TranslationalYaw):
            square = (u[0] ** 2 + u[1] ** 2 + (u[2] - model.gravity) ** 2) / model.gravity**2
            shares = [(square, 1.0)]
        elif model.control_names[0] == "T":
            shares = [((u[0] / vehicle.weight) ** 2, 1.0)]
        else:
            n = len(model.control_names)
            shares = [((n * u[i] / vehicle.weight) ** 2, 1 / n) for i in range(n)]
        return hover * sum(weight * (square + 1e-6) ** 0.75 for square, weight in shares)

    return power
