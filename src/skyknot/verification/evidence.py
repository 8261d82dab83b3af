"""What checks look at: the problem's equations and the trajectory, at nodes and between them.

Legend: N segments, nx states, nu controls, D samples in a segment, τ in [0, 1] inside it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.problem.problem import Problem
from skyknot.trajectory import SegmentData, Trajectory
from skyknot.verification import closed_loop, polynomials
from skyknot.verification.adjoint import Adjoint
from skyknot.verification.equations import Equations
from skyknot.verification.finite_program import FiniteProgram
from skyknot.verification.integration import fly
from skyknot.witness import Witness

Array = NDArray[np.float64]

DENSITY = 12
"""Samples in a segment: at 10 m/s and 0.1 s a segment, one every 8 cm."""

DENSITY_PER_POINT = 4
"""Samples for each point of a segment that has many: its polynomials turn that often."""


@dataclass(frozen=True)
class Samples:
    """The trajectory between its nodes, segment after segment.

    Attributes
    ----------
    times : (N·D,) s
    states, controls : (N·D, nx), (N·D, nu), by the trajectory's own interpolant
    state_rates : (N·D, nx) the interpolant's own dx/dt
    rates : (N·D, nx) dx/dt by the equations
    path : (N·D, ng) path constraints
    """

    times: Array
    states: Array
    controls: Array
    state_rates: Array
    rates: Array
    path: Array


class Evidence:
    """A problem, a trajectory, and everything measured once for all checks.

    Parameters
    ----------
    problem : what was asked
    trajectory : the answer; without segment data it is read as linear between nodes
    parameters : values of free parameters by name; the problem's own where left out. Parameters
        that are given keep the problem's values, whatever stands here
    witness : scheme and multipliers claimed, if any
    equations : the problem's, where they are compiled already

    Raises
    ------
    UserError
        When the trajectory's columns do not fit the problem.
    """

    def __init__(
        self,
        problem: Problem,
        trajectory: Trajectory,
        parameters: Mapping[str, float],
        witness: Witness | None = None,
        equations: Equations | None = None,
    ) -> None:
        _check_columns(problem, trajectory)
        self.witness = witness
        self.problem, self.trajectory = problem, trajectory
        free = problem.free_parameters
        self.parameters = {name: parameters[name] for name in free if name in parameters}
        self.equations = equations or Equations(problem, self.parameters)

    @property
    def times(self) -> Array:
        """(N+1,) node times, s."""
        return self.trajectory.times

    @cached_property
    def lengths(self) -> Array:
        """(N,) lengths of the segments, s."""
        return np.diff(self.times)

    @cached_property
    def program(self) -> FiniteProgram | None:
        """The finite program that the witness belongs to; None without a witness."""
        if self.witness is None:
            return None
        return FiniteProgram(
            self.problem, self.trajectory, self.segments, self.parameters, self.witness
        )

    @cached_property
    def adjoint(self) -> Adjoint | None:
        """The costates claimed; None without a witness or without costates."""
        if self.program is None or self.program.witness.costates is None:
            return None
        return Adjoint(self.program, self.program.witness.costates)

    @cached_property
    def density(self) -> int:
        """D: samples in a segment."""
        inside = self.segments
        points = max(len(inside.rate_points), len(inside.control_points))
        return max(DENSITY, DENSITY_PER_POINT * points)

    @cached_property
    def segments(self) -> SegmentData:
        """The inside of the segments; straight lines where the trajectory carries none."""
        own = self.trajectory.segments
        if own is not None:
            return own
        states, controls = self.trajectory.states, self.trajectory.controls
        slope = np.diff(states, axis=0) / self.lengths[:, None]
        middle = 0.5 * (states[:-1] + states[1:])
        return SegmentData(
            rate_points=np.array([0.0, 0.5, 1.0]),
            rates=np.repeat(slope[:, None], 3, axis=1),
            control_points=np.array([0.0, 1.0]),
            control_values=np.stack([controls[:-1], controls[1:]], axis=1),
            interior_points=np.array([0.5]),
            interior_states=middle[:, None],
        )

    @cached_property
    def control_polynomials(self) -> Array:
        """(N, m, nu) Chebyshev coefficients of the controls."""
        return polynomials.coefficients(self.segments.control_points, self.segments.control_values)

    @cached_property
    def state_polynomials(self) -> Array:
        """(N, d, nx) Chebyshev coefficients of the states: integrals of the stored rates."""
        inside = self.segments
        slopes = polynomials.coefficients(inside.rate_points, inside.rates)
        result: Array = self.lengths[:, None, None] * polynomials.integrated(slopes)
        result[:, 0] += self.trajectory.states[:-1]
        return result

    @cached_property
    def stage_rates(self) -> Array:
        """(N, s, nx) dx/dt by the equations at the rate points, at the states solved for there."""
        points, h = self.segments.rate_points, self.lengths
        X = np.stack([self._stage_state(tau) for tau in points], axis=1)
        U = polynomials.evaluated(self.control_polynomials, points)
        t = self.times[:-1, None] + h[:, None] * points
        n, s = t.shape
        rates = self.equations.rates(X.reshape(n * s, -1), U.reshape(n * s, -1), t.ravel())
        return rates.reshape(n, s, -1)

    @cached_property
    def samples(self) -> Samples:
        """The trajectory at the middles of D equal parts of every segment."""
        tau = (np.arange(self.density) + 0.5) / self.density
        times = (self.times[:-1, None] + self.lengths[:, None] * tau).ravel()
        X, U = self.trajectory.state(times), self.trajectory.control(times)
        return Samples(
            times=times,
            states=X,
            controls=U,
            state_rates=self.trajectory.state_rate(times),
            rates=self.equations.rates(X, U, times),
            path=self.equations.path(X, U, times),
        )

    @cached_property
    def flown(self) -> Array:
        """(N+1, nx) states of the open-loop flight; NaN from where the integrator gave up."""
        return fly(self.equations, self.trajectory, self.control_polynomials)

    @cached_property
    def tracked(self) -> Array | None:
        """(S, N+1, nx) states flown with feedback, from the exact and from perturbed starts.

        None without gains, or where the cost does not curve in a control: the gains are then the
        solver's barrier and not the problem's.
        """
        gains = None if self.witness is None else self.witness.gains
        if gains is None or self.adjoint is None or self.adjoint.flat_controls:
            return None
        p, begin = self.problem, closed_loop.starts(self.trajectory.states)
        reference = closed_loop.reference(
            self.trajectory, self.state_polynomials, self.control_polynomials, gains
        )
        return closed_loop.track(p, self.equations.parameters, reference, begin)

    @cached_property
    def state_sizes(self) -> Array:
        """(nx,) size of each state: given, or the largest of 1, its bounds, its ends, its values.

        The floor of 1 makes errors absolute, in the user's unit, for small states (as Betts,
        Practical Methods for Optimal Control, does for mesh refinement).
        """
        p = self.problem
        ends = (p.initial_lower, p.initial_upper, p.final_lower, p.final_upper)
        known = np.stack([p.state_lower, p.state_upper, *ends])
        bound = np.max(np.where(np.isfinite(known), np.abs(known), 0.0), axis=0)
        reached = np.max(np.abs(self.trajectory.states), axis=0)
        sizes = np.maximum(np.maximum(bound, reached), 1.0)
        given = [np.nan if s.scale is None else s.scale for s in p.states]
        return np.where(np.isnan(given), sizes, given)

    @property
    def unit_sizes(self) -> Array:
        """(nx,) sizes that tolerances of solvers refer to: never below 1, the user's unit."""
        return np.maximum(self.state_sizes, 1.0)

    @property
    def state_units(self) -> tuple[str, ...]:
        """Units of the states."""
        return tuple(state.unit for state in self.problem.states)

    @property
    def control_units(self) -> tuple[str, ...]:
        """Units of the controls."""
        return tuple(control.unit for control in self.problem.controls)

    def _stage_state(self, tau: float) -> Array:
        states, inside = self.trajectory.states, self.segments
        if tau in (0.0, 1.0):
            return states[:-1] if tau == 0 else states[1:]
        solved = np.flatnonzero(inside.interior_points == tau)
        if len(solved):
            return inside.interior_states[:, solved[0]]
        result: Array = self.trajectory.state(self.times[:-1] + tau * self.lengths)
        return result


def _check_columns(problem: Problem, trajectory: Trajectory) -> None:
    found = (trajectory.states.shape[1], trajectory.controls.shape[1])
    if found != (problem.nx, problem.nu):
        raise UserError(
            "The trajectory does not fit the problem.",
            where="trajectory",
            found=f"{found[0]} states and {found[1]} controls",
            expected=f"{problem.nx} states and {problem.nu} controls",
            do="Verify it against the problem that it solves.",
        )
