"""Checks of the costates: against the multipliers, against their equation, and at the ends.

Legend: p costate, H = ℓ + pᵀf, μ and ζ multipliers of constraints and bounds on the state, M end
cost; N segments, nx states.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.verification.base import Check, cost_per, worst_of
from skyknot.verification.evidence import Evidence
from skyknot.verification.tolerances import Limits

Array = NDArray[np.float64]

FLOOR = 1e-3
"""Share of the objective that a state's size must move before its costate counts as large."""


def costates(evidence: Evidence, limits: Limits) -> Check | None:
    """Check the claimed node costates against those that the multipliers give.

    p_k = ∂/∂x_k [J_k + λ_kᵀ d_k], terms of segment k alone (Hager, Numer. Math. 87, 2000).
    """
    program, adjoint = evidence.program, evidence.adjoint
    if program is None or adjoint is None:
        return None
    first, last = program.costates
    known = np.concatenate([first, last[-1:]])
    return worst_of(
        "costates",
        "Claimed costates at the nodes against those computed anew from the defects' multipliers.",
        np.abs(adjoint.claimed - known),
        limits.optimality * np.maximum(_largest(known), 1.0),
        evidence.problem.state_names,
        _units(evidence),
        evidence.times,
    )


def transversality(evidence: Evidence, limits: Limits) -> Check | None:
    """Check p(t₀) = −gᵀμ and p(t_f) = ∂M/∂x + gᵀμ for the states that an end leaves free."""
    program, adjoint = evidence.program, evidence.adjoint
    if program is None or adjoint is None:
        return None
    nx = evidence.problem.nx
    lower, upper = (bound[[0, -1], [0, -1]] for bound in program.state_bounds)
    values = evidence.trajectory.states[[0, -1]]
    slack = np.minimum(values - lower, upper - values)
    free = slack > 10 * limits.feasibility * np.maximum(np.abs(values), 1.0)
    if not np.any(free):
        return None
    room = program.room[[0, -1], [0, -1], :nx]
    asked = np.stack([-room[0], program.end[1][:nx] + room[1]])
    sizes = np.maximum(np.maximum(_largest(adjoint.claimed), _largest(asked)), 1.0)
    # A bound at a distance pulls with no more than the complementarity allowed over the distance.
    pull = limits.optimality * program.objective_size / np.where(free, slack, np.inf)
    excess = np.where(free, np.abs(adjoint.claimed[[0, -1]] - asked) - pull, 0.0)
    return worst_of(
        "transversality",
        "Costates of states left free at the start and at the end, against the slope of the end"
        " cost and of the constraints that act there.",
        np.maximum(excess, 0.0),
        limits.optimality * sizes,
        evidence.problem.state_names,
        _units(evidence),
        evidence.times[[0, -1]],
    )


def costate_equation(evidence: Evidence, limits: Limits) -> Check | None:
    """Check dp/dt = −∂H/∂x between the nodes, jumps of state constraints accounted for."""
    program, adjoint = evidence.program, evidence.adjoint
    if program is None or adjoint is None:
        return None
    abscissae, weights = np.polynomial.legendre.leggauss(max(5, len(program.witness.points)))
    tau = 0.5 * (abscissae + 1)
    N, M = len(adjoint.h), len(tau)
    times = (evidence.times[:-1, None] + adjoint.h[:, None] * tau).ravel()
    X = evidence.trajectory.state(times).reshape(N, M, -1)
    U = evidence.trajectory.control(times).reshape(N, M, -1)
    slopes = adjoint.slopes(X, U, tau, adjoint.at(tau))
    change = 0.5 * adjoint.h[:, None] * np.einsum("m,kmx->kx", weights, slopes)
    first, last = adjoint.ends
    gaps = last - first + change + np.sum(adjoint.pulls[:, 1:-1], axis=1)
    floor = FLOOR * program.objective_size / evidence.state_sizes
    return worst_of(
        "costate equation",
        "Change of the costate over each segment against the integral of −∂H/∂x, by Gauss"
        " quadrature along the interpolants; multipliers of state constraints count as jumps.",
        np.abs(gaps),
        limits.costate * np.maximum(_largest(adjoint.claimed), floor),
        evidence.problem.state_names,
        _units(evidence),
        evidence.times[:-1],
    )


def _largest(values: Array) -> Array:
    """Return (nx,) the largest absolute value of each column, of those that are finite."""
    known = np.where(np.isfinite(values), np.abs(values), 0.0)
    result: Array = np.max(known, axis=0)
    return result


def _units(evidence: Evidence) -> tuple[str, ...]:
    return tuple(cost_per(unit) for unit in evidence.state_units)
