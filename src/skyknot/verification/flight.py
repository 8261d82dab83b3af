"""Open-loop flight: the controls flown, against the states promised.

Legend: x̂ flown states, N segments; e_RMS of equation (26) of the source report.
"""

from __future__ import annotations

import numpy as np

from skyknot.verification.base import Check, worst_of
from skyknot.verification.evidence import Evidence
from skyknot.verification.tolerances import Limits


def flight(evidence: Evidence, limits: Limits) -> Check:
    """Check e_RMS = √(1/N Σ ‖x_k − x̂_k‖²), equation (26) of the source report."""
    apart = np.sum((evidence.trajectory.states - evidence.flown) ** 2, axis=1)
    value = float(np.sqrt(np.sum(apart) / (len(apart) - 1)))
    apart = np.where(np.isfinite(apart), apart, np.inf)
    k = int(np.argmax(apart))
    gaps = np.abs(evidence.trajectory.states[k] - evidence.flown[k])
    name = evidence.problem.state_names[int(np.argmax(np.where(np.isfinite(gaps), gaps, np.inf)))]
    return Check(
        name="open-loop flight",
        value=value,
        limit=limits.flight_rms,
        unit="",
        passed=bool(value <= limits.flight_rms),
        how="Controls flown from the first state by DOP853, restarted at every node; root mean"
        " square distance from the states at the nodes, equation (26), all states in SI units.",
        worst=f"{name} at {evidence.times[k]:.4g} s",
    )


def arrival(evidence: Evidence, limits: Limits) -> Check:
    """Check where the open-loop flight ends, state by state."""
    return worst_of(
        "arrival",
        "Difference at the end between the open-loop flight and the trajectory, state by state.",
        np.abs(evidence.flown[-1:] - evidence.trajectory.states[-1:]),
        limits.arrival * evidence.state_sizes,
        evidence.problem.state_names,
        evidence.state_units,
        evidence.times[-1:],
    )


def feedback(evidence: Evidence, limits: Limits) -> Check | None:
    """Check where the flight with the solution's own feedback ends, from the exact start."""
    if evidence.tracked is None:
        return None
    return _tracked(
        evidence,
        "closed-loop flight",
        "Flown from the first state by DOP853 with the solution's own gains, clipped to the control"
        " bounds, the gains held over the last 3 % of the horizon; miss of the end, state by state",
        slice(0, 1),
        limits.closed_loop,
    )


def perturbed(evidence: Evidence, limits: Limits) -> Check | None:
    """Check where flights with feedback end that start off by half a per cent, seeded."""
    if evidence.tracked is None:
        return None
    return _tracked(
        evidence,
        "closed-loop, perturbed",
        "As the closed-loop flight, from four seeded starts with every state off by 0.5 % of the"
        " range it passes through; worst miss of the end",
        slice(1, None),
        limits.perturbed,
    )


def _tracked(evidence: Evidence, name: str, how: str, which: slice, share: float) -> Check:
    assert evidence.tracked is not None
    apart = np.abs(evidence.tracked[which] - evidence.trajectory.states)
    shares = np.where(np.isfinite(apart), apart / evidence.state_sizes, np.inf)
    _, k, i = np.unravel_index(int(np.argmax(shares)), shares.shape)
    worst, unit = evidence.problem.state_names[i], evidence.state_units[i]
    along = f"{worst} {np.max(apart[:, k, i]):.2g} {unit}".rstrip()
    return worst_of(
        name,
        f"{how} (on the way at most {along} at {evidence.times[k]:.4g} s).",
        apart[:, -1],
        share * evidence.state_sizes,
        evidence.problem.state_names,
        evidence.state_units,
        np.repeat(evidence.times[-1:], len(apart)),
    )
