"""A trajectory: times, states, controls, and the interpolant of its own scheme.

Legend: N segments, nx states, nu controls, s rate points and m control points in a segment,
τ in [0, 1] the place inside a segment of length h.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from skyknot.errors import UserError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SegmentData:
    """What happens inside the segments, as the scheme itself sees it.

    Attributes
    ----------
    rate_points : (s,) places τ of the state rates
    rates : (N, s, nx) state rates there, state unit per second
    control_points : (m,) places τ of the control values
    control_values : (N, m, nu) control values there
    interior_points : (i,) places τ of the interior states
    interior_states : (N, i, nx) interior states as the scheme solved for them
    """

    rate_points: Array
    rates: Array
    control_points: Array
    control_values: Array
    interior_points: Array
    interior_states: Array


@dataclass(frozen=True)
class Trajectory:
    """States and controls over time, readable at any time.

    Without ``segments`` states and controls are linear between the nodes (a guess, say). With
    them, the state is the integral of the polynomial through the scheme's own rates and the
    control the polynomial through its own control values, so that what is read between the
    nodes is what the scheme solved.

    Parameters
    ----------
    times : (N+1,) increasing, s
    states : (N+1, nx)
    controls : (N+1, nu), at the nodes; with a held control the value after the node
    segments : what happens inside the segments
    state_names, control_names : names of the columns

    Raises
    ------
    UserError
        When shapes disagree, times do not increase, or a value is not finite.
    """

    times: Array
    states: Array
    controls: Array
    segments: SegmentData | None = None
    state_names: tuple[str, ...] = field(default=())
    control_names: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        for name in ("times", "states", "controls"):
            object.__setattr__(self, name, np.asarray(getattr(self, name), dtype=float))
        _check(self.times, self.states, self.controls)

    @property
    def duration(self) -> float:
        """Time from the first node to the last, s."""
        return float(self.times[-1] - self.times[0])

    def state(self, t: ArrayLike) -> Array:
        """Return the state at t [s]: (nx,) for a scalar, (M, nx) for an array of M times."""
        k, tau, h, scalar = located(self.times, t)
        if self.segments is None:
            values = (1 - tau)[:, None] * self.states[k] + tau[:, None] * self.states[k + 1]
        else:
            weights = integral_basis(self.segments.rate_points, tau)
            values = self.states[k] + h[:, None] * np.einsum(
                "ts,tsx->tx", weights, self.segments.rates[k]
            )
        return values[0] if scalar else values

    def control(self, t: ArrayLike) -> Array:
        """Return the control at t [s]: (nu,) for a scalar, (M, nu) for an array of M times."""
        k, tau, _, scalar = located(self.times, t)
        if self.segments is None:
            values = (1 - tau)[:, None] * self.controls[k] + tau[:, None] * self.controls[k + 1]
        else:
            weights = lagrange_basis(self.segments.control_points, tau)
            values = np.einsum("tm,tmu->tu", weights, self.segments.control_values[k])
        return values[0] if scalar else values

    def state_rate(self, t: ArrayLike) -> Array:
        """Return the time derivative of the state's interpolant at t [s]."""
        k, tau, h, scalar = located(self.times, t)
        if self.segments is None:
            values = (self.states[k + 1] - self.states[k]) / h[:, None]
        else:
            weights = lagrange_basis(self.segments.rate_points, tau)
            values = np.einsum("ts,tsx->tx", weights, self.segments.rates[k])
        return values[0] if scalar else values


def located(times: Array, t: ArrayLike) -> tuple[NDArray[np.intp], Array, Array, bool]:
    """Return segment, place τ in it and its length for every t, and whether t is a scalar.

    Parameters
    ----------
    times : (N+1,) node times; a t beyond them is held at their ends
    """
    asked = np.asarray(t, dtype=float)
    flat = np.atleast_1d(asked).ravel()
    k = times.searchsorted(flat, side="right") - 1
    k = np.minimum(np.maximum(k, 0), len(times) - 2)
    begin = times[k]
    h = times[k + 1] - begin
    tau = np.minimum(np.maximum((flat - begin) / h, 0.0), 1.0)
    return k, tau, h, asked.ndim == 0


def barycentric_weights(points: Array) -> Array:
    """Return the (s,) weights w_i = 1/Π_{j≠i} 4(p_i − p_j), of any common scale.

    The factor 4, one over the capacity of [0, 1], keeps the products from under- and overflowing
    (Berrut & Trefethen, SIAM Review 46 (2004) 501–517, section 7).
    """
    gaps = 4 * (points[:, None] - points[None, :])
    np.fill_diagonal(gaps, 1.0)
    result: Array = 1 / np.prod(gaps, axis=1)
    return result


def lagrange_basis(points: Array, tau: Array) -> Array:
    """Return the (M, s) values at ``tau`` of the Lagrange polynomials on ``points`` (s,).

    By the second barycentric formula, which is stable for the points of collocation schemes at
    any number (Higham, IMA J. Numer. Anal. 24 (2004) 547–556).
    """
    gaps = tau[:, None] - points[None, :]
    hits = gaps == 0
    on_point = np.any(hits, axis=1, keepdims=True)
    shares = np.where(on_point, hits, barycentric_weights(points) / np.where(hits, 1.0, gaps))
    values: Array = shares / np.sum(shares, axis=1, keepdims=True)
    return values


def integral_basis(points: Array, tau: Array) -> Array:
    """Return the (M, s) integrals from 0 to ``tau`` of the Lagrange polynomials on ``points``.

    Gauss–Legendre quadrature with enough points is exact for these polynomials.
    """
    abscissae, weights = np.polynomial.legendre.leggauss(len(points) // 2 + 1)
    inner = 0.5 * tau[:, None] * (abscissae + 1)
    values = lagrange_basis(points, inner.ravel()).reshape(*inner.shape, len(points))
    result: Array = 0.5 * tau[:, None] * np.einsum("g,tgs->ts", weights, values)
    return result


def _check(times: Array, states: Array, controls: Array) -> None:
    n = len(times)
    if times.ndim != 1 or n < 2 or not (times[1:] > times[:-1]).all():
        raise UserError(
            "The times of a trajectory must increase.",
            where="times",
            found=f"shape {times.shape}",
            expected="at least two increasing numbers [s]",
            do="Sort the times and drop repeated ones.",
        )
    for name, values in (("states", states), ("controls", controls)):
        if values.ndim != 2 or len(values) != n:
            raise UserError(
                f"The {name} of a trajectory must have one row for each time.",
                where=name,
                found=f"shape {values.shape}",
                expected=f"({n}, number of {name})",
                do="Put time first: one row per node.",
            )
    if not all(np.isfinite(values).all() for values in (times, states, controls)):
        raise UserError(
            "A trajectory holds a value that is not a finite number.",
            where="times, states or controls",
            found="NaN or infinity",
            expected="finite numbers",
            do="Replace the missing values, e.g. by interpolation.",
        )
