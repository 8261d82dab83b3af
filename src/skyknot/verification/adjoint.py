"""The costate as a function of time, from the node costates that an answer claims.

Legend: N segments of length h, nx states; p⁺_k, p⁻_{k+1} costate after a segment's first node and
before its last; H = a ℓ + pᵀf with a the share of the segment that the objective's weights add up
to (1 for an integral). A multiplier μ or ζ of a state constraint at a node makes the costate jump
there: p⁻ = p⁺ + g_xᵀμ + ζ (Bryson & Ho, Applied Optimal Control, section 3.13).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from skyknot.verification import polynomials
from skyknot.verification.finite_program import FiniteProgram

Array = NDArray[np.float64]

CUBIC = 3
"""Most state points of a segment whose costate is read as a cubic through its ends."""


FLAT = 1e-6
"""Share of the objective below which moving a control over its room does not count as curvature."""


class Adjoint:
    """Costates at nodes and inside the segments.

    Parameters
    ----------
    program : put together from the witness
    claimed : (N+1, nx) node costates
    """

    def __init__(self, program: FiniteProgram, claimed: Array) -> None:
        self.program, self.claimed = program, claimed
        self.h = program.duration * program.fractions

    @cached_property
    def pulls(self) -> Array:
        """(N, s, nx) g_xᵀμ + ζ at the state points, cost per state unit."""
        nx = self.program.problem.nx
        result: Array = self.program.room[:, :, :nx] + self.program.witness.state_bounds
        return result

    @cached_property
    def ends(self) -> tuple[Array, Array]:
        """(N, nx) p⁺_k and p⁻_{k+1}; jumps of state constraints are taken into account."""
        before = self.claimed[1:].copy()
        before[:-1] += self.pulls[:-1, -1] + self.pulls[1:, 0]
        return self.claimed[:-1], before

    @cached_property
    def share(self) -> Array:
        """(N,) a: the weights of the running cost in a segment over the segment's length."""
        result: Array = np.sum(self.program.witness.weights, axis=1) / self.program.fractions
        return result

    @cached_property
    def stages(self) -> Array:
        """(N, s, nx) multipliers over weights at the points, nan where a point has no weight."""
        b = np.where(self.program.witness.A[-1] > 0, self.program.witness.A[-1], np.nan)
        weight = self.program.fractions[:, None] * b
        result: Array = self.program.nu / weight[:, :, None]
        return result

    @cached_property
    def flat_controls(self) -> tuple[str, ...]:
        """Names of the controls in which the Hamiltonian nowhere curves."""
        program = self.program
        N, s = program.places.shape
        X, U, p = (
            each.reshape(N * s, -1)
            for each in (program.X, program.U, self.at(program.witness.points))
        )
        _, R = program.lagrangian.control_form(
            X, U, program.places.ravel(), np.repeat(self.share, s), p
        )
        curved = (
            np.max(np.abs(np.einsum("pii->pi", R)), axis=0) * program.rooms**2 * program.duration
        )
        flat = ~(curved > FLAT * program.objective_size)
        names = zip(program.problem.control_names, flat, strict=True)
        return tuple(name for name, is_flat in names if is_flat)

    def at(self, tau: Array) -> Array:
        """Return (N, M, nx) costates at places tau (M,) of all segments.

        A cubic through both ends and their slopes −∂H/∂x; in segments of more than three points
        the polynomial through the ends and the stage costates in between.
        """
        first, last = self.ends
        points = self.program.witness.points
        inner = np.flatnonzero(np.all(np.isfinite(self.stages), axis=(0, 2)))
        inner = inner[(points[inner] > 0) & (points[inner] < 1)]
        if len(points) > CUBIC and len(inner):
            places = np.concatenate([[0.0], points[inner], [1.0]])
            known = np.concatenate([first[:, None], self.stages[:, inner], last[:, None]], axis=1)
            return polynomials.evaluated(polynomials.coefficients(places, known), tau)
        start, end = self._end_slopes
        t = tau[None, :, None]
        h = self.h[:, None, None]
        result: Array = (
            (1 + 2 * t) * (1 - t) ** 2 * first[:, None]
            + t**2 * (3 - 2 * t) * last[:, None]
            + h * t * (1 - t) ** 2 * start[:, None]
            - h * t**2 * (1 - t) * end[:, None]
        )
        return result

    def slopes(self, X: Array, U: Array, tau: Array, p: Array) -> Array:
        """Return (N, M, nx) ∂H/∂x at states (N, M, nx), controls (N, M, nu), costates (N, M, nx).

        Parameters
        ----------
        tau : (M,) places in the segments
        """
        program, (N, M, nx) = self.program, X.shape
        start = program.places[:, :1]
        places = (start + program.fractions[:, None] * tau).ravel()
        flat = [each.reshape(N * M, -1) for each in (X, U, p)]
        none = np.zeros((N * M, program.rows.shape[2]))
        found = program.lagrangian.first(
            flat[0], flat[1], places, np.repeat(self.share, M), flat[2], none
        )
        result: Array = found[3][:, :nx].reshape(N, M, nx) / program.duration
        return result

    @cached_property
    def _end_slopes(self) -> tuple[Array, Array]:
        """(N, nx) −∂H/∂x after each segment's first node and before its last."""
        program, ends = self.program, np.array([0.0, 1.0])
        X, U = program.X[:, [0, -1]], program.U[:, [0, -1]]
        slopes = -self.slopes(X, U, ends, np.stack(self.ends, axis=1))
        return slopes[:, 0], slopes[:, 1]
