"""A mission's problem with everything movable made a number: functions are written once for all.

Legend: NED positions and shifts, (3,) m; x states, u controls, p parameters.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.missions import Mission
from skyknot.missions.formulation import greatest_speed, greatest_tilt, model_of, state_bounds
from skyknot.missions.schema import MissionFile
from skyknot.problem.constraints import PathConstraint
from skyknot.problem.problem import Problem

Array = NDArray[np.float64]
Place = tuple[float, float, float]

AXES = ("north", "east", "down")
LEAST_SHARE, GREATEST_SHARE = 0.25, 2.0
"""How far a limit moves from the mission's, where the vehicle does not say less."""

STEEPEST_DEGREES = 80.0
LIFT_TO_SPARE = 1.05
"""Least thrust limit, in weights: less cannot hold the craft in the air."""


@dataclass(frozen=True)
class Limit:
    """A limit that can be moved, and how far.

    Attributes
    ----------
    name, unit : what people call it, and its unit
    value, least, greatest : the mission's own and the ends of its range, in ``unit``
    """

    name: str
    unit: str
    value: float
    least: float
    greatest: float


@dataclass(frozen=True)
class Wish:
    """Where everything is wanted; two are equal when nothing differs.

    Attributes
    ----------
    start, goal : (3,) NED, m
    obstacles : shift (3,) from the mission's place, NED, m, by name
    limits : value by name, in the limit's unit
    """

    start: Place
    goal: Place
    obstacles: Mapping[str, Place] = field(default_factory=dict)
    limits: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Adjustable:
    """A mission whose problems differ in numbers only.

    Attributes
    ----------
    mission : what was loaded
    problem : its problem, with shifts and limits as parameters
    wish : where everything stands in the mission
    limits : the limits that can be moved
    """

    mission: Mission
    problem: Problem
    wish: Wish
    limits: tuple[Limit, ...]

    def changed(
        self,
        wish: Wish,
        start: Any = None,
        goal: Any = None,
        obstacles: Mapping[str, Any] | None = None,
        limits: Mapping[str, float] | None = None,
    ) -> Wish:
        """Return a wish with some of its parts replaced; what is None stays.

        Parameters
        ----------
        wish : what is wanted so far
        start, goal : (3,) NED, m
        obstacles : shifts (3,) from the mission's places, NED, m, by name; others stay
        limits : values by name; others stay

        Raises
        ------
        UserError
            When a name is unknown, a value is not finite, or a limit leaves its range.
        """
        moved = {name: _place(name, value) for name, value in (obstacles or {}).items()}
        for name in moved:
            _known("obstacle", name, tuple(self.wish.obstacles))
        for name, value in (limits or {}).items():
            _known("limit", name, tuple(self.wish.limits))
            _in_range(next(limit for limit in self.limits if limit.name == name), value)
        return Wish(
            start=wish.start if start is None else _place("start", start),
            goal=wish.goal if goal is None else _place("goal", goal),
            obstacles={**wish.obstacles, **moved},
            limits={**wish.limits, **{k: float(v) for k, v in (limits or {}).items()}},
        )

    def at(self, wish: Wish) -> Problem:
        """Return the problem of a wish: the same functions, other numbers."""
        other = copy.copy(self.problem)
        file, vehicle = _with_limits(self.mission.file, wish.limits), self.mission.vehicle
        other.parameters = _shifts(wish.obstacles) | dict(
            zip(_GOAL, np.subtract(wish.goal, self.wish.goal).tolist(), strict=True)
        )
        if "speed" in wish.limits:
            other.parameters["greatest_speed"] = greatest_speed(file, vehicle) or math.inf
        if "tilt" in wish.limits:
            other.parameters["least_uprightness"] = math.cos(greatest_tilt(file, vehicle) or 0.0)
        other.parameters = {name: other.parameters[name] for name in self.problem.parameters}
        model = model_of(self.mission.file, vehicle)
        other.state_lower, other.state_upper = state_bounds(file, model)
        if "thrust" in wish.limits:
            other.control_upper = _thrust_bounds(self.problem, wish.limits["thrust"])
        other.initial_lower, other.initial_upper = self._end("initial", self.wish.start, wish.start)
        other.final_lower, other.final_upper = self._end("final", self.wish.goal, wish.goal)
        if other.target is not None:
            other.target = other.target.copy()
            other.target[:3] += np.subtract(wish.goal, self.wish.goal)
        return other

    def _end(self, which: str, own: Place, wanted: Place) -> tuple[Array, Array]:
        """Return an end's bounds with its position moved; free entries stay free."""
        shift = np.zeros(self.problem.nx)
        shift[:3] = np.subtract(wanted, own)
        return (
            getattr(self.problem, f"{which}_lower") + shift,
            getattr(self.problem, f"{which}_upper") + shift,
        )


_GOAL = tuple(f"goal_{axis}" for axis in AXES)


