"""Check of the bounds on du/dt, inside the segments and across the nodes."""

from __future__ import annotations

import numpy as np

from skyknot.verification import polynomials
from skyknot.verification.base import Check, outside, worst_of
from skyknot.verification.ends import magnitudes
from skyknot.verification.evidence import Evidence
from skyknot.verification.tolerances import Limits


def rates(evidence: Evidence, limits: Limits) -> Check | None:
    """Check du/dt at closely spaced places, and jumps at the nodes.

    A jump is judged by the rate that would make it between the middles of its two segments, which
    is how fast a held control is asked to change.
    """
    p = evidence.problem
    if not np.any(np.isfinite(p.rate_lower) | np.isfinite(p.rate_upper)):
        return None
    C, h, t = evidence.control_polynomials, evidence.lengths, evidence.times
    tau = np.linspace(0.0, 1.0, evidence.density + 1)
    slopes = polynomials.evaluated(polynomials.differentiated(C), tau) / h[:, None, None]
    places = t[:-1, None] + h[:, None] * tau
    before = polynomials.evaluated(C[:-1], np.array([1.0]))[:, 0]
    after = polynomials.evaluated(C[1:], np.array([0.0]))[:, 0]
    jumps = (after - before) / (0.5 * (h[:-1] + h[1:]))[:, None]
    values = np.concatenate([slopes.reshape(-1, p.nu), jumps])
    return worst_of(
        "rates",
        "Slope of the control's interpolant, and jumps at the nodes over the time between the"
        " middles of their segments, against the rate bounds.",
        outside(values, p.rate_lower, p.rate_upper),
        limits.feasibility * magnitudes(p.rate_lower, p.rate_upper),
        p.control_names,
        tuple(f"{unit or '1'}/s" for unit in evidence.control_units),
        np.concatenate([places.ravel(), t[1:-1]]),
    )
