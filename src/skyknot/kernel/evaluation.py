"""Values and first derivatives of a program at z, for residuals and recovered costates.

Legend: as in program.py; J marks Jacobians with respect to y = (x, u, q). The functions are run on
the tape, over lanes of points: nothing of it holds the interpreter while other threads solve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.incidence import Chosen, Part, joined, summed
from skyknot.kernel.program import ALL, Multipliers, Program

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Evaluation:
    """First-order values at every evaluated point and at the end.

    Attributes
    ----------
    L : (P,), F : (P, nx), g : (P, ng)
    JL : (P, ny), JF : (P, nx, ny), Jg : (P, ng, ny) with y = (x, u, q)
    M : terminal cost, JM : (nx + nq,)
    """

    L: Array
    F: Array
    g: Array
    JL: Array
    JF: Array
    Jg: Array
    M: float
    JM: Array


def evaluate(program: Program, z: Array, points: Chosen = ALL) -> Evaluation:
    """Return values and first derivatives of the program at z.

    Parameters
    ----------
    points : which of the evaluated points are asked for, in order; all of them unless told
    """
    nx, nu, nq, ng = program.sizes
    ny, q, p = nx + nu + nq, program.globals_of(z), program.parameters
    x, u = program.point_states(z, points), program.point_controls(z, points)
    P, tau = len(x), program.point_time[points]
    L, F, g, JL, JF, Jg = program.slopes.point.evaluate(
        [x, u, _repeated(q, P), tau[:, None], _repeated(p, P)]
    )
    x_end = z[program.incidence.last]
    M, JM = program.slopes.terminal.evaluate([x_end[None], q[None], p[None]])
    return Evaluation(
        L=L[:, 0],
        F=F,
        g=g,
        JL=JL,
        JF=JF.reshape(P, ny, nx).transpose(0, 2, 1),
        Jg=Jg.reshape(P, ny, ng).transpose(0, 2, 1),
        M=float(M[0, 0]),
        JM=JM[0],
    )


def _repeated(values: Array, count: int) -> Array:
    """Return (count, n) copies of values (n,)."""
    result = np.empty((count, len(values)))
    result[:] = values
    return result


def objective(program: Program, values: Evaluation) -> float:
    """Return the objective from values already evaluated."""
    return float(program.point_cost @ values.L) + values.M


def defects(program: Program, z: Array, values: Evaluation) -> Array:
    """Return the (N, s−1, nx) defects: predicted minus actual."""
    X = z[program.incidence.states]
    F = values.F[program.segment_points]
    result: Array = np.einsum("ij,kjx->kix", program.C, X) + program.fractions[
        :, None, None
    ] * np.einsum("ij,kjx->kix", program.A, F)
    return result


def rate_values(program: Program, z: Array) -> tuple[Array, Array, Array]:
    """Return the rate rows and their bounds, (R,) each, control unit."""
    rows = program.rates
    span = rows.length * program.duration_of(z)
    values = np.einsum("rw,rw->r", rows.weights, z[rows.positions])
    return values, rows.lower * span, rows.upper * span


# A NaN of the model is a result with a status, told by the solver; it needs no warning here.
@np.errstate(invalid="ignore", over="ignore")
def gradient(
    program: Program,
    values: Evaluation,
    multipliers: Multipliers,
    with_defects: bool = True,
    part: Part | None = None,
) -> Array:
    """Return the gradient of the Lagrangian; bounds' multipliers included.

    Parameters
    ----------
    values : at the points of the part
    part : what the gradient is asked for with respect to, (size,) all of z unless told
    """
    part = program.incidence.whole if part is None else part
    nx, nu, _, _ = program.sizes
    m, defects = multipliers, multipliers.defects[part.segments]
    per_point = program.point_cost[part.points, None] * values.JL
    per_point += (m.path[part.points, None, :] @ values.Jg)[:, 0]
    states = np.zeros((len(defects), program.C.shape[1], nx))
    if with_defects:
        per_point += (_rate_multipliers(part, defects, len(per_point))[:, None] @ values.JF)[:, 0]
        states = np.einsum("ij,kix->kjx", program.C, defects)
    controls = program.point_weights[part.points, :, None] * per_point[:, None, nx : nx + nu]
    rates = m.rates[part.rows, None] * program.rates.weights[part.rows]
    slopes = joined(m.bounds[part.entries], states, per_point[:, :nx], controls, rates)
    total = summed(part.places, slopes, part.size)
    # the last place may be that of several entries nobody asks for: it keeps one of them
    total[part.globals] += per_point[:, nx + nu :].sum(axis=0)
    total[part.last] += values.JM[:nx]
    total[part.globals] += values.JM[nx:]
    if program.duration is None:
        total[part.globals[0]] -= _rate_slope(program, m.rates)
    return total


def complete_fixed(program: Program, z: Array, multipliers: Multipliers) -> None:
    """Set the bound multipliers of fixed unknowns, in place, from stationarity.

    Only the points that read a fixed unknown are evaluated: mostly the two ends.
    """
    fixed = program.lower == program.upper
    if not fixed.any():
        return
    part = program.incidence.reading(fixed)
    multipliers.bounds[part.entries] = 0.0
    missing = gradient(program, evaluate(program, z, part.points), multipliers, part=part)
    multipliers.bounds[part.entries] = -missing[:-1]


def _rate_multipliers(part: Part, defects: Array, points: int) -> Array:
    """Return (points, nx): the multipliers of F at the points of a part."""
    by_row = np.ascontiguousarray(defects.swapaxes(0, 1))
    weighted = (part.shares * by_row[:, :, None, :]).sum(axis=0)
    nx = defects.shape[2]
    return summed(part.rates_read, weighted.ravel(), (points + 1) * nx).reshape(-1, nx)[:-1]


def _rate_slope(program: Program, rho: Array) -> float:
    """Return what the rate rows' bounds take from the gradient with respect to the duration."""
    rows = program.rates
    active = np.where(rho > 0, rows.upper, rows.lower)
    bound = np.where(rho == 0, 0.0, active)
    return float(np.sum(rho * bound * rows.length))


@dataclass(frozen=True)
class Residuals:
    """KKT residuals, unscaled, in the user's units; ``defect`` is the largest defect of them."""

    stationarity: float
    feasibility: float
    complementarity: float
    defect: float

    @property
    def largest(self) -> float:
        """The KKT residual."""
        return max(self.stationarity, self.feasibility, self.complementarity)


@np.errstate(invalid="ignore", over="ignore")
def residuals(
    program: Program, z: Array, multipliers: Multipliers, values: Evaluation
) -> Residuals:
    """Return the KKT residuals of (z, multipliers)."""
    boxes = [
        (z, program.lower, program.upper, multipliers.bounds),
        (values.g, program.path_lower, program.path_upper, multipliers.path),
    ]
    if len(multipliers.rates):
        boxes.append((*rate_values(program, z), multipliers.rates))
    boxes = [box for box in boxes if box[0].size]
    defect = _largest(defects(program, z, values))
    return Residuals(
        stationarity=_largest(gradient(program, values, multipliers)),
        feasibility=max(
            defect,
            *(_largest(np.maximum(np.maximum(low - v, v - high), 0)) for v, low, high, _ in boxes),
        ),
        complementarity=max(_complementarity(*box) for box in boxes),
        defect=defect,
    )


def _complementarity(value: Array, lower: Array, upper: Array, multiplier: Array) -> float:
    bound = np.where(multiplier > 0, upper, lower)
    active = multiplier != 0
    return _largest(multiplier[active] * (bound - value)[active])


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values))) if values.size else 0.0
