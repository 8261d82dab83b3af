"""A solution as exports read it: sampled in time, by quantity, SI units, NED and FRD axes.

Legend: M sample times, n rotors. ω, ω' : body rates and their derivative, FRD.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.export.frames import quaternion_of_angles
from skyknot.models.flatness import lift
from skyknot.solution import Solution
from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]

WRENCH = ("T", "tau_x", "tau_y", "tau_z")
DENSE = 8
"""Places between two samples at which linear reading is compared with the trajectory."""

TOO_MANY = 2_000_000
"""Samples beyond which a rate is a slip of the pen."""


@dataclass(frozen=True)
class Attitude:
    """Which way the craft points, and how it turns.

    Attributes
    ----------
    angles : (M, 3) roll, pitch, yaw, rad
    quaternions : (M, 4) body FRD → NED, w first
    rates, accelerations : (M, 3) ω [rad/s] and ω' [rad/s²], FRD
    """

    angles: Array
    quaternions: Array
    rates: Array
    accelerations: Array


@dataclass(frozen=True)
class Flight:
    """A flight at sample times.

    Attributes
    ----------
    times : (M,) s, from the start of the flight
    position, velocity, acceleration, jerk, snap : (M, 3) NED, m … m/s⁴; jerk and snap are
        derivatives of the scheme's own polynomial, of low order and with jumps at the nodes
    yaw, yaw_rate : (M,) rad from north clockwise, rad/s; zero for a craft without heading
    attitude : None where the model has none and no vehicle is known to derive it
    thrust : (M,) total thrust, N; None where not known
    rotor_thrusts : (M, n) N; None where not known
    gap : largest distance, m, from the trajectory to the straight lines between samples
    """

    times: Array
    position: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    snap: Array
    yaw: Array
    yaw_rate: Array
    attitude: Attitude | None
    thrust: Array | None
    rotor_thrusts: Array | None
    gap: float


def sample_times(trajectory: Trajectory, rate: float | None, tick: float = 0.0) -> Array:
    """Return (M,) sample times: every 1/rate s and the end; the nodes when ``rate`` is None.

    Parameters
    ----------
    trajectory : what is sampled
    rate : Hz
    tick : times are multiples of it, s; the end is rounded down

    Raises
    ------
    UserError
        When the rate is not a sensible number.
    """
    start, end = float(trajectory.times[0]), float(trajectory.times[-1])
    if rate is None:
        return trajectory.times.copy()
    if not (np.isfinite(rate) and rate > 0 and rate * (end - start) < TOO_MANY):
        raise UserError(
            "The rate cannot be sampled.",
            where="rate",
            found=f"{rate} Hz over {end - start:.4g} s",
            expected=f"a positive rate that gives fewer than {TOO_MANY} samples",
            do="Give a rate such as 50.",
        )
    times = start + np.arange(int(np.floor((end - start) * rate * (1 + 1e-12))) + 1) / rate
    if end - times[-1] > max(1e-9, tick):
        times = np.append(times, end)
    if tick:
        times = start + tick * np.unique(np.floor((times - start) / tick + 0.5 * (times < end)))
    return np.minimum(times, end)


def sampled(solution: Solution, times: Array) -> Flight:
    """Return a flight at times (M,), s.

    Raises
    ------
    UserError
        When the states are not the flight of a craft in NED axes.
    """
    trajectory, names = solution.trajectory, state_names(solution)
    _check_flight(solution, names)
    states, rates = trajectory.state(times), trajectory.state_rate(times)

    def of(values: Array, *wanted: str) -> Array:
        return values[:, [names.index(name) for name in wanted]]

    moving = {"vx", "vy", "vz"} <= set(names)
    velocity_names = ("vx", "vy", "vz") if moving else ("x", "y", "z")
    columns = [names.index(name) for name in velocity_names]
    heading = "psi" in names
    derivatives = [rate_derivative(trajectory, times, i)[:, columns] for i in (1, 2)]
    path = {
        "position": of(states, "x", "y", "z"),
        "velocity": of(states, *velocity_names) if moving else of(rates, "x", "y", "z"),
        "acceleration": of(rates, *velocity_names) if moving else derivatives[0],
        "jerk": derivatives[0] if moving else derivatives[1],
        "snap": derivatives[1] if moving else 0 * derivatives[1],
        "yaw": of(states, "psi")[:, 0] if heading else np.zeros(len(times)),
        "yaw_rate": of(rates, "psi")[:, 0] if heading else np.zeros(len(times)),
    }
    vehicle: Any = getattr(solution.problem, "vehicle", None)
    attitude: Attitude | None
    wrench: tuple[Array, Array | None] | None
    if {"phi", "theta", "psi", "p", "q", "r"} <= set(names):
        angles = of(states, "phi", "theta", "psi")
        turning = of(states, "p", "q", "r"), of(rates, "p", "q", "r")
        attitude = Attitude(angles, quaternion_of_angles(angles), *turning)
        wrench = _commanded(solution, trajectory.control(times))
    else:
        attitude, wrench = _lifted(vehicle, path)
    return Flight(
        times=times - trajectory.times[0],
        **path,
        attitude=attitude,
        thrust=None if wrench is None else np.asarray(wrench[0]),
        rotor_thrusts=None if wrench is None else wrench[1],
        gap=_gap(trajectory, times, [names.index(name) for name in "xyz"]),
    )


def state_names(solution: Solution) -> tuple[str, ...]:
    """Return the names of the states, from the trajectory or else from the problem."""
    stored = solution.trajectory.state_names
    return stored or tuple(getattr(solution.problem, "state_names", ()))


def rate_derivative(trajectory: Trajectory, times: Array, order: int) -> Array:
    """Return (M, nx) derivatives, of the given order, of the state rates' own polynomial."""
    data = trajectory.segments
    if data is None or len(data.rate_points) <= order:
        return np.zeros((len(times), trajectory.states.shape[1]))
    last = len(trajectory.times) - 2
    k = np.clip(np.searchsorted(trajectory.times, times, side="right") - 1, 0, last)
    h = np.diff(trajectory.times)[k]
    tau = (times - trajectory.times[k]) / h
    vandermonde = np.vander(data.rate_points, increasing=True)
    coefficients = np.einsum("ps,ksx->kpx", np.linalg.inv(vandermonde), data.rates)[k]
    powers = np.zeros((len(times), len(data.rate_points)))
    for power in range(order, len(data.rate_points)):
        factor = np.prod(np.arange(power - order + 1, power + 1))
        powers[:, power] = factor * tau ** (power - order)
    result: Array = np.einsum("tp,tpx->tx", powers, coefficients) / h[:, None] ** order
    return result


