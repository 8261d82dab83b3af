"""Checks of the equations of motion: defects, the interpolant, and what happens between nodes."""

from __future__ import annotations

import numpy as np

from skyknot.verification import polynomials
from skyknot.verification.base import Check, worst_of
from skyknot.verification.evidence import Evidence
from skyknot.verification.tolerances import Limits


def defects(evidence: Evidence, limits: Limits) -> Check:
    """Check that integrating the dynamics leads from node to node, through the interior states.

    d = x_k + h ∫₀^τ Σ_j f(x_j, u_j) L_j − x(τ), predicted minus actual, equations (11)–(12) of the
    source report for Hermite–Simpson; f is evaluated anew.
    """
    inside, h = evidence.segments, evidence.lengths[:, None, None]
    states, times = evidence.trajectory.states, evidence.times
    path = polynomials.integrated(
        polynomials.coefficients(inside.rate_points, evidence.stage_rates)
    )
    tau = np.append(inside.interior_points, 1.0)
    actual = np.concatenate([inside.interior_states, states[1:, None]], axis=1)
    gaps = np.abs(states[:-1, None] + h * polynomials.evaluated(path, tau) - actual)
    return worst_of(
        "defects",
        "Dynamics evaluated anew and integrated from each node to the interior states and to the"
        " next node, against the states there.",
        gaps.reshape(-1, states.shape[1]),
        limits.feasibility * evidence.unit_sizes,
        evidence.problem.state_names,
        evidence.state_units,
        (times[:-1, None] + h[:, 0] * tau).ravel(),
    )


def interpolant(evidence: Evidence, limits: Limits) -> Check:
    """Check that what the trajectory says between its nodes is what the equations say there."""
    inside, h = evidence.segments, evidence.lengths
    p, times = evidence.problem, evidence.times
    gaps = h[:, None, None] * np.abs(inside.rates - evidence.stage_rates)
    places = times[:-1, None] + h[:, None] * inside.rate_points
    start = polynomials.evaluated(evidence.control_polynomials, np.array([0.0]))[:, 0]
    begins = bool(inside.control_points[0] == 0)
    apart = np.abs(start - evidence.trajectory.controls[:-1]) * begins
    rows = len(places.ravel())
    excess = np.zeros((rows + len(apart), p.nx + p.nu))
    excess[:rows, : p.nx] = gaps.reshape(rows, p.nx)
    excess[rows:, p.nx :] = apart
    control_sizes = np.maximum(np.max(np.abs(evidence.trajectory.controls), axis=0), 1.0)
    return worst_of(
        "interpolant",
        "State rates stored inside the segments, times the segment's length, against the dynamics;"
        " controls at the nodes against the control polynomials.",
        excess,
        limits.feasibility * np.concatenate([evidence.unit_sizes, control_sizes]),
        (*p.state_names, *p.control_names),
        (*evidence.state_units, *evidence.control_units),
        np.concatenate([places.ravel(), times[:-1]]),
    )


def dynamics_between(evidence: Evidence, limits: Limits) -> Check:
    """Check the dynamics between the nodes: ∫ |dx/dt − f(x, u)| dt over every segment."""
    samples, times = evidence.samples, evidence.times
    nx = evidence.problem.nx
    error = np.abs(samples.state_rates - samples.rates).reshape(-1, evidence.density, nx)
    return worst_of(
        "dynamics between nodes",
        "Integral over one segment of the difference between the interpolant's slope and the"
        f" dynamics, by the midpoint rule with {evidence.density} samples.",
        evidence.lengths[:, None] * np.mean(error, axis=1),
        limits.dynamics * evidence.state_sizes,
        evidence.problem.state_names,
        evidence.state_units,
        times[:-1],
    )
