"""Whether the ends lie where they may, and whether there is time enough to fly between them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from skyknot.missions.formulation import greatest_speed, model_of, state_bounds
from skyknot.missions.mission_text import MissionText, Path, dotted
from skyknot.missions.schema import MissionFile
from skyknot.missions.schema_flight import Heading, Place
from skyknot.missions.shapes import ALTITUDE_BAND
from skyknot.missions.soundness import places, refusal
from skyknot.models.vehicle import Vehicle
from skyknot.problem.constraints import PathConstraint
from skyknot.problem.problem import Problem

MARGIN = 1e-9
"""Slack, in a constraint's own unit, within which an end counts as inside."""


def check_velocities(source: MissionText, file: MissionFile, vehicle: Vehicle) -> None:
    """Raise when start or goal is flown at a velocity beyond the limits of mission or vehicle."""
    lower, upper = state_bounds(file, model_of(file, vehicle))
    fastest = greatest_speed(file, vehicle) or math.inf
    ends: tuple[tuple[str, Heading], ...] = (("start", file.start), ("goal", file.goal))
    for name, end in ends:
        velocity = np.array(end.velocity)
        speed = float(np.linalg.norm(velocity))
        outside = (velocity < lower[3:6] - MARGIN) | (velocity > upper[3:6] + MARGIN)
        if speed <= fastest + MARGIN and not np.any(outside):
            continue
        allowed = [f"{low:g} to {high:g}" for low, high in zip(lower, upper, strict=True)][3:6]
        raise refusal(
            source,
            (name, "velocity"),
            f"The velocity at {name} is above the speed limit.",
            f"{_point(end.velocity)}, {speed:.4g} m/s",
            f"at most {fastest:g} m/s; north {allowed[0]}, east {allowed[1]}, down {allowed[2]}",
            "Slow the end down, or raise the speed limit of mission or vehicle.",
        )


def check_problem(source: MissionText, file: MissionFile, problem: Problem) -> None:
    """Raise when a place breaks a constraint, or the goal cannot be reached in time."""
    for path, place in places(file):
        for index, constraint in enumerate(problem.path):
            if constraint.shape is not None:
                _check_inside(source, path, place, constraint, _constraint_path(file, index))
    _check_reach(source, file, problem)


def _constraint_path(file: MissionFile, index: int) -> Path:
    obstacles, corridors = len(file.airspace.obstacles), len(file.airspace.corridors)
    if index < obstacles:
        return ("airspace", "obstacles", index)
    if index < obstacles + corridors:
        return ("airspace", "corridors", index - obstacles)
    return ("airspace", "altitude")


def _check_inside(
    source: MissionText, path: Path, place: Place, constraint: PathConstraint, at: Path
) -> None:
    value = float(constraint.function([*place.ned, *[0.0] * 9], [0.0] * 4))
    low = -math.inf if constraint.lower is None else constraint.lower
    high = math.inf if constraint.upper is None else constraint.upper
    slack = getattr(place, "tolerance", 0.0) + MARGIN
    if low - slack <= value <= high + slack:
        return
    keep_in = constraint.shape.keep_in
    height = constraint.name == ALTITUDE_BAND
    distance = max(low - value, value - high)
    raise refusal(
        source,
        (*path, "position"),
        f"{dotted(path)} lies {'outside' if keep_in else 'inside'} '{constraint.name}'.",
        f"{_point(place.ned)}: "
        + (f"height {value:g} m" if height else f"{distance:.3g} m on the wrong side"),
        f"{low:g} to {high:g} m above ground"
        if height
        else f"the other side, see {source.where(at)}",
        f"Move {dotted(path)}, or change '{constraint.name}'.",
    )


def _point(values: Sequence[float]) -> str:
    return f"[{', '.join(f'{value:g}' for value in values)}]"


def _check_reach(source: MissionText, file: MissionFile, problem: Problem) -> None:
    """Raise when the straight path, at the speeds allowed, takes longer than there is time."""
    if file.goal.reach == "cost":
        return
    free = file.horizon.free
    available = free.upper if free is not None else float(file.horizon.duration or 0.0)
    needed, why = shortest_time(file, problem)
    if needed > available * (1 + 1e-9):
        field: Path = ("horizon", "duration") if free is None else ("horizon", "free", "upper")
        raise refusal(
            source,
            field,
            "The goal cannot be reached in time.",
            f"{available:g} s",
            f"at least {needed:.4g} s: {why}",
            "Give more time, raise the speed limits, or bring the goal nearer.",
        )


def shortest_time(file: MissionFile, problem: Problem) -> tuple[float, str]:
    """Return a lower bound of the flight time [s] from the speed limits, and its reason."""
    path = np.array([file.start.ned, *(point.ned for point in file.waypoints), file.goal.ned])
    slack = np.array([0.0, *(2 * point.tolerance for point in file.waypoints)])
    legs = np.diff(path, axis=0)
    lower, upper = state_bounds(file, model_of(file, problem.vehicle))
    candidates = [(0.0, "no limit binds")]
    for axis, (plus, minus) in enumerate(
        (("north", "south"), ("east", "west"), ("downwards", "upwards"))
    ):
        for sign, word, most in ((1, plus, upper[3 + axis]), (-1, minus, -lower[3 + axis])):
            way = float(np.sum(np.maximum(sign * legs[:, axis] - slack, 0)))
            candidates.append((way / most, f"{way:.4g} m {word} at {most:g} m/s"))
    fastest = min(
        (c.upper for c in problem.path if c.name == "speed limit" and c.upper), default=None
    )
    if fastest is not None:
        way = float(np.sum(np.maximum(np.linalg.norm(legs, axis=1) - slack, 0)))
        candidates.append((way / fastest, f"{way:.4g} m at {fastest:g} m/s"))
    return max(candidates)
