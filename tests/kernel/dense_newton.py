"""The unreduced Newton system of a program, dense, from CasADi derivatives; no native code.

Legend: n unknowns, y = (x, u, q) of a point, E (ny, n) map from a step of z to that of y; W Hessian
of the Lagrangian, J_d Jacobian of the defects, J_g of path rows (point-major), J_r of rate rows.

Everything is in the kernel's scaled unknowns z̃ = z / scales, with defects divided by the scale of
their state and rate rows by the scale of their kind.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from skyknot.kernel.program import Multipliers, Program
from skyknot.kernel.rows import Rows


@dataclass(frozen=True)
class Derivatives:
    """Second-order picture of a program at one point, in scaled unknowns.

    Attributes
    ----------
    W : (n, n), J_d : (N (s−1) nx, n), J_g : (P ng, n), J_r : (rate rows N, n)
    """

    W: np.ndarray
    J_d: np.ndarray
    J_g: np.ndarray
    J_r: np.ndarray


def derivatives(program: Program, rows: Rows, z: np.ndarray, m: Multipliers) -> Derivatives:
    """Return Hessian and Jacobians at z with multipliers m (unscaled, as the program has them)."""
    layout, S = program.layout, program.scales
    nx, nu, nq, ng = program.sizes
    n, P, N = layout.size, len(program.point_state), program.segments
    nu_point = np.zeros((P, nx))
    np.add.at(
        nu_point,
        program.segment_points,
        np.einsum("k,ij,kix->kjx", program.fractions, program.A, m.defects),
    )
    second = _second_order(program)
    W, J_g, J_F = np.zeros((n, n)), np.zeros((P, ng, n)), np.zeros((P, nx, n))
    x, u, q = program.point_states(z), program.point_controls(z), program.globals_of(z)
    for j in range(P):
        E = np.zeros((nx + nu + nq, n))
        E[np.arange(nx), layout.states_at(program.point_state[j])] = 1.0
        for value, weight in zip(program.point_control[j], program.point_weights[j], strict=True):
            E[nx + np.arange(nu), layout.controls_at(value)] += weight
        E[nx + nu + np.arange(nq), layout.global_positions] = 1.0
        H, JF, Jg = second(
            x[j], u[j], q, program.point_time[j], program.point_cost[j], nu_point[j], m.path[j]
        )
        W += E.T @ np.asarray(H) @ E
        J_F[j], J_g[j] = np.asarray(JF) @ E, np.asarray(Jg).reshape(ng, len(E)) @ E
    end = np.r_[layout.states_at(layout.state[-1, -1:])[0], layout.global_positions]
    W[np.ix_(end, end)] += np.asarray(_terminal_hessian(program)(z[end[:nx]], q))
    J_d = np.zeros((N, len(program.C), nx, n))
    identity = np.eye(n)
    for k in range(N):
        X = identity[layout.states_at(layout.state[k])]
        J_d[k] = np.einsum("ij,jxn->ixn", program.C, X) + program.fractions[k] * np.einsum(
            "ij,jxn->ixn", program.A, J_F[program.segment_points[k]]
        )
    J_d /= S[layout.states_at(layout.state[0, :1])[0]][:, None]
    scaled = [(J.reshape(-1, n)) * S for J in (J_d, J_g)]
    return Derivatives(S[:, None] * W * S, *scaled, _rate_jacobian(program, rows) * S)


def _second_order(program: Program) -> ca.Function:
    point = program.point
    x, u, q, tau = (ca.SX.sym(f"a{i}", *point.size_in(i)) for i in range(4))
    L, F, g = point(x, u, q, tau)
    c, nu, mu = ca.SX.sym("c"), ca.SX.sym("nu", F.shape[0]), ca.SX.sym("mu", g.shape[0])
    y = ca.vertcat(x, u, q)
    lagrangian = c * L + ca.dot(nu, F) + (ca.dot(mu, g) if g.shape[0] else 0)
    outputs = [ca.hessian(lagrangian, y)[0], ca.jacobian(F, y), ca.jacobian(g, y)]
    return ca.Function("second", [x, u, q, tau, c, nu, mu], [ca.densify(e) for e in outputs])


def _terminal_hessian(program: Program) -> ca.Function:
    x, q = (ca.SX.sym(f"a{i}", *program.terminal.size_in(i)) for i in range(2))
    hessian = ca.hessian(program.terminal(x, q), ca.vertcat(x, q))[0]
    return ca.Function("terminal_hessian", [x, q], [ca.densify(hessian)])


def _rate_jacobian(program: Program, rows: Rows) -> np.ndarray:
    """(kinds · N, n): zero rows where a held control has no rate (the first segment)."""
    rates, N = program.rates, program.segments
    J = np.zeros((len(rows.rates.rows), N, program.layout.size))
    for r, (kind, _, side) in enumerate(rows.rates.rows):
        for k in range(N):
            i = rows.rates.index[kind, k]
            if i < 0:
                continue
            J[r, k, rates.positions[i]] += rates.weights[i]
            if program.duration is None:
                bound = getattr(rates, side)[i]
                J[r, k, program.layout.globals] -= rates.length[i] * (
                    bound if np.isfinite(bound) else 0.0
                )
        J[r] /= rows.rates.scale[r]
    return J.reshape(-1, program.layout.size)
