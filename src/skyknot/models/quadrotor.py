r"""The 12-state Newton–Euler rigid-body quadrotor with wrench control.

Legend
------
x = [x y z vx vy vz φ θ ψ p q r] : position, velocity (NED, m, m/s); ZYX Euler angles (rad);
    body rates (rad/s).
u = [T τx τy τz] : total thrust along minus body z (N), torques about body x, y, z (N m).
m, I = diag(Ixx, Iyy, Izz), g : mass (kg), inertia (kg m²), gravity (m/s²).
R(φ, θ, ψ) : body-to-inertial rotation Rz(ψ) Ry(θ) Rx(φ).
D = diag(dx, dy, dz) : linear rotor drag in body axes (N s/m). w : wind velocity, NED (m/s).

Equations (1)–(9) of V. P. Gautam and S. Nerella, "Numerical Optimal Control of a UAM Vehicle
using Hermite-Simpson Collocation", AOE 5404 final report, Virginia Tech. The drag term
−R D Rᵀ(v − w) is that of M. Faessler, A. Franchi, D. Scaramuzza, "Differential flatness of
quadrotor dynamics subject to rotor drag", IEEE RA-L 3(2), 2018; without drag it is left out
altogether, so that (4) holds to the bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from skyknot.models.allocation import Allocation
from skyknot.models.base import Bounds, Expression, Model, Vector
from skyknot.models.elementary import cosine, sine

STATE_NAMES = ("x", "y", "z", "vx", "vy", "vz", "phi", "theta", "psi", "p", "q", "r")
STATE_UNITS = ("m",) * 3 + ("m/s",) * 3 + ("rad",) * 3 + ("rad/s",) * 3
CONTROL_NAMES = ("T", "tau_x", "tau_y", "tau_z")
CONTROL_UNITS = ("N", "N m", "N m", "N m")

PITCH_LIMIT = float(np.deg2rad(85.0))
"""Default bound on |theta|, rad: short of the singularity of equation (7) at 90 deg."""

SINGULARITY_NOTE = (
    "ZYX Euler angles are singular at theta = ±90 deg (equation 7 divides by cos theta), so "
    "|theta| is bounded by 85 deg unless a tighter tilt limit is given; phi is free by default. "
    "Do not use this model for loops or dives past the vertical."
)


def rotation(
    phi: Expression, theta: Expression, psi: Expression
) -> tuple[tuple[Expression, ...], ...]:
    """Return the rows of the body-to-inertial rotation matrix R, equation (5)."""
    sf, cf, st, ct, sp, cp = (
        *(sine(phi), cosine(phi)),
        *(sine(theta), cosine(theta)),
        *(sine(psi), cosine(psi)),
    )
    return (
        (ct * cp, sf * st * cp - cf * sp, cf * st * cp + sf * sp),
        (ct * sp, sf * st * sp + cf * cp, cf * st * sp - sf * cp),
        (-st, sf * ct, cf * ct),
    )


def free_state_bounds(pitch_limit: float = PITCH_LIMIT) -> Bounds:
    """Return the 12 state bounds that only keep |theta| below `pitch_limit` (rad)."""
    upper = np.full(12, np.inf)
    upper[7] = pitch_limit
    return -upper, upper


@dataclass(frozen=True, eq=False)
class Quadrotor(Model):
    """A rigid multirotor commanded by total thrust and three body torques.

    Parameters
    ----------
    mass : float
        Mass, kg.
    inertia : (3,) floats
        Principal moments of inertia Ixx, Iyy, Izz, kg m².
    gravity : float
        Gravitational acceleration, m/s².
    allocation : Allocation
        Where the rotors are; maps wrenches to rotor thrusts.
    wrench_bounds : pair of (4,) arrays
        Box of T (N) and τ (N m); see `skyknot.models.envelope` for how vehicles choose it.
    limits : pair of (12,) arrays, optional
        State bounds, ±inf where free. Default: |theta| <= 85 deg, all else free.
    drag : (3,) floats
        Linear rotor drag in body axes, N s/m.
    wind : (3,) floats or CasADi expressions
        Wind velocity, NED, m/s; acts only through the drag.
    name : str
        What messages call the model.
    """

    mass: float
    inertia: tuple[float, float, float]
    gravity: float
    allocation: Allocation
    wrench_bounds: Bounds
    limits: Bounds | None = None
    drag: tuple[float, float, float] = (0.0, 0.0, 0.0)
    wind: Sequence[Expression] = (0.0, 0.0, 0.0)
    name: str = "quadrotor"

    state_names = STATE_NAMES
    state_units = STATE_UNITS
    control_names = CONTROL_NAMES
    control_units = CONTROL_UNITS
    singularity_note = SINGULARITY_NOTE

    def dynamics(self, x: Sequence[Expression], u: Sequence[Expression]) -> list[Expression]:
        """Return the time derivative of the 12 states, equations (3), (4), (6), (8)."""
        phi, theta, psi = x[6], x[7], x[8]
        R = rotation(phi, theta, psi)
        drag = self._drag_acceleration(R, [x[3], x[4], x[5]])
        thrust = u[0] / float(self.mass)
        acceleration = [
            -R[0][2] * thrust + drag[0],
            -R[1][2] * thrust + drag[1],
            self.gravity - R[2][2] * thrust + drag[2],
        ]
        return [
            *(x[3], x[4], x[5]),
            *acceleration,
            *_euler_rates(phi, theta, x[9], x[10], x[11]),
            *self._angular_acceleration(x[9], x[10], x[11], u),
        ]

    def _drag_acceleration(
        self, R: tuple[tuple[Expression, ...], ...], velocity: list[Expression]
    ) -> list[Expression]:
        """Return −(1/m) R D Rᵀ(v − w), m/s²; plain zeros when D = 0."""
        if not any(self.drag):
            return [0.0, 0.0, 0.0]
        air = [velocity[i] - self.wind[i] for i in range(3)]
        body = [
            float(self.drag[j] / self.mass) * sum(R[i][j] * air[i] for i in range(3))
            for j in range(3)
        ]
        return [-(R[i][0] * body[0] + R[i][1] * body[1] + R[i][2] * body[2]) for i in range(3)]

    def _angular_acceleration(
        self, p: Expression, q: Expression, r: Expression, u: Sequence[Expression]
    ) -> list[Expression]:
        """Return I⁻¹(τ − ω × Iω), equations (8) and (9), rad/s²."""
        Ixx, Iyy, Izz = (float(moment) for moment in self.inertia)
        return [
            (u[1] - (Izz - Iyy) * (q * r)) / Ixx,
            (u[2] - (Ixx - Izz) * (p * r)) / Iyy,
            (u[3] - (Iyy - Ixx) * (p * q)) / Izz,
        ]

    def with_wind(self, wind: Sequence[Expression]) -> Quadrotor:
        """Return the same craft in a wind, NED, m/s; entries may be CasADi parameters."""
        return replace(self, wind=tuple(wind[i] for i in range(3)))

    @property
    def trim_state(self) -> Vector:
        """Return hover at the origin, level, nose north: twelve zeros.

        It is an equilibrium in still air only.
        """
        return np.zeros(12)

    @property
    def trim_control(self) -> Vector:
        """Return [m g, 0, 0, 0]."""
        return np.array([self.mass * self.gravity, 0.0, 0.0, 0.0])

    @property
    def state_bounds(self) -> Bounds:
        """Return the limits given, or |theta| <= 85 deg and all else free, shape (12,) each."""
        lower, upper = self.limits if self.limits is not None else free_state_bounds()
        return lower.copy(), upper.copy()

    @property
    def control_bounds(self) -> Bounds:
        """Return the wrench box, shape (4,) each."""
        lower, upper = self.wrench_bounds
        return lower.copy(), upper.copy()

    def rotor_thrusts(self, u: Expression) -> Expression:
        """Return the least-squares rotor thrusts of wrenches u (..., 4), N, shape (..., rotors)."""
        return self.allocation.rotor_thrusts(u)


def _euler_rates(
    phi: Expression, theta: Expression, p: Expression, q: Expression, r: Expression
) -> list[Expression]:
    """Return T(φ, θ) [p, q, r], equations (6) and (7), rad/s."""
    sf, cf, st, ct = sine(phi), cosine(phi), sine(theta), cosine(theta)
    yaw_rate = (sf * q + cf * r) / ct
    return [p + st * yaw_rate, cf * q - sf * r, yaw_rate]
