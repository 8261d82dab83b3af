"""What the schema cannot see: fields that contradict one another, or the vehicle.

Every check raises a UserError with file, line and field, found, expected, and what to do.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from skyknot.errors import UserError
from skyknot.missions.formulation import (
    model_of,
    waypoint_name,
    waypoint_times,
)
from skyknot.missions.mission_text import MissionText, Path, dotted
from skyknot.missions.schema import MissionFile
from skyknot.missions.schema_flight import Heading, Place
from skyknot.missions.schema_solving import Scheme
from skyknot.missions.shapes import ALTITUDE_BAND, corridor_constraint, obstacle_constraint
from skyknot.models.vehicle import Vehicle

PLANNED = ("speed limit", "tilt limit", "acceleration", "felt acceleration", ALTITUDE_BAND)
"""Names of constraints that missions make themselves."""


def check_file(source: MissionText, file: MissionFile, vehicle: Vehicle) -> None:
    """Raise at the first contradiction that needs no Problem to be seen."""
    _check_places(source, file)
    _check_horizon(source, file)
    _check_objective(source, file, vehicle)
    _check_limits(source, file, vehicle)
    _check_names(source, file)
    _check_shapes(source, file)
    _check_waypoints(source, file)
    _check_scheme(source, file)
    _check_guess(source, file)


def refusal(
    source: MissionText, path: Path, what: str, found: object, expected: str, do: str
) -> UserError:
    """Return a UserError placed at a field of the mission file."""
    return UserError(what, where=source.where(path), found=found, expected=expected, do=do)


def places(file: MissionFile) -> list[tuple[Path, Place]]:
    """Return start, waypoints and goal, each with its path in the file."""
    inner: list[tuple[Path, Place]] = [
        (("waypoints", i), point) for i, point in enumerate(file.waypoints)
    ]
    return [(("start",), file.start), *inner, (("goal",), file.goal)]


def _check_places(source: MissionText, file: MissionFile) -> None:
    for path, place in places(file):
        if (place.altitude is None) != (len(place.position) == 3):
            raise refusal(
                source,
                (*path, "position"),
                f"The height of {dotted(path)} is given twice or not at all.",
                f"position of {len(place.position)} numbers, "
                + ("no altitude" if place.altitude is None else f"altitude = {place.altitude:g}"),
                "north, east, down [m]; or north, east and altitude above ground [m]",
                "Give three numbers, or two and an altitude (down = −altitude).",
            )
        if isinstance(place, Heading) and None not in (place.yaw, place.yaw_degrees):
            raise refusal(
                source,
                (*path, "yaw_degrees"),
                f"The heading of {dotted(path)} is given twice.",
                f"yaw = {place.yaw:g} and yaw_degrees = {place.yaw_degrees:g}",
                "yaw [rad] or yaw_degrees [deg]",
                "Drop one of them.",
            )


def _check_horizon(source: MissionText, file: MissionFile) -> None:
    duration, free = file.horizon.duration, file.horizon.free
    if (duration is None) == (free is None):
        raise refusal(
            source,
            ("horizon",),
            "The horizon is given twice or not at all.",
            "neither duration nor free" if duration is None else "both duration and free",
            "duration = 10.0 [s], or free = {lower = 1.0, upper = 20.0} [s]",
            "Keep one of the two.",
        )
    if free is None:
        return
    guess = math.sqrt(free.lower * free.upper) if free.guess is None else free.guess
    if not free.lower < free.upper:
        raise refusal(
            source,
            ("horizon", "free"),
            "The bounds of the free horizon leave no room.",
            f"lower = {free.lower:g}, upper = {free.upper:g}",
            "lower < upper [s]",
            "Exchange them, or write duration = … for a fixed horizon.",
        )
    if not free.lower <= guess <= free.upper:
        raise refusal(
            source,
            ("horizon", "free", "guess"),
            "The guess of the free horizon lies outside its bounds.",
            f"guess = {guess:g}",
            f"{free.lower:g} to {free.upper:g} [s]",
            "Move the guess between the bounds, or leave it out.",
        )


def _check_objective(source: MissionText, file: MissionFile, vehicle: Vehicle) -> None:
    objective, model = file.objective, model_of(file, vehicle)
    needed = {"tracking": ("Q", "R"), "effort": ("R",)}.get(objective.kind, ())
    for name in needed:
        if getattr(objective, name) is None:
            raise refusal(
                source,
                ("objective", name),
                f"The objective '{objective.kind}' needs weights {name}.",
                "nothing",
                "one number, zero or more, for each " + ("control" if name == "R" else "state"),
                f"Add {name} = […] to [objective].",
            )
    for name, entries in (
        ("Q", model.state_names),
        ("R", model.control_names),
        ("Q_final", model.state_names),
    ):
        weights = getattr(objective, name)
        if weights is not None and len(weights) != len(entries):
            raise refusal(
                source,
                ("objective", name),
                f"The weights {name} do not fit the model '{file.model}'.",
                f"{len(weights)} numbers",
                f"{len(entries)}: {', '.join(entries)}",
                "Give one weight for each, in this order.",
            )
    _check_objective_fits(source, file, vehicle)


def _check_objective_fits(source: MissionText, file: MissionFile, vehicle: Vehicle) -> None:
    objective = file.objective
    if objective.Q is not None and objective.kind != "tracking":
        raise refusal(
            source,
            ("objective", "Q"),
            f"The objective '{objective.kind}' does not use Q.",
            f'Q with kind = "{objective.kind}"',
            'Q only with kind = "tracking"',
            'Drop Q, or write kind = "tracking".',
        )
    if objective.kind == "minimum-time" and file.horizon.free is None:
        raise refusal(
            source,
            ("horizon", "duration"),
            "A minimum-time mission needs a free horizon.",
            f"duration = {file.horizon.duration:g}",
            "free = {lower = …, upper = …} [s]",
            "Let the horizon be free, or choose another objective.",
        )
    if objective.kind == "energy" and vehicle.hover_power is None:
        raise refusal(
            source,
            ("objective", "kind"),
            f"The energy of vehicle '{vehicle.name}' is not known.",
            "a vehicle without hover power and without rotor radius",
            "a vehicle file with [power] hover, or [rotors] radius",
            'Use kind = "effort", or add the hover power to the vehicle file.',
        )
    if file.goal.reach == "cost" and objective.kind != "tracking":
        raise refusal(
            source,
            ("goal", "reach"),
            "Nothing pulls the flight to its goal.",
            f'reach = "cost" with the objective "{objective.kind}"',
            'reach = "exact" or "position", or the objective "tracking"',
            'Write reach = "exact".',
        )


def _check_limits(source: MissionText, file: MissionFile, vehicle: Vehicle) -> None:
    limits, model = file.limits, model_of(file, vehicle)
    if limits.tilt is not None and limits.tilt_degrees is not None:
        raise refusal(
            source,
            ("limits", "tilt_degrees"),
            "The tilt limit is given twice.",
            f"tilt = {limits.tilt:g} and tilt_degrees = {limits.tilt_degrees:g}",
            "tilt [rad] or tilt_degrees [deg]",
            "Drop one of them.",
        )
    for name in ("tilt", "tilt_degrees", "tilt_per_axis", "body_rates", "felt_acceleration_g"):
        if getattr(limits, name) is not None and "phi" not in model.state_names:
            raise refusal(
                source,
                ("limits", name),
                f"The model '{file.model}' has no attitude to limit.",
                f"{name} = {getattr(limits, name)}",
                'limits of speed, climb, descent, acceleration; or model = "wrench"',
                f"Drop {name}, or choose a model with attitude.",
            )
    rates = limits.control_rates
    if rates is not None and len(rates) != len(model.control_names):
        raise refusal(
            source,
            ("limits", "control_rates"),
            f"The control rates do not fit the model '{file.model}'.",
            f"{len(rates)} numbers",
            f"{len(model.control_names)}: {', '.join(model.control_names)}",
            "Give one rate for each control, in this order.",
        )
    if file.wind is not None and (file.model == "translational-yaw" or not any(vehicle.drag)):
        raise refusal(
            source,
            ("wind",),
            "The wind has no effect: it acts through drag only.",
            f"vehicle '{vehicle.name}' with model '{file.model}', which has no drag",
            "a vehicle with drag, and the model 'wrench' or 'rotors'",
            "Drop the wind, or fly a vehicle whose file gives [drag] linear.",
        )


def _check_names(source: MissionText, file: MissionFile) -> None:
    taken: dict[str, str] = {name: "a name skyknot uses itself" for name in PLANNED}
    entries: list[tuple[Path, str]] = [
        (("airspace", "obstacles", i, "name"), obstacle.name)
        for i, obstacle in enumerate(file.airspace.obstacles)
    ]
    entries += [
        (("airspace", "corridors", i, "name"), corridor.name)
        for i, corridor in enumerate(file.airspace.corridors)
    ]
    entries += [
        (("waypoints", i, "name"), waypoint_name(file, i)) for i in range(len(file.waypoints))
    ]
    for path, name in entries:
        if name in taken:
            raise refusal(
                source,
                path,
                f"The name '{name}' is taken.",
                f"'{name}', also {taken[name]}",
                "a name of its own for every obstacle, corridor and waypoint",
                "Rename one of them; messages and figures tell them apart by name.",
            )
        taken[name] = source.where(path)


def _check_shapes(source: MissionText, file: MissionFile) -> None:
    """Raise at a shape that is none: a wall without direction, a leg without length."""
    _check_each(source, "obstacles", file.airspace.obstacles, obstacle_constraint)
    _check_each(source, "corridors", file.airspace.corridors, corridor_constraint)


def _check_each(
    source: MissionText, kind: str, entries: Sequence[Any], build: Callable[[Any], object]
) -> None:
    for i, entry in enumerate(entries):
        try:
            build(entry)
        except UserError as error:
            found = f"{error.where}: {error.found}"
            path: Path = ("airspace", kind, i)
            raise refusal(source, path, error.what, found, error.expected, error.do) from None


def _check_waypoints(source: MissionText, file: MissionFile) -> None:
    before = 0.0
    for i, at in enumerate(waypoint_times(file)):
        if not before < at < 1:
            raise refusal(
                source,
                ("waypoints", i, "at"),
                f"{waypoint_name(file, i)} is not after what comes before it.",
                f"at = {at:g} after {before:g}",
                "fractions of the horizon that increase, above 0 and below 1",
                "Put the waypoints in the order of flight, or change their times.",
            )
        before = at
    band = file.airspace.altitude
    if band is not None and not band.lowest < band.highest:
        raise refusal(
            source,
            ("airspace", "altitude"),
            "The altitude band leaves no room.",
            f"lowest = {band.lowest:g}, highest = {band.highest:g}",
            "lowest < highest, heights above ground [m]",
            "Exchange them.",
        )


def _check_scheme(source: MissionText, file: MissionFile) -> None:
    scheme = file.scheme
    if scheme.objective == "sum" and file.horizon.free is not None:
        raise refusal(
            source,
            ("scheme", "objective"),
            "The plain sum over the nodes has no meaning with a free horizon.",
            'objective = "sum" with a free horizon',
            'objective = "integral", or a fixed duration',
            'Write objective = "integral".',
        )
    _check_points(source, scheme)
    allowed = ("hold",) if scheme.points == 1 else _CONTROLS[scheme.name]
    if scheme.controls is not None and scheme.controls not in allowed:
        raise refusal(
            source,
            ("scheme", "controls"),
            f"The scheme '{scheme.name}' does not know this kind of control.",
            f'controls = "{scheme.controls}"',
            " or ".join(f'"{name}"' for name in allowed),
            "Choose one of these, or leave it out.",
        )


_CONTROLS = {
    "euler": ("hold",),
    "trapezoid": ("hold", "linear"),
    "hermite-simpson": ("hold", "linear", "quadratic"),
    "lobatto": ("polynomial", "discontinuous", "linear", "hold"),
    "radau": ("polynomial", "linear", "hold"),
    "chebyshev": ("polynomial", "discontinuous", "linear", "hold"),
}
_LEAST_POINTS = {"lobatto": 2, "radau": 1, "chebyshev": 2}


def _check_points(source: MissionText, scheme: Scheme) -> None:
    least = _LEAST_POINTS.get(scheme.name)
    if scheme.points is None or (least is not None and scheme.points >= least):
        return
    raise refusal(
        source,
        ("scheme", "points"),
        f"The scheme '{scheme.name}' cannot have this number of points.",
        f"points = {scheme.points}",
        "no points: they are fixed" if least is None else f"{least} or more",
        "Leave it out." if least is None else f"Write points = {max(least, 5)}.",
    )


def _check_guess(source: MissionText, file: MissionFile) -> None:
    guess = file.guess
    if guess is None:
        return
    for kind, field in (("bow", "offset"), ("via", "points")):
        given = getattr(guess, field) is not None
        if given != (guess.kind == kind):
            raise refusal(
                source,
                ("guess", field) if given else ("guess", "kind"),
                f"The guess '{guess.kind}' "
                + (f"does not use {field}." if given else f"needs {field}."),
                f'{field} with kind = "{guess.kind}"' if given else "nothing",
                f'{field} [m] with kind = "{kind}", and only then',
                f"Drop {field}." if given else f"Add {field} to [guess].",
            )
    if guess.kind == "flat" and file.model == "translational-yaw":
        raise refusal(
            source,
            ("guess", "kind"),
            "The flat guess lifts to attitude, which this model does not have.",
            f'kind = "flat" with model = "{file.model}"',
            'kind = "straight", "bow" or "via"',
            'Write kind = "straight".',
        )
