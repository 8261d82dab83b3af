"""Checks of the Hamiltonian: constant along the way, and least over the controls.

Legend: H = ℓ + pᵀf; N segments of length h_k, R rate rows; M end cost; d = v − u a change of the
control, b = ∂H/∂u, R = ∂²H/∂u².
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from skyknot.verification.adjoint import Adjoint
from skyknot.verification.base import Check
from skyknot.verification.evidence import Evidence
from skyknot.verification.finite_program import FiniteProgram
from skyknot.verification.tolerances import Limits

Array = NDArray[np.float64]

SWEEPS = 30
"""Sweeps of coordinate descent over the controls; one is exact where controls do not mix."""

SAMPLES = 33
"""Values tried of each control where the Hamiltonian is not quadratic in the controls."""


def constancy(evidence: Evidence, limits: Limits) -> Check | None:
    """Check that H is constant where neither problem nor constraints depend on time.

    The Hamiltonian of a segment is the slope of the Lagrangian along the segment's duration. It is
    constant between waypoints, whose times are given, and −∂M/∂T when a free horizon has none.
    """
    program = evidence.program
    if program is None or not program.lagrangian.autonomous:
        return None
    H, size = _of_segments(program)
    targets = _expected(evidence, program, H)
    apart = np.where(np.isfinite(H), np.abs(H - targets), np.inf)
    value = float(program.fractions @ apart)
    limit = limits.hamiltonian * max(size, 1e-12)
    k = int(np.argmax(apart))
    return Check(
        name="Hamiltonian",
        value=value,
        limit=limit,
        unit="cost/s",
        passed=value <= limit,
        how="Slope of the Lagrangian along each segment's duration, against the value it must have"
        " (a constant between waypoints; minus the slope of the end cost when the horizon is"
        " free), averaged over the horizon; allowed is a share of the largest sum of its terms.",
        worst=f"{H[k]:.4g} instead of {targets[k]:.4g} at {evidence.times[k]:.4g} s",
    )


def minimum(evidence: Evidence, limits: Limits) -> Check | None:
    """Check equation (22) of the source report: u minimises H over the control set, pointwise."""
    program, adjoint = evidence.program, evidence.adjoint
    if program is None or adjoint is None:
        return None
    if unjudged(evidence):
        return None
    gaps, how = _gaps(program, adjoint)
    weights = adjoint.h[:, None] * np.maximum(program.witness.A[-1], 0.0)
    value = float(np.sum(np.where(np.isfinite(gaps), gaps, np.inf) * (weights > 0) * weights))
    limit = limits.minimum * program.objective_size
    k, j = np.unravel_index(int(np.argmax(np.nan_to_num(gaps, nan=np.inf))), gaps.shape)
    when = evidence.times[0] + program.duration * program.places[k, j]
    return Check(
        name="minimum principle",
        value=value,
        limit=limit,
        unit="cost",
        passed=value <= limit,
        how="How far the Hamiltonian at the scheme's points lies above its least value over the"
        f" control bounds, integrated over the horizon; the least value {how}.",
        worst=f"at {when:.4g} s",
    )


def unjudged(evidence: Evidence) -> str:
    """Return why the pointwise minimum does not apply; empty where it does."""
    p = evidence.problem
    if np.any(np.isfinite(p.rate_lower) | np.isfinite(p.rate_upper)):
        return "with bounds on their rates, controls at different times depend on one another"
    if np.any(evidence.equations.path_uses_controls):
        return "path constraints mix states and controls"
    return ""


def _of_segments(program: FiniteProgram) -> tuple[Array, float]:
    """Return (N,) H of every segment, and the largest sum of the terms' absolute values."""
    w = program.witness
    cost = np.sum(w.weights * program.cost, axis=1)
    work = program.nu * program.rates
    pull = np.zeros(len(cost))
    segments = program.rate_segments
    share = program.rate_pull * w.rate_spans / max(segments.shape[1], 1)
    for column in range(segments.shape[1]):
        np.add.at(pull, segments[:, column], share)
    H = (cost + np.sum(work, axis=(1, 2)) - pull) / program.fractions
    parts = np.sum(w.weights * np.abs(program.cost), axis=1) + np.sum(np.abs(work), axis=(1, 2))
    return H, float(np.max(np.nan_to_num(parts / program.fractions)))


