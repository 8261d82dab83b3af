"""Ready-made costs. Any pair of callables does as well."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from skyknot.errors import UserError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class QuadraticTracking:
    """The tracking cost of equation (10) of the source report, in continuous time.

    J = ∫ (x − x_f)ᵀ Q (x − x_f) + (u − u_r)ᵀ R (u − u_r) dt + (x(t_f) − x_f)ᵀ Q_f (x(t_f) − x_f)

    The transcription decides how the integral is taken: by the scheme's own quadrature, or as
    the report's plain sum over the nodes (``objective="sum"``).

    Parameters
    ----------
    target : (nx,) x_f, in state units
    Q, R, Q_final : diagonals (n,) or symmetric matrices (n, n)
    control_reference : (nu,) u_r, in control units; zero when None
    """

    target: ArrayLike
    Q: ArrayLike
    R: ArrayLike
    Q_final: ArrayLike | None = None
    control_reference: ArrayLike | None = None

    def running_cost(self, x: Any, u: Any) -> Any:
        """Return the integrand at one time."""
        nu = np.asarray(self.R).shape[0]
        reference = np.zeros(nu) if self.control_reference is None else self.control_reference
        return _quadratic(x, self.target, self.Q, "Q") + _quadratic(u, reference, self.R, "R")

    def terminal_cost(self, x: Any, _tf: Any = None) -> Any:
        """Return the end term; zero without ``Q_final``."""
        return 0.0 if self.Q_final is None else _quadratic(x, self.target, self.Q_final, "Q_final")

    def callables(self) -> dict[str, Callable[..., Any]]:
        """Return the keyword arguments ``running_cost`` and ``terminal_cost`` of a Problem."""
        return {"running_cost": self.running_cost, "terminal_cost": self.terminal_cost}


def _quadratic(values: Any, reference: ArrayLike, weight: ArrayLike, name: str) -> Any:
    W, r = np.asarray(weight, dtype=float), np.asarray(reference, dtype=float)
    if W.ndim == 1:
        W = np.diag(W)
    if W.shape != (len(r), len(r)) or not np.allclose(W, W.T):
        raise UserError(
            f"The weight {name} does not fit its vector.",
            where=name,
            found=f"shape {W.shape}",
            expected=f"{len(r)} numbers or a symmetric {len(r)} × {len(r)} matrix",
            do="Give one weight for each entry.",
        )
    errors = [values[i] - r[i] for i in range(len(r))]
    return _form(errors, W)


def _form(errors: Sequence[Any], W: Array) -> Any:
    total: Any = 0.0
    for i, j in zip(*np.nonzero(np.tril(W)), strict=True):
        total = total + (W[i, i] if i == j else 2 * W[i, j]) * errors[i] * errors[j]
    return total
