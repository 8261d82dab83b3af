"""One random Newton system of a program: posed to the native room, and dense.

Legend: Σ bound weights, D path and rate weights, δ regularisation, K unreduced matrix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space

from kernel.dense_newton import Derivatives, derivatives
from kernel.stage_problems import Case, program_of
from skyknot.kernel import native
from skyknot.kernel.program import Program
from skyknot.kernel.rows import Rows, native_solver, tapes

EQUALITY_WEIGHT = 1e10  # as in the native room
REDUNDANT = 1e-6


@dataclass
class NewtonSystem:
    """Point, weights and right-hand sides, drawn at random; rows as the native room packs them.

    Attributes
    ----------
    sigma : (n,) Σ + δ on the unknowns, D : (rows,) weights, equal : (rows,) equality marks over
    path rows (point-major) and rate rows; pinned : (n,) fixed unknowns; ``unjudged`` those among
    them whose multiplier the native room does not give
    r, d, e : right-hand sides of unknowns, defects and rows
    """

    program: Program
    rows: Rows
    exact: Derivatives
    sigma: np.ndarray
    D: np.ndarray
    equal: np.ndarray
    pinned: np.ndarray
    unjudged: np.ndarray
    r: np.ndarray
    d: np.ndarray
    e: np.ndarray
    native: object
    data: dict
    regularisation: float

    @property
    def J_rows(self) -> np.ndarray:
        return np.vstack([self.exact.J_g, self.exact.J_r])

    @property
    def H(self) -> np.ndarray:
        """Hessian of the barrier problem: W + Σ + δ + Jᵀ D J."""
        J = self.J_rows
        return self.exact.W + np.diag(self.sigma) + J.T @ (self.D[:, None] * J)

    @property
    def constraints(self) -> np.ndarray:
        """Defects, equality rows and pins, one under the other."""
        pins = np.eye(len(self.sigma))[self.pinned]
        return np.vstack([self.exact.J_d, self.J_rows[self.equal], pins])

    @property
    def K(self) -> np.ndarray:
        J = self.constraints
        return np.block([[self.H, J.T], [J, np.zeros((len(J), len(J)))]])

    @property
    def right(self) -> np.ndarray:
        return np.r_[self.r, self.d, self.e[self.equal], np.zeros(self.pinned.sum())]

    def least_curvature(self) -> float:
        """Least eigenvalue of the projected Hessian, inf where nothing is free."""
        Z = null_space(self.constraints, rcond=1e-11)
        return float(np.linalg.eigvalsh(Z.T @ self.H @ Z).min()) if Z.shape[1] else np.inf

    def slowest_refinement(self) -> float:
        """Share of the error in equality multipliers that a refinement leaves, at worst.

        The method of multipliers leaves I − w J (H + w JᵀJ)⁻¹ Jᵀ on the null space of the defects
        (Bertsekas 1982, section 2.2), w the weight of equalities; redundant rows do not count.
        """
        w, n = EQUALITY_WEIGHT, len(self.sigma)
        J = np.vstack([self.J_rows[self.equal], np.eye(n)[self.pinned & ~self.unjudged]])
        Z = null_space(np.vstack([self.exact.J_d, np.eye(n)[self.unjudged]]), rcond=1e-11)
        if not len(J) or not Z.shape[1]:
            return 0.0
        J = J @ Z
        reached = w * J @ np.linalg.solve(Z.T @ self.H @ Z + w * J.T @ J, J.T)
        shares = np.linalg.eigvalsh(0.5 * (reached + reached.T))
        return float(1.0 - np.min(shares[shares > REDUNDANT], initial=1.0))

    def step(self, refinements: int = 10, equality_weight: float = EQUALITY_WEIGHT) -> dict:
        """Return what the native room makes of it."""
        P, ng = len(self.program.point_state), self.program.sizes[3]
        weights, residuals = self._groups(self.D, P, ng), self._groups(self.e, P, ng)
        scale_free = {
            "regularisation": self.regularisation,
            "accuracy": 1e-10,
            "weight_v": self._to_v(self.sigma - self.regularisation),
            "weight_q": (self._globals(self.sigma) - self.regularisation).tolist(),
            "row_weights": weights,
            "row_residuals": residuals,
            "r": self._to_v(self.r),
            "r_q": self._globals(self.r).tolist(),
            "d": self._to_d(self.d),
            "refinements": refinements,
            "equality_weight": equality_weight,
        }
        return native.newton_step(self.native, self.data, scale_free)

    def unpacked(self, step: dict) -> np.ndarray:
        """Return a native step as a vector of the dense system; zero for unjudged multipliers."""
        n = len(self.sigma)
        s = np.zeros(n)
        here = self.rows.positions >= 0
        s[self.rows.positions[here]] = step["v"][here]
        s[self.program.layout.global_positions] = step["q"]
        N, nx = self.rows.N, self.program.layout.nx
        lam = step["lambda"].reshape(-1, nx, N).transpose(2, 0, 1).ravel()
        y = np.zeros((len(self.program.point_state), self.program.sizes[3]))
        for points, table in zip(self.rows.classes, step["equality"][:-1], strict=True):
            y[points] = table.T
        rows = np.r_[y.ravel(), step["equality"][-1].ravel()]
        pins = np.zeros(n)
        pins[self.rows.positions[tuple(self.rows.pins.T)]] = step["pins"]
        return np.r_[s, lam, rows[self.equal], pins[self.pinned]]

    def judged(self, residual: np.ndarray) -> np.ndarray:
        """Return a residual of the dense system without the equations of unjudged multipliers."""
        kept = np.ones(len(residual), dtype=bool)
        kept[: len(self.sigma)] = ~self.unjudged
        return residual[kept]

    def _to_v(self, values: np.ndarray) -> np.ndarray:
        return np.ascontiguousarray(self.rows.to_rows(values))

    def _globals(self, values: np.ndarray) -> np.ndarray:
        return values[self.program.layout.global_positions]

    def _to_d(self, values: np.ndarray) -> np.ndarray:
        N, nx = self.rows.N, self.program.layout.nx
        return np.ascontiguousarray(values.reshape(N, -1, nx).transpose(1, 2, 0).reshape(-1, N))

    def _groups(self, values: np.ndarray, P: int, ng: int) -> list[np.ndarray]:
        path = values[: P * ng].reshape(P, ng)
        groups = [np.ascontiguousarray(path[points].T) for points in self.rows.classes]
        return [*groups, np.ascontiguousarray(values[P * ng :].reshape(-1, self.rows.N))]


def system_of(case: Case) -> NewtonSystem:
    """Return a random Newton system of a case."""
    program = program_of(case)
    random = np.random.default_rng(case.seed + 2)
    z = program.start + 0.2 * random.normal(size=program.layout.size) * program.scales
    if program.duration is None:
        z[program.layout.globals] = 1.4
    multipliers = program.empty_multipliers()
    multipliers.defects[:] = random.normal(size=multipliers.defects.shape)
    bounded = np.isfinite(program.path_lower) | np.isfinite(program.path_upper)
    multipliers.path[bounded] = 0.3 * random.normal(size=bounded.sum())
    rows = Rows(program)
    made = tapes(program, rows.path_scale)
    solver = native_solver(rows.structure(made.patterns), made)
    data = rows.data(z)
    data |= rows.warm(multipliers)
    exact = derivatives(program, rows, z, multipliers)
    n, size = program.layout.size, len(exact.J_g) + len(exact.J_r)
    pinned = program.lower == program.upper
    first = np.zeros(n, dtype=bool)
    first[program.layout.states_at(program.layout.state[0, :1])[0]] = True
    boxed = (np.isfinite(program.lower) | np.isfinite(program.upper)) & ~pinned

    def weights(count):
        return 10.0 ** random.uniform(-case.spread, case.spread, size=count)

    equal = (program.path_lower == program.path_upper).ravel()
    some_rates = rows.rates.lower == rows.rates.upper
    equal = np.r_[equal, some_rates.ravel()]
    active = np.r_[bounded.ravel(), (np.abs(exact.J_r).sum(axis=1) > 0)]
    w = random.normal(size=n)
    w[pinned] = 0.0
    J_rows = np.vstack([exact.J_g, exact.J_r])
    return NewtonSystem(
        program=program,
        rows=rows,
        exact=exact,
        sigma=np.where(boxed, weights(n), 0.0) + case.regularisation,
        D=np.where(active & ~equal, weights(size), 0.0),
        equal=equal,
        pinned=pinned,
        unjudged=pinned & first,
        r=random.normal(size=n),
        d=-exact.J_d @ w,
        e=np.where(equal, -J_rows @ w, 0.0),
        native=solver,
        data=data,
        regularisation=case.regularisation,
    )
