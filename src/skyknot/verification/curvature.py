"""Check of second order: the program curves upwards in every direction that it may move.

Legend: as in critical_cone.py; V_k(σ) = ½ σᵀ P σ the least second-order change from stage k on,
G σ = 0 the rows that the stages from k on leave to σ; R the Hessian of the controls that the rows
leave free.

The recursion is dynamic programming with rows to carry, backwards (Laine & Tomlin, 2019): the
Hessian is positive definite on the null space of the constraints if and only if R is at every
stage, and what remains at the first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.verification.base import Check
from skyknot.verification.critical_cone import CriticalCone, Stage
from skyknot.verification.evidence import Evidence
from skyknot.verification.tolerances import Limits

Array = NDArray[np.float64]

RANK = 1e-7
"""Singular value, relative to rows of length one, below which a row does not bind a control."""


@dataclass(frozen=True)
class Curvature:
    """What the recursion found.

    Attributes
    ----------
    least : (N+1,) least eigenvalue of R at every stage, the start last; inf where nothing is free
    largest : (N+1,) largest absolute eigenvalue
    """

    least: Array
    largest: Array


def second_order(evidence: Evidence, limits: Limits) -> Check | None:
    """Check that the Lagrangian does not curve downwards along the constraints.

    Not judged where the cost does not curve in a control: bang-bang and singular controls are
    strict optima for other reasons, or none.
    """
    if evidence.program is None or evidence.adjoint is None or evidence.adjoint.flat_controls:
        return None
    try:
        found = measured(CriticalCone(evidence.program, evidence.state_sizes))
    except np.linalg.LinAlgError:  # numbers that are not finite, or steps that do not exist
        found = Curvature(np.array([np.nan]), np.array([1.0]))
    scale = float(np.max(found.largest, initial=0.0)) or 1.0
    k = int(np.argmin(found.least))
    relative = float(found.least[k] / scale)
    value = np.inf if np.isnan(relative) else max(0.0, -relative)
    strict = relative > 0
    when = "the start" if k >= len(found.least) - 1 else f"{evidence.times[k]:.4g} s"
    return Check(
        name="second order",
        value=value,
        limit=limits.curvature,
        unit="",
        passed=value <= limits.curvature,
        how="Least eigenvalue, relative to the largest, of the Lagrangian's Hessian on directions"
        " that keep defects and strongly active constraints, by dynamic programming; zero proves a"
        " strict local minimum of the finite program when the least curvature told is positive, and"
        " weakly active constraints are left out, which asks for more than is needed.",
        worst=f"least curvature {relative:.2g} at {when}" + ("" if strict else ", not strict"),
    )


def measured(cone: CriticalCone) -> Curvature:
    """Return the least and largest curvature at every stage."""
    N, n = len(cone.stages), cone.n_stage
    least, largest = np.full(N + 1, np.inf), np.zeros(N + 1)
    P, G = np.zeros((n, n)), np.zeros((0, n))
    with np.errstate(all="ignore"):
        for k in reversed(range(N)):
            if not np.all(np.isfinite(cone.stages[k].H)):
                least[k] = np.nan
                return Curvature(least, largest)
            R, P, G = _step(cone.stages[k], P, G)
            least[k], largest[k] = _extremes(R)
    free = _null_space(G)
    least[N], largest[N] = _extremes(free.T @ P @ free)
    return Curvature(least, largest)


def _step(stage: Stage, P: Array, G: Array) -> tuple[Array, Array, Array]:
    """Return R of the free controls, and P and G one stage earlier."""
    n = len(P)
    Q = stage.H + stage.N.T @ P @ stage.N
    D = np.concatenate([_scaled(G @ stage.N), stage.D])
    U, S, V = np.linalg.svd(D[:, n:], full_matrices=True)
    rank = int(np.sum(S > RANK))
    K = -(V[:rank].T / S[:rank]) @ (U[:, :rank].T @ D[:, :n])
    free = V[rank:].T
    R = free.T @ Q[n:, n:] @ free
    coupling = free.T @ (Q[n:, :n] + Q[n:, n:] @ K)
    bound = Q[:n, :n] + Q[:n, n:] @ K + K.T @ Q[n:, :n] + K.T @ Q[n:, n:] @ K
    values, vectors = np.linalg.eigh(0.5 * (R + R.T))
    floor = RANK**2 * max(float(np.max(np.abs(values), initial=0.0)), 1e-300)
    curved = np.abs(values) > floor
    W = vectors[:, curved].T @ coupling
    earlier = bound - W.T @ (W / values[curved, None])
    return R, 0.5 * (earlier + earlier.T), _row_space(U[:, rank:].T @ D[:, :n])


def _extremes(R: Array) -> tuple[float, float]:
    """Return least and largest absolute eigenvalue of R; inf and 0 of an empty one."""
    if R.size == 0:
        return np.inf, 0.0
    if not np.all(np.isfinite(R)):
        return np.nan, 0.0
    values = np.linalg.eigvalsh(0.5 * (R + R.T))
    return float(values[0]), float(np.max(np.abs(values)))


def _scaled(rows: Array) -> Array:
    result: Array = rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-300)
    return result


def _row_space(rows: Array) -> Array:
    """Return orthonormal rows that span the same space."""
    _, S, V = np.linalg.svd(rows, full_matrices=False)
    return np.asarray(V[: int(np.sum(S > RANK))])


def _null_space(rows: Array) -> Array:
    """Return (n, d) orthonormal columns on which rows (r, n), orthonormal, vanish."""
    _, S, V = np.linalg.svd(rows, full_matrices=True)
    return np.asarray(V[int(np.sum(S > RANK)) :].T)
