"""How far a discretised trajectory is from obeying the dynamics, segment by segment.

Three measures, all relative to the sizes of the states:

- *between*: η_ki = ∫ |dx_i/dt − f_i(x, u)| dt over segment k, the interpolant against the dynamics
  (J. T. Betts, Practical Methods for Optimal Control, 2nd ed., section 4.7);
- *missed*: the controls of one segment flown accurately from its first node, against its second;
- *apart*: the whole flight, open loop from the first node, against the nodes. It comes from the
  misses by multiple shooting: e_{k+1} = Φ_k e_k + d_k, then all segments are flown again, at once,
  from x_k + e_k, until the flown pieces join (Newton's method on the junctions).

A jump of a control that is spread over some time is no error of the dynamics; it is told besides.

Legend: N segments, nx states, M places, Φ transition matrix, d missed, e apart, w sizes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.transcription.pointwise import PointFunctions
from skyknot.transcription.segment_flight import Motion
from skyknot.transcription.switches import smeared

Array = NDArray[np.float64]

SAMPLES = 8
"""Gauss–Legendre places in a segment, where the interpolant meets the dynamics."""

ROUNDING = 1e-9
"""Distance, relative to the sizes, below which the pieces join as well as they can."""

JUNCTIONS = 3
"""Most passes over the junctions of the flown pieces."""


@dataclass(frozen=True)
class SegmentError:
    """What was measured; states over their sizes, so 1e-4 means a ten-thousandth of the size.

    Attributes
    ----------
    between : (N, nx) η, integral of the dynamics' residual over a segment
    missed : (N, nx) miss at the end of a segment flown by itself
    apart : (N+1, nx) distance of the open-loop flight from the nodes
    effect : (N,) largest change that the miss of one segment makes in any later state
    passed : (N,) how far limits are passed inside a segment, over the size of the bound (at least
        1 for states): the peak for limits on states, the mean for those that involve controls
    smeared : (N,) share of the horizon over which a jump of a control in the segment is spread
    sizes : (nx,) w: the state's scale where given, else 1 + its largest magnitude
    """

    between: Array
    missed: Array
    apart: Array
    effect: Array
    passed: Array
    smeared: Array
    sizes: Array

    @property
    def dynamics(self) -> float:
        """Largest error between the nodes: of the residual's integrals and the segments' misses."""
        return max(_largest(self.between), _largest(self.missed))

    @property
    def flight(self) -> float:
        """Largest distance of the open-loop flight from the nodes; infinite where it diverged."""
        return _largest(self.apart)

    @property
    def constraints(self) -> float:
        """Largest passing of a bound or path constraint between the nodes."""
        return _largest(self.passed)

    @property
    def switching(self) -> float:
        """Largest share of the horizon over which a jump of a control is spread."""
        return _largest(self.smeared)


def segment_error(
    problem: Problem,
    trajectory: Trajectory,
    parameters: Mapping[str, float],
    functions: PointFunctions,
    near: float = 0.1,
) -> SegmentError:
    """Return the errors of a trajectory that carries the interpolant of its scheme.

    Parameters
    ----------
    parameters : values of free globals by name, as in a solution's record
    functions : the problem's functions, made once for all meshes
    near : the flight is joined piece by piece where its first estimate is below this; above, the
        estimate alone tells enough
    """
    motion = Motion(problem, trajectory, parameters, functions)
    w = state_sizes(problem, trajectory)
    between, passed = _between(motion)
    with np.errstate(all="ignore"):  # a flight that diverges is an infinite error, no warning
        missed = motion.flown(trajectory.states[:-1], w) - trajectory.states[1:]
        Phi = motion.transitions()
        apart, effect = _propagated(Phi, missed, w)
        apart = _joined(motion, Phi, apart, w, near)
    spread = smeared(problem, trajectory)
    return SegmentError(between / w, missed / w, apart / w, effect, passed, spread, w)


def state_sizes(problem: Problem, trajectory: Trajectory) -> Array:
    """Return (nx,) sizes that errors refer to: the scale given, else 1 + the largest magnitude.

    The 1 makes errors of small states absolute, in the user's unit, as in Betts' section 4.7.
    """
    reached = 1.0 + np.max(np.abs(trajectory.states), axis=0)
    given = [np.nan if state.scale is None else state.scale for state in problem.states]
    return np.where(np.isnan(given), reached, given)


def _between(motion: Motion) -> tuple[Array, Array]:
    """Return (N, nx) integrals of the residual, and (N,) how far constraints are passed."""
    abscissae, weights = np.polynomial.legendre.leggauss(SAMPLES)
    trajectory, N = motion.trajectory, len(motion.h)
    t = (motion.times[:-1, None] + motion.h[:, None] * 0.5 * (abscissae + 1)).ravel()
    X, U = trajectory.state(t), trajectory.control(t)
    packed = motion.packed(X, U, t)
    residual = np.abs(trajectory.state_rate(t) - motion.rates(packed)).reshape(N, SAMPLES, -1)
    integral = motion.h[:, None] * np.einsum("s,ksx->kx", 0.5 * weights, residual)
    values = motion.at(motion.tapes.path, packed) if len(motion.problem.path) else X[:, :0]
    return integral, _passed(motion, X, U, values, weights)


def _passed(motion: Motion, X: Array, U: Array, values: Array, weights: Array) -> Array:
    """Return (N,) how far limits are passed: on states the peak, on controls the mean.

    A control overshoots beside a jump, on any mesh, for a time that shrinks with it: the mean over
    the segment counts, and less in a segment that is shorter than the average.
    """
    p, settled, N = motion.problem, motion.tapes.settled, len(motion.h)
    lower = np.array([-np.inf if g.lower is None else g.lower for g in p.path])
    upper = np.array([np.inf if g.upper is None else g.upper for g in p.path])
    peak = _excess(X, p.state_lower, p.state_upper, 1.0)
    peak = np.maximum(peak, _excess(values[:, settled], lower[settled], upper[settled], 1.0))
    mixed = ~settled
    mean = np.maximum(
        _excess(U, p.control_lower, p.control_upper, 0.0),
        _excess(values[:, mixed], lower[mixed], upper[mixed], 0.0),
    ).reshape(N, SAMPLES) @ (0.5 * weights)
    shorter = np.minimum(1.0, motion.h / np.mean(motion.h))
    result: Array = np.maximum(peak.reshape(N, SAMPLES).max(axis=1), mean * shorter)
    return result


def _excess(values: Array, lower: Array, upper: Array, least: float) -> Array:
    """Return (M,) the largest excess over any bound, relative to the bound (at least ``least``)."""
    known = np.abs(np.where(np.isfinite([lower, upper]), [lower, upper], 0.0))
    sizes = np.maximum(np.max(known, axis=0), least)
    sizes = np.where(sizes > 0, sizes, 1.0)
    outside = np.maximum(np.maximum(lower - values, values - upper), 0.0) / sizes
    result: Array = np.max(outside, axis=1, initial=0.0)
    return result


def _propagated(Phi: Array, missed: Array, w: Array) -> tuple[Array, Array]:
    """Return (N+1, nx) the misses added up along the flight, and (N,) the effect of each."""
    N, nx = missed.shape
    apart, effect = np.zeros((N + 1, nx)), np.zeros(N)
    each = np.zeros((nx, N))
    for k in range(N):
        each[:, :k] = Phi[k] @ each[:, :k]
        each[:, k] = missed[k]
        apart[k + 1] = np.sum(each[:, : k + 1], axis=1)
        largest = np.max(np.abs(each[:, : k + 1]) / w[:, None], axis=0)
        effect[: k + 1] = np.fmax(effect[: k + 1], largest)
    return apart, effect


def _joined(motion: Motion, Phi: Array, apart: Array, w: Array, near: float) -> Array:
    """Return (N+1, nx) the distance of a flight whose pieces join; infinite where none does."""
    states = motion.trajectory.states
    if not _largest(apart / w) < near:
        return apart
    for _ in range(JUNCTIONS):
        gaps = motion.flown(states[:-1] + apart[:-1], w) - states[1:] - apart[1:]
        change = np.zeros_like(apart)
        for k in range(len(Phi)):
            change[k + 1] = Phi[k] @ change[k] + gaps[k]
        apart = apart + change
        if _largest(change / w) <= max(0.1 * _largest(apart / w), ROUNDING):
            return apart
    return np.full_like(apart, np.inf)


def _largest(values: Array) -> float:
    """Return the largest magnitude; infinite when a value is not finite."""
    largest = float(np.max(np.abs(values), initial=0.0))
    return largest if np.isfinite(largest) else float("inf")
