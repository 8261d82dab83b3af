"""Back from the decision vector to a trajectory and its costates.

Legend: as in kernel/program.py; p(t) costate with H = ℓ + pᵀf.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.evaluation import Evaluation, evaluate, objective, residuals
from skyknot.kernel.program import Multipliers, Program
from skyknot.trajectory import SegmentData, Trajectory, lagrange_basis

Array = NDArray[np.float64]


def trajectory(program: Program, points: Array, z: Array, values: Evaluation) -> Trajectory:
    """Return the trajectory of z, with the interpolant of its own scheme.

    Parameters
    ----------
    points : (s,) state points of the scheme
    values : evaluation of the program at z
    """
    T = program.duration_of(z)
    X, U = z[program.incidence.states], z[program.incidence.controls]
    rated = np.any(program.A != 0, axis=0)  # path constraints may be seen at more points
    return Trajectory(
        times=T * np.concatenate([[0.0], np.cumsum(program.fractions)]),
        states=np.concatenate([X[:, 0], X[-1:, -1]]),
        controls=_node_controls(program, U),
        segments=SegmentData(
            rate_points=points[program.used[rated]],
            rates=values.F[program.segment_points[:, rated]] / T,
            control_points=program.control_points,
            control_values=U,
            interior_points=points[1:-1],
            interior_states=X[:, 1:-1],
        ),
        state_names=program.state_names,
        control_names=program.control_names,
    )


def _node_controls(program: Program, U: Array) -> Array:
    """Return (N+1, nu): the value after each node, or before it where only that is the scheme's.

    Where no control value stands at the first node it is extrapolated, within its bounds.
    """
    if program.control_points[0] == 0:
        return np.concatenate([U[:, 0], U[-1:, -1]])
    first = lagrange_basis(program.control_points, np.zeros(1)) @ U[0]
    here = program.layout.controls_at(program.layout.control[0, :1])
    return np.concatenate([np.clip(first, program.lower[here], program.upper[here]), U[:, -1]])


def costates(program: Program, values: Evaluation, multipliers: Multipliers) -> Array:
    """Return (N+1, nx) node costates by the transformed adjoint.

    p_k = ∂/∂x_k [J_k + λ_kᵀ d_k] with the terms of segment k alone; at the last node the terms of
    the last segment with the opposite sign. Order 4 with Hermite–Simpson.

    References
    ----------
    W. W. Hager, Numerische Mathematik 87 (2000) 247–282.
    """
    first = _segment_partial(program, values, multipliers, 0)
    last = -_segment_partial(program, values, multipliers, program.C.shape[1] - 1)
    return np.concatenate([first, last[-1:]])


def _segment_partial(
    program: Program, values: Evaluation, multipliers: Multipliers, point: int
) -> Array:
    """Return (N, nx): ∂/∂x of J_k + λ_kᵀ d_k at one state point of each segment."""
    nx = program.layout.nx
    partial: Array = np.einsum("i,kix->kx", program.C[:, point], multipliers.defects)
    column = np.flatnonzero(program.used == point)
    if len(column) == 0:
        return partial
    j = int(column[0])
    rows = program.segment_points[:, j]
    weighted = program.fractions[:, None] * np.einsum(
        "i,kix->kx", program.A[:, j], multipliers.defects
    )
    partial = partial + np.einsum("kx,kxy->ky", weighted, values.JF[rows][:, :, :nx])
    return partial + program.segment_cost[:, j, None] * values.JL[rows][:, :nx]


def feedback_gains(program: Program, gains: Array | None) -> Array | None:
    """Return the solver's gains where they tell K(t), else None.

    They stand at the nodes, those of polynomials that may jump there as well; only a held control
    holds its gain. One long segment has none to tell of in between. And where segments share the
    control of a node that only the one behind collocates (Radau with a linear control), what lies
    ahead of the node does not see its control as the optimum does.
    """
    if gains is None or (program.segments == 1 and program.C.shape[1] > 3):
        return None
    first, last = (
        np.any(program.A[:, program.used == j] != 0) for j in (0, program.C.shape[1] - 1)
    )
    if program.shared and last and not first:
        return None
    if len(gains) > program.segments or len(program.control_points) == 1:
        return gains
    before = max(program.segments - 2, 0)
    ahead = program.fractions[-1] / program.fractions[before]
    return np.concatenate([gains, gains[-1:] + ahead * (gains[-1:] - gains[before, None])])


@dataclass(frozen=True)
class Recovered:
    """What z means, in the user's units.

    Attributes
    ----------
    trajectory : with the scheme's own interpolant
    objective : value of the objective
    globals : values of the free duration and parameters, by name
    """

    trajectory: Trajectory
    objective: float
    globals: dict[str, float]


def recover(program: Program, points: Array, z: Array) -> Recovered:
    """Return what z means.

    Parameters
    ----------
    points : (s,) state points of the scheme
    """
    values, q = evaluate(program, z), program.globals_of(z)
    return Recovered(
        trajectory=trajectory(program, points, z, values),
        objective=objective(program, values),
        globals={name: float(q[i]) for i, name in enumerate(program.global_names)},
    )


@dataclass(frozen=True)
class Optimality:
    """What the multipliers of z tell, in the user's units.

    Attributes
    ----------
    costates : (N+1, nx), see ``costates``
    kkt_residual : largest of stationarity, feasibility, complementarity, unscaled
    max_defect : largest entry of the defects, state units
    """

    costates: Array
    kkt_residual: float
    max_defect: float


def optimality(program: Program, z: Array, multipliers: Multipliers) -> Optimality:
    """Return what the multipliers of z tell."""
    values = evaluate(program, z)
    left = residuals(program, z, multipliers, values)
    return Optimality(
        costates=costates(program, values, multipliers),
        kkt_residual=left.largest,
        max_defect=left.defect,
    )


def same_unknowns(
    program: Program, nodes: Array, decision: Array, arrays: dict[str, Array]
) -> bool:
    """Return whether a stored decision vector means the same here: same layout, same mesh.

    Parameters
    ----------
    nodes : (N+1,) fractions of the horizon it was solved on
    decision, arrays : decision vector and multipliers as stored
    """
    rows = program.empty_multipliers().defects.shape
    if decision.shape != program.start.shape or arrays["defects"].shape != rows:
        return False
    mesh = np.concatenate([[0.0], np.cumsum(program.fractions)])
    return bool(np.allclose(nodes, mesh, rtol=0, atol=1e-9))


def multipliers_from(program: Program, arrays: dict[str, Array]) -> Multipliers | None:
    """Return stored multipliers when they fit the program, else None."""
    empty = program.empty_multipliers()
    fits = all(arrays[name].shape == getattr(empty, name).shape for name in arrays)
    return Multipliers(**arrays) if fits else None
