r"""Differential flatness: from position and yaw in time to every state and control.

Legend
------
a, j, s : acceleration, jerk, snap, NED. g : gravity, e3 = (0, 0, 1). m : mass. I : inertia.
T : total thrust. z_b = R e3 : body down axis. ψ : yaw.
w = Rz(−ψ)(g e3 − a), split as w = (X, Y, Z); ρ² = X² + Z²; n² = ρ² + Y².

Derivation (no drag)
--------------------
Equation (4) of the source report, m a = m g e3 − T z_b, gives T z_b = m (g e3 − a), so T = m n.
With ZYX angles Rz(−ψ) z_b = (sin θ cos φ, −sin φ, cos θ cos φ), hence for |φ| < 90 deg

    θ = atan2(X, Z),   φ = −atan2(Y, ρ).

Their first and second time derivatives follow from those of w, with S = d/dψ Rz(ψ) at 0:
w' = −Rz(−ψ) j − ψ' S w and w'' = −Rz(−ψ) s − ψ'' S w − ψ' S (w' − Rz(−ψ) j). Inverting (6)–(7),

    p = φ' − ψ' sin θ,  q = θ' cos φ + ψ' cos θ sin φ,  r = −θ' sin φ + ψ' cos θ cos φ,

and τ = I ω' + ω × I ω. That position and yaw are flat outputs of a quadrotor: D. Mellinger and
V. Kumar, "Minimum snap trajectory generation and control for quadrotors", ICRA 2011.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from skyknot.errors import UserError

Samples = NDArray[np.float64]
Vectors = tuple[Samples, Samples, Samples]

TILT_LIMIT = float(np.deg2rad(89.0))
"""Tilt, rad, from which the lift is refused: at 90 deg the Euler angles stop being defined."""


class RigidBody(Protocol):
    """What the lift needs of a vehicle: a `Vehicle` or a `Quadrotor` will do."""

    @property
    def mass(self) -> float:
        """Return the mass, kg."""

    @property
    def inertia(self) -> tuple[float, float, float]:
        """Return Ixx, Iyy, Izz, kg m²."""

    @property
    def gravity(self) -> float:
        """Return gravity, m/s²."""


class _VectorJet(NamedTuple):
    """Sampled vectors with their first and second derivatives."""

    value: Vectors
    rate: Vectors
    second: Vectors


class _Jet(NamedTuple):
    """A sampled function of time with its first and second derivatives."""

    value: Samples
    rate: Samples
    second: Samples


def lift(
    vehicle: RigidBody,
    position: ArrayLike,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    jerk: ArrayLike,
    snap: ArrayLike,
    yaw: ArrayLike,
    yaw_rate: ArrayLike,
    yaw_acceleration: ArrayLike,
) -> tuple[Samples, Samples]:
    """Return the quadrotor states (M, 12) and wrench controls (M, 4) that fly flat outputs.

    Parameters
    ----------
    vehicle : RigidBody
        Mass, inertia and gravity; drag is ignored.
    position, velocity, acceleration, jerk, snap : array_like, shape (M, 3)
        The path and its time derivatives, NED, m, m/s ... m/s⁴.
    yaw, yaw_rate, yaw_acceleration : array_like, shape (M,)
        rad, rad/s, rad/s².

    Raises
    ------
    UserError
        If shapes disagree, a value is not finite, or a sample asks for free fall or 89 deg of tilt.
    """
    path = [
        _rows(name, value, (3,))
        for name, value in zip(_PATH, (position, velocity, acceleration, jerk, snap), strict=True)
    ]
    heading = _Jet(
        *(
            _rows(name, value, ())
            for name, value in zip(_YAW, (yaw, yaw_rate, yaw_acceleration), strict=True)
        )
    )
    _check_lengths([*path, *heading])
    w = _specific_force(vehicle.gravity, path[2].T, path[3].T, path[4].T, heading)
    _check_tilt(w.value)
    pitch, across = _pitch(w)
    roll = _roll(w, across)
    rates, accelerations = _body_rates(roll, pitch, heading)
    angles = roll.value, pitch.value, heading.value
    thrust = vehicle.mass * _length(w.value)
    torques = _torques(vehicle.inertia, rates, accelerations)
    return np.hstack([*path[:2], np.array([*angles, *rates]).T]), np.column_stack(
        [thrust, *torques]
    )


def _torques(inertia: tuple[float, float, float], rates: Vectors, derivatives: Vectors) -> Vectors:
    """Return I ω' + ω × I ω."""
    (Ixx, Iyy, Izz), (p, q, r), (p_rate, q_rate, r_rate) = inertia, rates, derivatives
    Hx, Hy, Hz = Ixx * p, Iyy * q, Izz * r
    return (
        Ixx * p_rate + (q * Hz - r * Hy),
        Iyy * q_rate + (r * Hx - p * Hz),
        Izz * r_rate + (p * Hy - q * Hx),
    )


_PATH = ("position", "velocity", "acceleration", "jerk", "snap")
_YAW = ("yaw", "yaw_rate", "yaw_acceleration")


