"""Obstacles, corridors, bands and limits as path constraints, with the shape to draw.

All positions are the first three states, NED, metres; z is down, so a building of height H stands
between z = 0 and z = −H. Every margin is smooth, in metres (or the limit's own unit), and never
larger than the true distance: smooth maxima lie below the true maximum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from skyknot.errors import UserError
from skyknot.problem.constraints import PathConstraint

Vector = Sequence[float]

# Rounding of the edges of a box, as a share of its smallest half size.
ROUNDING = 0.1


@dataclass(frozen=True)
class Shape:
    """What to draw: a kind and its sizes in metres, NED.

    Attributes
    ----------
    kind : "cylinder", "box", "sphere", "ellipsoid", "half-space", "corridor", "tube" or "band"
    sizes : numbers by name, as the functions of this module take them
    keep_in : True for a corridor or band, False for an obstacle
    """

    kind: str
    sizes: dict[str, Any]
    keep_in: bool = False


def cylinder(name: str, center: Vector, radius: float, *, clearance: float = 0.0) -> PathConstraint:
    """Keep out of a vertical cylinder of unlimited height.

    Parameters
    ----------
    center : (2,) x, y [m]; radius, clearance : m
    """
    reach = _positive(name, "radius", radius) + _clearance(name, clearance)
    cx, cy = _numbers(name, "center", center, 2)

    def margin(x: Any, _u: Any) -> Any:
        return _distance([x[0] - cx, x[1] - cy], reach)

    shape = Shape("cylinder", {"center": (cx, cy), "radius": radius, "clearance": clearance})
    return PathConstraint(name, margin, lower=0.0, unit="m", shape=shape)


def sphere(name: str, center: Vector, radius: float, *, clearance: float = 0.0) -> PathConstraint:
    """Keep out of a sphere: center (3,) x, y, z [m], radius and clearance in metres."""
    reach = _positive(name, "radius", radius) + _clearance(name, clearance)
    c = _numbers(name, "center", center, 3)

    def margin(x: Any, _u: Any) -> Any:
        return _distance([x[i] - c[i] for i in range(3)], reach)

    shape = Shape("sphere", {"center": c, "radius": radius, "clearance": clearance})
    return PathConstraint(name, margin, lower=0.0, unit="m", shape=shape)


def ellipsoid(
    name: str, center: Vector, semi_axes: Vector, *, clearance: float = 0.0
) -> PathConstraint:
    """Keep out of an axis-parallel ellipsoid.

    The margin is the smallest semi-axis times how far the scaled position lies outside the unit
    sphere, a lower bound of the distance. A clearance is kept by the ellipsoid of least trace
    around the sum of ellipsoid and ball: adding it to the semi-axes would not keep it.

    Parameters
    ----------
    center, semi_axes : (3,) m
    clearance : distance to keep, m

    References
    ----------
    A. Kurzhanski and I. Vályi, Ellipsoidal Calculus, 1997, section 2.1.
    """
    c = _numbers(name, "center", center, 3)
    own = [_positive(name, "semi_axes", a) for a in _numbers(name, "semi_axes", semi_axes, 3)]
    gap, mean = _clearance(name, clearance), float(np.sqrt(np.mean(np.square(own))))
    axes = [float(np.sqrt(a**2 * (1 + gap / mean) + gap * (gap + mean))) for a in own]
    smallest = min(axes)

    def margin(x: Any, _u: Any) -> Any:
        scaled = [(x[i] - c[i]) / axes[i] for i in range(3)]
        return smallest * _distance(scaled, 1.0)

    shape = Shape("ellipsoid", {"center": c, "semi_axes": semi_axes, "clearance": clearance})
    return PathConstraint(name, margin, lower=0.0, unit="m", shape=shape)


def box(
    name: str,
    center: Vector,
    size: Vector,
    *,
    yaw: float = 0.0,
    clearance: float = 0.0,
) -> PathConstraint:
    """Keep out of a box: a building, say.

    The margin is a smooth maximum of the distances to the faces, at most the true one, so the
    corners are avoided a little more widely than the faces.

    Parameters
    ----------
    center : (3,) x, y, z of the middle [m]; a building of height H has z = −H/2
    size : (3,) full length, width and height, m
    yaw : rotation about z, rad
    clearance : distance to keep, m
    """
    c = _numbers(name, "center", center, 3)
    half = [0.5 * _positive(name, "size", s) for s in _numbers(name, "size", size, 3)]
    epsilon, gap = ROUNDING * min(half), _clearance(name, clearance)
    cosine, sine = float(np.cos(yaw)), float(np.sin(yaw))

    def margin(x: Any, _u: Any) -> Any:
        dx, dy, dz = x[0] - c[0], x[1] - c[1], x[2] - c[2]
        along, across = cosine * dx + sine * dy, -sine * dx + cosine * dy
        faces = [_below_abs(d, epsilon) - h for d, h in zip((along, across, dz), half, strict=True)]
        return _below_max(_below_max(faces[0], faces[1], epsilon), faces[2], epsilon) - gap

    sizes = {"center": c, "size": tuple(size), "yaw": yaw, "clearance": clearance}
    return PathConstraint(name, margin, lower=0.0, unit="m", shape=Shape("box", sizes))


def half_space(name: str, normal: Vector, offset: float) -> PathConstraint:
    """Keep to the side n·position ≥ offset of a plane; ``normal`` (3,) is made a unit vector."""
    n = np.array(_numbers(name, "normal", normal, 3))
    length = _positive(name, "length of normal", float(np.linalg.norm(n)))
    n = n / length

    def margin(x: Any, _u: Any) -> Any:
        return float(n[0]) * x[0] + float(n[1]) * x[1] + float(n[2]) * x[2] - offset

    shape = Shape("half-space", {"normal": tuple(n), "offset": offset}, keep_in=True)
    return PathConstraint(name, margin, lower=0.0, unit="m", shape=shape)


def corridor(name: str, start: Vector, end: Vector, radius: float) -> PathConstraint:
    """Stay within ``radius`` of the straight line through ``start`` and ``end`` (3,) [m].

    The margin lies between half the distance to the wall and the distance. The line has no ends:
    use it with an altitude band, or one corridor per leg.
    """
    a, b = np.array(_numbers(name, "start", start, 3)), np.array(_numbers(name, "end", end, 3))
    length = _positive(name, "length from start to end", float(np.linalg.norm(b - a)))
    d = (b - a) / length
    reach = _positive(name, "radius", radius)

    def margin(x: Any, _u: Any) -> Any:
        rel = [x[i] - float(a[i]) for i in range(3)]
        along = sum(float(d[i]) * rel[i] for i in range(3))
        off = sum((rel[i] - along * float(d[i])) ** 2 for i in range(3))
        return (reach**2 - off) / (2 * reach)  # smooth on the axis, at most the true distance

    sizes = {"start": tuple(a), "end": tuple(b), "radius": radius}
    shape = Shape("corridor", sizes, keep_in=True)
    return PathConstraint(name, margin, lower=0.0, unit="m", shape=shape)


def tube(name: str, points: Sequence[Vector], radius: float) -> PathConstraint:
    """Stay within ``radius`` of a path of straight legs through ``points`` (n, 3) [m], NED.

    The margin is a smooth maximum over the legs of (radius² − distance²) / (2 radius), which is at
    most the true one, equal at the wall, and smooth on the axis. Every leg after the first takes
    another 2.5 per cent of the radius off.
    """
    reach = _positive(name, "radius", radius)
    corners = [np.array(_numbers(name, "points", point, 3)) for point in points]
    legs = list(pairwise(corners))
    for a, b in legs or [(np.zeros(3), np.zeros(3))]:
        _positive(name, "length of a leg", float(np.linalg.norm(b - a)))
    epsilon = 0.5 * ROUNDING * reach

    def margin(x: Any, _u: Any) -> Any:
        squares = [_leg_distance_squared(x, a, b, epsilon) for a, b in legs]
        inside = [0.5 * (reach - square / reach) for square in squares]
        total = inside[0]
        for other in inside[1:]:
            total = _below_max(total, other, epsilon)
        return total

    sizes = {"points": tuple(tuple(map(float, c)) for c in corners), "radius": radius}
    return PathConstraint(
        name, margin, lower=0.0, unit="m", shape=Shape("tube", sizes, keep_in=True)
    )


def altitude_band(name: str, lowest: float, highest: float) -> PathConstraint:
    """Stay between two heights above ground (z = 0), metres up."""
    shape = Shape("band", {"lowest": lowest, "highest": highest}, keep_in=True)
    return PathConstraint(name, lambda x, _u: -x[2], lowest, highest, unit="m", shape=shape)


def speed_limit(name: str, fastest: float) -> PathConstraint:
    """Keep the ground speed at or below ``fastest`` m/s (states 3–5 are the velocity)."""
    top = _positive(name, "fastest", fastest)

    def speed(x: Any, _u: Any) -> Any:
        return ca.sqrt(x[3] ** 2 + x[4] ** 2 + x[5] ** 2 + (1e-3 * top) ** 2)

    return PathConstraint(name, speed, upper=top, unit="m/s")


def tilt_limit(name: str, steepest: float) -> PathConstraint:
    """Keep the angle between thrust and vertical at or below ``steepest`` rad (φ, θ are 6, 7)."""
    least = float(np.cos(_positive(name, "steepest", steepest)))

    def uprightness(x: Any, _u: Any) -> Any:
        return ca.cos(x[6]) * ca.cos(x[7])

    return PathConstraint(name, uprightness, lower=least, unit="cos of tilt")


def _leg_distance_squared(x: Any, a: Any, b: Any, epsilon: float) -> Any:
    """Squared distance to a point of the leg a–b near the nearest one, so at least the true one."""
    length = float(np.linalg.norm(b - a))
    share = sum(float((b - a)[i]) * (x[i] - float(a[i])) for i in range(3)) / length**2
    round_off = (epsilon / length) ** 2
    t = 0.5 * (1 + ca.sqrt(share**2 + round_off) - ca.sqrt((share - 1) ** 2 + round_off))
    return sum((x[i] - float(a[i]) - t * float((b - a)[i])) ** 2 for i in range(3))


def _below_max(a: Any, b: Any, epsilon: float) -> Any:
    """Smooth maximum, at most max(a, b) and at least max(a, b) − epsilon/2."""
    return 0.5 * (a + b + ca.sqrt((a - b) ** 2 + epsilon**2) - epsilon)


def _below_abs(a: Any, epsilon: float) -> Any:
    """Smooth absolute value, at most |a|."""
    return ca.sqrt(a**2 + epsilon**2) - epsilon


def _distance(offsets: list[Any], reach: float) -> Any:
    """Distance beyond ``reach``: zero exactly there, smooth at the centre, at most the true one."""
    tiny = (1e-3 * reach) ** 2
    return ca.sqrt(sum(offset**2 for offset in offsets) + tiny) - float(np.sqrt(reach**2 + tiny))


def _clearance(name: str, value: float) -> float:
    if not 0 <= value < np.inf:
        raise UserError(
            f"'{name}' has a clearance that cannot be kept.",
            where=f"{name}.clearance",
            found=value,
            expected="zero or a positive distance [m]",
            do="Leave the clearance out, or give the distance to keep.",
        )
    return float(value)


def _positive(name: str, field: str, value: float) -> float:
    if not 0 < value < np.inf:
        raise UserError(
            f"'{name}' has no size.",
            where=f"{name}.{field}",
            found=value,
            expected="a positive number",
            do="Give a size greater than zero.",
        )
    return float(value)


def _numbers(name: str, field: str, values: Vector, n: int) -> tuple[float, ...]:
    if len(values) != n or not all(np.isfinite(values)):
        raise UserError(
            f"'{name}' has a wrong {field}.",
            where=f"{name}.{field}",
            found=list(values),
            expected=f"{n} finite numbers [m], NED",
            do="Give one number for each axis.",
        )
    return tuple(float(value) for value in values)
