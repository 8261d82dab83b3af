"""One segment flown by itself, all of them at once: the dynamics over lanes of segments.

Legend: N segments of length h, nx states, nu controls, M places, A = ∂f/∂x, Φ transition matrix,
F = T f with the duration T, q globals, p parameters, w sizes of the states.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.tape import Tape
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory, lagrange_basis
from skyknot.transcription.pointwise import PointFunctions, global_names, parameter_values

Array = NDArray[np.float64]

STEPS = (2, 4, 8, 16, 32, 64)
"""Steps of the flight of one segment; more are taken while two results differ."""

FLIGHT_ACCURACY = 0.01
"""Share of what is measured (the miss, at least 1e-9 of the size) to which a segment is flown."""


class Motion:
    """The dynamics at a trajectory's own controls, over all segments at once.

    Parameters
    ----------
    trajectory : with the interpolant of its scheme
    parameters : values of free globals by name
    functions : the problem's functions
    """

    def __init__(
        self,
        problem: Problem,
        trajectory: Trajectory,
        parameters: Mapping[str, float],
        functions: PointFunctions,
    ) -> None:
        self.problem, self.trajectory = problem, trajectory
        assert trajectory.segments is not None
        self.inside = trajectory.segments
        self.tapes = tapes_of(functions.point, len(problem.path))
        self.q = np.array([parameters[name] for name in global_names(problem)])
        self.p = parameter_values(problem)
        self.times, self.h = trajectory.times, np.diff(trajectory.times)

    def packed(self, X: Array | None, U: Array, t: Array) -> Array:
        """Return (M, all inputs) what a tape reads at M states, controls and times [s]."""
        M, nx, nu = len(U), self.problem.nx, self.problem.nu
        result = np.empty((M, nx + nu + len(self.q) + 1 + len(self.p)))
        if X is not None:
            result[:, :nx] = X
        result[:, nx : nx + nu] = U
        result[:, nx + nu : nx + nu + len(self.q)] = self.q
        result[:, nx + nu + len(self.q)] = (t - self.times[0]) / self.trajectory.duration
        result[:, nx + nu + len(self.q) + 1 :] = self.p
        return result

    def at(self, tape: Tape, packed: Array) -> Array:
        """Return (M, outputs) of a tape at packed inputs."""
        result = np.empty((len(packed), int(tape.output_offsets[-1])))
        tape.native.evaluate_points(packed, result)
        return result

    def rates(self, packed: Array) -> Array:
        """Return (M, nx) dx/dt."""
        return self.at(self.tapes.rates, packed) / self.trajectory.duration

    def controls(self, tau: Array, rows: NDArray[np.intp]) -> Array:
        """Return (M, len(rows), nu) controls at M places of each of the segments ``rows``."""
        weights = lagrange_basis(self.inside.control_points, tau)
        result: Array = np.einsum("tm,kmu->tku", weights, self.inside.control_values[rows])
        return result

    def flown(self, X: Array, w: Array) -> Array:
        """Return (N, nx) where each segment ends when flown from X (N, nx).

        The classic Runge–Kutta method with twice as many steps until two results agree,
        extrapolated: order 5.
        """
        result = np.empty_like(X)
        rows = np.arange(len(X))
        coarse = self._steps(X, rows, STEPS[0])
        for steps in STEPS[1:]:
            fine = self._steps(X[rows], rows, steps)
            better = fine + (fine - coarse) / 15
            result[rows] = better
            miss = np.abs(better - self.trajectory.states[rows + 1]) / w
            enough = FLIGHT_ACCURACY * np.maximum(miss.max(axis=1), 1e-9)
            open_ = ~(np.max(np.abs(better - fine) / w, axis=1) <= enough)
            open_ &= np.all(np.isfinite(fine), axis=1)
            rows, coarse = rows[open_], fine[open_]
            if len(rows) == 0:
                break
        return result

    def _steps(self, X: Array, rows: NDArray[np.intp], steps: int) -> Array:
        tau, nx = np.linspace(0.0, 1.0, 2 * steps + 1), X.shape[1]
        U = self.controls(tau, rows)
        t = self.times[rows] + tau[:, None] * self.h[rows]
        packed = self.packed(None, U.reshape(-1, U.shape[2]), t.ravel())
        packed = packed.reshape(len(tau), len(rows), -1)
        d = (self.h[rows] / steps)[:, None]

        def rates(place: int, X: Array) -> Array:
            packed[place, :, :nx] = X
            return self.rates(packed[place])

        for i in range(0, 2 * steps, 2):
            k1 = rates(i, X)
            k2 = rates(i + 1, X + 0.5 * d * k1)
            k3 = rates(i + 1, X + 0.5 * d * k2)
            k4 = rates(i + 2, X + d * k3)
            X = X + d / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return X

    def transitions(self) -> Array:
        """Return (N, nx, nx) Φ of the segments: one Runge–Kutta step of dΦ/dt = A Φ."""
        N, nx = len(self.h), self.problem.nx
        rows = np.arange(N)
        tau = np.array([0.0, 0.5, 1.0])
        U = self.controls(tau, rows).reshape(3 * N, -1)
        t = (self.times[:-1] + tau[:, None] * self.h).ravel()
        X = self.trajectory.state(t)
        A = self.at(self.tapes.slopes, self.packed(X, U, t)) / self.trajectory.duration
        A = A.reshape(3, N, nx, nx).transpose(0, 1, 3, 2)
        identity, h = np.eye(nx), self.h[:, None, None]
        k1 = A[0]
        k2 = A[1] @ (identity + 0.5 * h * k1)
        k3 = A[1] @ (identity + 0.5 * h * k2)
        k4 = A[2] @ (identity + h * k3)
        result: Array = identity + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return result


@dataclass(frozen=True)
class MotionTapes:
    """Tapes of one point (x, u, q, τ, p).

    Attributes
    ----------
    rates : F, slopes : ∂F/∂x, path : the path constraints
    settled : (ng,) which of them see no control
    """

    rates: Tape
    slopes: Tape
    path: Tape
    settled: NDArray[np.bool_]


@lru_cache(maxsize=32)
def tapes_of(point: ca.Function, constraints: int) -> MotionTapes:
    """Return the tapes of a problem's point function with that many path constraints."""
    inputs = [ca.SX.sym(point.name_in(i), *point.size_in(i)) for i in range(5)]
    _, F, g = point(*inputs)
    F, slopes = ca.densify(F), ca.densify(ca.jacobian(F, inputs[0]))
    depends = ca.which_depends(g[:constraints], inputs[1], 1, True) if constraints else []
    settled = np.array([not by_control for by_control in depends], dtype=bool)
    path = ca.densify(g[:constraints]) if constraints else ca.SX(0, 1)
    tapes = [Tape(ca.Function("motion", inputs, [ca.cse(e)])) for e in (F, slopes, path)]
    return MotionTapes(tapes[0], tapes[1], tapes[2], settled)