def _specific_force(
    gravity: float, acceleration: Samples, jerk: Samples, snap: Samples, heading: _Jet
) -> _VectorJet:
    """Return w = Rz(−ψ)(g e3 − a) with two derivatives, from (3, M) each."""
    rate, second = heading.rate, heading.second
    turn = np.cos(heading.value), np.sin(heading.value)
    (ax, ay, az), (sx, sy, sz) = acceleration, snap
    X, Y, _ = w = _turned_back(0.0 - ax, 0.0 - ay, gravity - az, *turn)
    jx, jy, jz = _turned_back(-jerk[0], -jerk[1], -jerk[2], *turn)
    Xd, Yd, _ = w_rate = jx + rate * Y, jy - rate * X, jz
    tx, ty, tz = _turned_back(-sx, -sy, -sz, *turn)
    w_second = (
        tx + second * Y + rate * (Yd + jy),
        ty - second * X - rate * (Xd + jx),
        tz,
    )
    return _VectorJet(w, w_rate, w_second)


def _turned_back(x: Samples, y: Samples, z: Samples, cosine: Samples, sine: Samples) -> Vectors:
    """Return Rz(−angle) times each sample."""
    return cosine * x + sine * y, cosine * y - sine * x, z


def _length(vectors: Vectors) -> Samples:
    X, Y, Z = vectors
    result: Samples = np.sqrt(X * X + Y * Y + Z * Z)
    return result


def _pitch(w: _VectorJet) -> tuple[_Jet, _Jet]:
    """Return θ = atan2(X, Z) and ρ = |(X, Z)|, each with two derivatives."""
    (X, _, Z), (Xd, _, Zd), (Xdd, _, Zdd) = w
    rho = np.hypot(X, Z)
    rho_rate = (X * Xd + Z * Zd) / rho
    rho_second = (Xd**2 + Zd**2 + X * Xdd + Z * Zdd - rho_rate**2) / rho
    rate = (Xd * Z - X * Zd) / rho**2
    second = (Xdd * Z - X * Zdd) / rho**2 - 2.0 * rate * rho_rate / rho
    return _Jet(np.arctan2(X, Z), rate, second), _Jet(rho, rho_rate, rho_second)


def _roll(w: _VectorJet, across: _Jet) -> _Jet:
    """Return φ = −atan2(Y, ρ) with two derivatives."""
    Y, Yd, Ydd = (components[1] for components in w)
    rho, rho_rate, rho_second = across
    square = Y**2 + rho**2
    rate = (Y * rho_rate - Yd * rho) / square
    square_rate = 2.0 * (Y * Yd + rho * rho_rate)
    second = (Y * rho_second - Ydd * rho - rate * square_rate) / square
    return _Jet(-np.arctan2(Y, rho), rate, second)


def _body_rates(roll: _Jet, pitch: _Jet, yaw: _Jet) -> tuple[Vectors, Vectors]:
    """Return ω and its derivative from the Euler angles' derivatives."""
    sf, cf = np.sin(roll.value), np.cos(roll.value)
    st, ct = np.sin(pitch.value), np.cos(pitch.value)
    p = roll.rate - yaw.rate * st
    q = pitch.rate * cf + yaw.rate * ct * sf
    r = -pitch.rate * sf + yaw.rate * ct * cf
    yaw_term = yaw.second * ct - yaw.rate * pitch.rate * st
    p_rate = roll.second - yaw.second * st - yaw.rate * pitch.rate * ct
    q_rate = pitch.second * cf + yaw_term * sf + roll.rate * r
    r_rate = -pitch.second * sf + yaw_term * cf - roll.rate * q
    return (p, q, r), (p_rate, q_rate, r_rate)


def _rows(name: str, value: ArrayLike, tail: tuple[int, ...]) -> Samples:
    """Return the samples as floats of shape (M, *tail), or raise a UserError."""
    samples = np.asarray(value, dtype=float)
    if samples.ndim != 1 + len(tail) or samples.shape[1:] != tail:
        raise UserError(
            f"The flat output {name} has the wrong shape.",
            where=name,
            found=f"shape {samples.shape}",
            expected="shape (M, 3)" if tail else "shape (M,)",
            do="Give one row per time sample.",
        )
    if not np.isfinite(samples).all():
        raise UserError(
            f"The flat output {name} is not finite everywhere.",
            where=name,
            found=f"nan or inf at sample {int(np.argwhere(~np.isfinite(samples))[0][0])}",
            expected="finite numbers",
            do="Check the interpolation that made the samples.",
        )
    return samples


def _check_lengths(samples: list[Samples]) -> None:
    """Raise a UserError unless all flat outputs have the same number of samples."""
    if len({len(array) for array in samples}) > 1:
        counts = {name: len(array) for name, array in zip((*_PATH, *_YAW), samples, strict=True)}
        raise UserError(
            "The flat outputs are not sampled at the same times.",
            where="position ... yaw_acceleration",
            found=", ".join(f"{name}: {count}" for name, count in counts.items()),
            expected="the same number of samples in each",
            do="Sample path, yaw and their derivatives on one time grid.",
        )


def _check_tilt(w: Vectors) -> None:
    """Raise a UserError if a sample asks for free fall or a tilt of 89 deg or more."""
    X, Y, Z = w
    tilt = np.arctan2(np.hypot(X, Y), Z)
    still = _length(w) <= 1e-9
    bad = still | (tilt >= TILT_LIMIT)
    if not bad.any():
        return
    sample = int(np.argmax(bad))
    asked = "free fall (no thrust)" if still[sample] else f"{np.rad2deg(tilt[sample]):.1f} deg tilt"
    raise UserError(
        "The path cannot be lifted to an attitude in Euler angles.",
        where=f"acceleration, sample {sample}",
        found=asked,
        expected="thrust within 89 deg of the vertical and not zero",
        do="Slow the path down (the acceleration falls with the square of the time) or smooth it.",
    )