def _commanded(solution: Solution, controls: Array) -> tuple[Array, Array | None] | None:
    """Return thrust (M,) and rotor thrusts (M, n) of a rigid craft's controls."""
    vehicle: Any = getattr(solution.problem, "vehicle", None)
    names = solution.trajectory.control_names
    if names == WRENCH:
        rotors = None if vehicle is None else np.asarray(vehicle.rotor_thrusts(controls))
        return controls[:, 0], rotors
    if names and all(name == f"f{i + 1}" for i, name in enumerate(names)):
        return controls.sum(axis=1), controls
    return None


def _lifted(
    vehicle: Any, path: dict[str, Array]
) -> tuple[Attitude | None, tuple[Array, Array | None] | None]:
    """Return attitude and thrusts that a point's motion asks of a craft, drag left out."""
    if vehicle is None:
        return None, None
    states, wrench = lift(
        vehicle,
        *(path["position"], path["velocity"], path["acceleration"], path["jerk"], path["snap"]),
        *(path["yaw"], path["yaw_rate"], np.zeros(len(path["yaw"]))),
    )
    torque = wrench[:, 1:]
    inertia, turning = np.array(vehicle.inertia), states[:, 9:12]
    accelerations = (torque - np.cross(turning, inertia * turning)) / inertia
    angles = states[:, 6:9]
    attitude = Attitude(angles, quaternion_of_angles(angles), turning, accelerations)
    return attitude, (wrench[:, 0], np.asarray(vehicle.rotor_thrusts(wrench)))


def _gap(trajectory: Trajectory, times: Array, columns: list[int]) -> float:
    share = np.arange(1, DENSE) / DENSE
    between = (times[:-1, None] + np.diff(times)[:, None] * share).ravel()
    truth, ends = trajectory.state(between)[:, columns], trajectory.state(times)[:, columns]
    straight = ends[:-1, None] + np.diff(ends, axis=0)[:, None] * share[None, :, None]
    return float(np.max(np.linalg.norm(truth - straight.reshape(truth.shape), axis=1), initial=0.0))


def _check_flight(solution: Solution, names: tuple[str, ...]) -> None:
    if {"x", "y", "z"} <= set(names) and solution.record.frame == "NED":
        return
    raise UserError(
        "This is not a flight that can be exported.",
        where="states",
        found=f"{', '.join(names) or 'states without names'}; frame {solution.record.frame}",
        expected="states x, y, z (and vx, vy, vz), north, east, down",
        do="Export the numbers as they are: to netcdf, or with skyknot.write_csv.",
    )