def _expected(evidence: Evidence, program: FiniteProgram, H: Array) -> Array:
    """Return (N,) the value that H must have in every segment."""
    inside = [entry.at for entry in evidence.problem.points if 0 < entry.at < 1]
    if evidence.problem.free_horizon and not inside:
        end = float(program.global_terms[2, 0])
        return np.full(len(H), -end)
    group = np.searchsorted(np.sort(inside), program.places[:, 0] + 1e-9)
    targets = np.empty(len(H))
    for each in np.unique(group):
        here = group == each
        targets[here] = np.average(H[here], weights=program.fractions[here])
    return targets


def _gaps(program: FiniteProgram, adjoint: Adjoint) -> tuple[Array, str]:
    """Return (N, s) H(u) − min_v H(v) at the state points, and how the minimum was found."""
    N, s = program.places.shape
    P = N * s
    X, U = program.X.reshape(P, -1), program.U.reshape(P, -1)
    costates = adjoint.at(program.witness.points).reshape(P, -1)
    weights = np.repeat(adjoint.share, s)
    lower, upper = _control_set(program, U)
    form = program.lagrangian.control_form(X, U, program.places.ravel(), weights, costates)
    if program.lagrangian.quadratic_in_controls:
        gaps = _box_gaps(*form, lower - U, upper - U)
        return gaps.reshape(N, s), "in closed form, by coordinates where controls mix"

    def hamiltonian(V: Array) -> Array:
        found = program.lagrangian.first(
            X, V, program.places.ravel(), weights, costates, np.zeros((P, program.rows.shape[2]))
        )
        values: Array = weights * found[0] + np.sum(costates * found[1], axis=1)
        return values

    own = hamiltonian(U)
    least = own
    for V in _candidates(U, lower, upper):
        least = np.fmin(least, hamiltonian(V))
    return (own - least).reshape(N, s), f"of {SAMPLES} samples of each control and all corners"


def _control_set(program: FiniteProgram, U: Array) -> tuple[Array, Array]:
    """Return (nu,) bounds; where there is none, the range reached and as much on either side."""
    p = program.problem
    low, high = np.min(U, axis=0), np.max(U, axis=0)
    span = np.maximum(high - low, 1e-9)
    lower = np.where(np.isfinite(p.control_lower), p.control_lower, low - span)
    upper = np.where(np.isfinite(p.control_upper), p.control_upper, high + span)
    return lower, upper


def _box_gaps(b: Array, R: Array, low: Array, high: Array) -> Array:
    """Return (P,) −min over low ≤ d ≤ high of bᵀd + ½dᵀRd, by coordinate descent from d = 0."""
    nu = b.shape[1]
    diagonal = not np.any(R[:, ~np.eye(nu, dtype=bool)])
    d = np.zeros_like(b)
    for _ in range(1 if diagonal else SWEEPS):
        for i in range(nu):
            slope = b[:, i] + np.einsum("pj,pj->p", R[:, i], d) - R[:, i, i] * d[:, i]
            curved = R[:, i, i] > 0
            free = -slope / np.where(curved, R[:, i, i], 1.0)
            ends = np.where(
                slope * low[:, i] + 0.5 * R[:, i, i] * low[:, i] ** 2
                <= slope * high[:, i] + 0.5 * R[:, i, i] * high[:, i] ** 2,
                low[:, i],
                high[:, i],
            )
            d[:, i] = np.where(curved, np.clip(free, low[:, i], high[:, i]), ends)
    gain: Array = -np.einsum("pi,pi->p", b, d) - 0.5 * np.einsum("pi,pij,pj->p", d, R, d)
    return np.maximum(gain, 0.0) + 0 * gain


def _candidates(U: Array, lower: Array, upper: Array) -> list[Array]:
    """Return controls (P, nu) to try: one at a time over its range, and all corners."""
    tried = []
    for i in range(U.shape[1]):
        for value in np.linspace(lower[i], upper[i], SAMPLES):
            V = U.copy()
            V[:, i] = value
            tried.append(V)
    corners = itertools.product(*zip(lower, upper, strict=True))
    tried += [np.broadcast_to(np.array(corner), U.shape) for corner in corners]
    return tried
