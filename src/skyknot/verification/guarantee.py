"""Check with a proof: path constraints and state bounds between the nodes.

Legend: N segments of length h, nx states; E (N, nx) integral of |dx/dt − f| over a segment, J the
Jacobian ∂f/∂x.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.verification.base import Check, worst_of
from skyknot.verification.drift import Drift
from skyknot.verification.enclosures import Margin, Path
from skyknot.verification.ends import bounds_of
from skyknot.verification.evidence import Evidence
from skyknot.verification.room import allowances
from skyknot.verification.tolerances import Limits

Array = NDArray[np.float64]

CLOSENESS = 0.1
"""Share of what is allowed by which a proof may fall short of the values it is about."""

TERMS = 8
"""Terms of the exponential series that carries an error through a segment."""


def guarantee(evidence: Evidence, limits: Limits) -> Check | None:
    """Prove how far path constraints on states can be passed anywhere between the nodes."""
    entries = evidence.problem.path
    on_states = [i for i in range(len(entries)) if not evidence.equations.path_uses_controls[i]]
    lower, upper = bounds_of(entries)
    units = tuple(entry.unit for entry in entries)
    allowed = allowances(evidence.samples.path, lower, upper, units, limits)
    path = Path(evidence.state_polynomials, evidence.times)
    drift, drifting = drift_of(evidence) if on_states else (np.zeros(0), "")
    columns, taken, open_ = [], [], []
    for i in on_states:
        try:
            columns.append(_excess(evidence, path, drift, i, float(allowed[i])))
            taken.append(i)
        except NotImplementedError as reason:
            open_.append(f"{entries[i].name} ({reason})")
    if not taken:
        return None
    left = f"; without a proof for want of interval arithmetic: {', '.join(open_)}" if open_ else ""
    return worst_of(
        "path guaranteed",
        "Largest excess of path constraints on states that the proof cannot exclude anywhere in a"
        " segment: proved by interval arithmetic for the polynomial of the answer, plus what a"
        f" flight from the segment's first node can add to it, {drifting}{left}.",
        np.stack(columns, axis=1),
        (1 + CLOSENESS) * allowed[taken],
        tuple(entries[i].name for i in taken),
        tuple(units[i] for i in taken),
        evidence.times[:-1],
    )


def _excess(evidence: Evidence, path: Path, drift: Array, index: int, allowed: float) -> Array:
    """Return (N,) the proved excess over one constraint, drift included."""
    entry, worst = evidence.problem.path[index], np.zeros(len(path.h))
    for bound, sign in ((entry.lower, 1.0), (entry.upper, -1.0)):
        if bound is None:
            continue
        margin = Margin(evidence.equations, index, bound, sign)
        proved = margin.least(path, enough=allowed, slack=0.5 * CLOSENESS * allowed)
        added = np.sum(margin.steepest(path, drift) * drift, axis=1)
        close = proved < allowed + np.where(np.isfinite(added), added, np.inf)
        excess = np.where(close, added - proved, 0.0)
        worst = np.fmax(worst, np.where(np.isnan(excess), np.inf, excess))
    return worst


def drift_of(evidence: Evidence) -> tuple[Array, str]:
    """Return (N, nx) how far a flight can leave the polynomial, and whether that is proved."""
    try:
        proved = Drift(
            evidence.equations,
            evidence.state_polynomials,
            evidence.control_polynomials,
            evidence.times,
            evidence.state_sizes,
        ).bound()
    except NotImplementedError as reason:
        return carried(evidence), f"sampled only ({reason} has no interval form)"
    known = np.isfinite(proved)
    if np.all(known):
        return proved, "proved too"
    segments = int(np.sum(~np.all(known, axis=1)))
    return np.where(known, proved, carried(evidence)), f"sampled only in {segments} segments"


def carried(evidence: Evidence) -> Array:
    """Return (N, nx) an estimate of how far the flight can leave the polynomial within a segment.

    For where no proof is to be had: the integral E of the sampled residual, carried on by the
    Jacobian J in the middle of the segment, e ≤ exp(|J| h) E, entry by entry.
    """
    samples, h = evidence.samples, evidence.lengths
    D, nx = evidence.density, evidence.problem.nx
    residual = np.abs(samples.state_rates - samples.rates).reshape(-1, D, nx)
    E = h[:, None] * np.mean(residual, axis=1)
    middle = slice(D // 2, None, D)
    J = evidence.equations.state_jacobians(
        samples.states[middle], samples.controls[middle], samples.times[middle]
    )
    growth: Array = E.copy()
    term = E
    for order in range(1, TERMS + 1):
        term = h[:, None] / order * np.einsum("kij,kj->ki", np.abs(J), term)
        growth = growth + term
    return growth