def adjustable(mission: Mission) -> Adjustable:
    """Return a mission with movable ends, obstacles and limits.

    Obstacles are shifted by parameters inside their own constraints, so that a margin keeps its
    form; costs see a state shifted by the goal's move, because they depend on positions through
    the distance from the goal alone.
    """
    base = mission.problem
    limits = _limits(mission)
    names = {limit.name for limit in limits}
    solid = [g.name for g in base.path if g.shape is not None and not g.shape.keep_in]
    parameters = dict.fromkeys(_GOAL, 0.0) | _shifts({name: (0.0, 0.0, 0.0) for name in solid})
    path = []
    for entry in base.path:
        if entry.name in solid:
            path.append(replace(entry, function=_shifted(entry)))
        elif entry.name == "speed limit" and "speed" in names:
            parameters["greatest_speed"] = float(entry.upper or 0.0)
            path.append(_against(entry, "greatest_speed"))
        elif entry.name == "tilt limit" and "tilt" in names:
            parameters["least_uprightness"] = float(entry.lower or 0.0)
            path.append(_against(entry, "least_uprightness"))
        else:
            path.append(entry)
    problem = copy.copy(base)
    problem.path, problem.parameters = tuple(path), parameters
    problem.running_cost = _towards_goal(base.running_cost)
    problem.terminal_cost = _towards_goal(base.terminal_cost)
    wish = Wish(
        start=mission.file.start.ned,
        goal=mission.file.goal.ned,
        obstacles={name: (0.0, 0.0, 0.0) for name in solid},
        limits={limit.name: limit.value for limit in limits},
    )
    return Adjustable(mission, problem, wish, limits)


def _shifts(obstacles: Mapping[str, Place]) -> dict[str, Any]:
    return {
        f"{name}, {axis}": float(value)
        for name, place in obstacles.items()
        for axis, value in zip(AXES, place, strict=True)
    }


def _shifted(entry: PathConstraint) -> Callable[..., Any]:
    def margin(x: Any, u: Any, p: Any) -> Any:
        here = [x[i] - p[f"{entry.name}, {axis}"] for i, axis in enumerate(AXES)]
        return entry.function(here, u)

    return margin


def _against(entry: PathConstraint, parameter: str) -> PathConstraint:
    """Return a limit as its value minus a parameter, bounded by zero on the same side."""

    def difference(x: Any, u: Any, p: Any) -> Any:
        return entry.function(x, u) - p[parameter]

    lower, upper = (None if bound is None else 0.0 for bound in (entry.lower, entry.upper))
    return replace(entry, function=difference, lower=lower, upper=upper)


def _towards_goal(cost: Callable[..., Any] | None) -> Callable[..., Any] | None:
    if cost is None:
        return None

    def shifted(x: Any, second: Any, p: Any) -> Any:
        here = [x[i] - p[name] for i, name in enumerate(_GOAL)]
        return cost([*here, *(x[i] for i in range(3, x.shape[0]))], second)

    return shifted


def _limits(mission: Mission) -> tuple[Limit, ...]:
    """Return the movable limits of a mission: those it states or its vehicle has."""
    own, craft = mission.file.limits, mission.vehicle.limits
    tilt = greatest_tilt(mission.file, mission.vehicle)
    steepest = STEEPEST_DEGREES if craft.tilt is None else math.degrees(craft.tilt)
    rigid = "phi" in mission.problem.state_names
    entries = [
        ("speed", "m/s", greatest_speed(mission.file, mission.vehicle), craft.speed),
        ("climb", "m/s", own.climb, craft.climb),
        ("descent", "m/s", own.descent, craft.descent),
        ("tilt", "deg", math.degrees(tilt) if tilt is not None and rigid else None, steepest),
    ]
    found = [
        Limit(name, unit, value, LEAST_SHARE * value, most or max(GREATEST_SHARE * value, value))
        for name, unit, value, most in entries
        if value is not None
    ]
    thrust = _thrust_places(mission.problem)
    if len(thrust):
        most = float(np.sum(mission.problem.control_upper[thrust]))
        least = min(LIFT_TO_SPARE * mission.vehicle.weight, most)
        found.append(Limit("thrust", "N", most, least, most))
    return tuple(found)


def _thrust_places(problem: Problem) -> NDArray[np.intp]:
    """Return where the controls that are thrusts stand: the total, or one for each rotor."""
    units = [control.unit for control in problem.controls]
    places = np.flatnonzero([unit == "N" for unit in units])
    return places[np.isfinite(problem.control_upper[places])]


def _thrust_bounds(problem: Problem, total: float) -> Array:
    """Return upper bounds of the controls with the thrusts scaled to a total, N."""
    upper, places = problem.control_upper.copy(), _thrust_places(problem)
    upper[places] *= total / float(np.sum(upper[places]))
    return upper


def _with_limits(file: MissionFile, limits: Mapping[str, float]) -> MissionFile:
    given: dict[str, Any] = {
        name: limits[name] for name in ("speed", "climb", "descent") if name in limits
    }
    if "tilt" in limits:
        given |= {"tilt": None, "tilt_degrees": limits["tilt"]}
    return file.model_copy(update={"limits": file.limits.model_copy(update=given)})


def _place(name: str, value: Any) -> Place:
    try:
        north, east, down = (float(entry) for entry in value)
    except (TypeError, ValueError):
        north = east = down = math.nan
    if not all(map(math.isfinite, (north, east, down))):
        raise UserError(
            f"'{name}' is not a place.",
            where=name,
            found=repr(value),
            expected="three finite numbers: north, east, down [m]",
            do="Give one number for each axis.",
        )
    return north, east, down


def _known(kind: str, name: str, names: tuple[str, ...]) -> None:
    if name not in names:
        raise UserError(
            f"There is no {kind} of this name to move.",
            where=f"{kind}s",
            found=repr(name),
            expected=", ".join(names) or f"a mission with {kind}s",
            do=f"Name one of the mission's {kind}s.",
        )


def _in_range(limit: Limit, value: float) -> None:
    if not limit.least * (1 - 1e-9) <= value <= limit.greatest * (1 + 1e-9):
        raise UserError(
            f"The limit '{limit.name}' leaves its range.",
            where=f"limits, {limit.name}",
            found=value,
            expected=f"{limit.least:.4g} to {limit.greatest:.4g} {limit.unit}",
            do="Choose a value inside the range.",
        )
