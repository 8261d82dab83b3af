r"""How rotor thrusts make a wrench, and back.

Legend
------
f_i : thrust of rotor i, N, along minus body z. r_i = (x_i, y_i, 0) : its hub, body FRD, m.
s_i : spin, +1 clockwise seen from above, −1 counter-clockwise. κ : torque over thrust, m.
A : (4, n) matrix with [T, τx, τy, τz] = A f. A⁺ : its pseudo-inverse.

Derivation
----------
Body axes are forward, right, down. Rotor i pushes F_i = (0, 0, −f_i), so

    r_i × F_i = (y_i F_z − 0, 0 − x_i F_z, 0) = (−y_i f_i, +x_i f_i, 0):

a rotor on the right (y > 0) rolls the craft left, a rotor in front (x > 0) raises the nose. Seen
from above, clockwise is the positive sense about z down. A rotor turning clockwise is held back by
the air counter-clockwise and hands that torque to the body: τz = −s_i κ f_i. Hence

    A = [[1 ... 1], [−y_1 ... −y_n], [x_1 ... x_n], [−s_1 κ ... −s_n κ]].

Speeding up the counter-clockwise rotors yaws the nose to the right, as PX4's quad-X does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi
import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.models.base import Expression
from skyknot.models.elementary import is_casadi, linear_combination

AXES = ("thrust", "roll", "pitch", "yaw")
"""What the rows of the allocation matrix are called in messages."""

RANK_TOLERANCE = 1e-9
"""Relative singular value below which a direction of the wrench counts as lost."""


@dataclass(frozen=True)
class Allocation:
    """Rotor places, spins and torque coefficient of a craft that commands all four wrench axes.

    Parameters
    ----------
    positions : n pairs of floats
        Rotor hubs (x_i, y_i), body forward and right, m.
    spins : n ints
        +1 clockwise, −1 counter-clockwise, seen from above.
    kappa : float
        Reaction torque per thrust, m, the same for all rotors.

    Raises
    ------
    UserError
        If a spin is not ±1, the counts differ, κ is not positive, or the rank is below four.
    """

    positions: tuple[tuple[float, float], ...]
    spins: tuple[int, ...]
    kappa: float

    def __post_init__(self) -> None:
        _check_entries(self)
        _check_rank(self.matrix)

    @classmethod
    def x(cls, arm: float, kappa: float) -> Allocation:
        """Return an X quadrotor, `arm` (m) from the centre to every hub.

        Rotors in PX4's order: front right and rear left counter-clockwise, front left and rear
        right clockwise.
        """
        lever = arm / np.sqrt(2.0)
        return cls.x_levers(lever, lever, kappa)

    @classmethod
    def x_levers(cls, forward: float, right: float, kappa: float) -> Allocation:
        """Return an X quadrotor with hubs at (±forward, ±right), m; rotor order as `x`."""
        forward, right = float(forward), float(right)
        hubs = ((forward, right), (-forward, -right), (forward, -right), (-forward, right))
        return cls(positions=hubs, spins=(-1, -1, 1, 1), kappa=kappa)

    @classmethod
    def plus(cls, arm: float, kappa: float) -> Allocation:
        """Return a + quadrotor: right and left counter-clockwise, front and rear clockwise."""
        arm = float(arm)
        hubs = ((0.0, arm), (0.0, -arm), (arm, 0.0), (-arm, 0.0))
        return cls(positions=hubs, spins=(-1, -1, 1, 1), kappa=kappa)

    @property
    def rotor_count(self) -> int:
        """Return the number of rotors n."""
        return len(self.positions)

    @property
    def rotor_positions(self) -> NDArray[np.float64]:
        """Return the hubs in body FRD, m, shape (n, 3)."""
        return np.column_stack([np.array(self.positions), np.zeros(self.rotor_count)])

    @cached_property
    def matrix(self) -> NDArray[np.float64]:
        """Return A, shape (4, n)."""
        hubs, spins = np.array(self.positions), np.array(self.spins, dtype=float)
        return np.vstack([np.ones(len(spins)), -hubs[:, 1], hubs[:, 0], -spins * self.kappa])

    @cached_property
    def inverse(self) -> NDArray[np.float64]:
        """Return A⁺, shape (n, 4): the least thrusts, in the Euclidean norm, for a wrench."""
        return np.asarray(np.linalg.pinv(self.matrix), dtype=float)

    def wrench(self, thrusts: Expression) -> Expression:
        """Return [T, τx, τy, τz], shape (..., 4), of rotor thrusts (..., n), N and N m."""
        return _apply(self.matrix, thrusts)

    def wrench_components(self, thrusts: Sequence[Expression]) -> list[Expression]:
        """Return T, τx, τy, τz of n thrust components, components first."""
        components = [thrusts[i] for i in range(self.rotor_count)]
        return [linear_combination(row, components) for row in self.matrix.tolist()]

    def rotor_thrusts(self, wrench: Expression) -> Expression:
        """Return the rotor thrusts, N, shape (..., n), that make wrenches (..., 4).

        Exact for four rotors; the least-norm choice for more. Not clipped: a negative value says
        that the wrench cannot be made.
        """
        return _apply(self.inverse, wrench)


def _apply(matrix: NDArray[np.float64], vector: Expression) -> Expression:
    """Return matrix times vector: CasADi column to column, array (..., k) to (..., l)."""
    rows = matrix.tolist()
    if _holds_casadi(vector):
        components = [vector[i] for i in range(len(rows[0]))]
        return casadi.vertcat(*(linear_combination(row, components) for row in rows))
    return np.asarray(vector) @ matrix.T


def _holds_casadi(vector: Expression) -> bool:
    """Return whether the vector is a CasADi column or a sequence with CasADi entries."""
    if isinstance(vector, np.ndarray):
        return False
    return is_casadi(vector) or any(is_casadi(entry) for entry in vector)


def _check_entries(allocation: Allocation) -> None:
    """Raise a UserError unless counts agree, spins are ±1, and numbers are finite."""
    if not allocation.spins or len(allocation.spins) != len(allocation.positions):
        raise UserError(
            "The rotors have not one spin each.",
            where="spins",
            found=f"{len(allocation.spins)} spins for {len(allocation.positions)} rotors",
            expected="one spin for every rotor position",
            do="Give +1 (clockwise seen from above) or -1 for every rotor.",
        )
    if any(spin not in (-1, 1) for spin in allocation.spins):
        raise UserError(
            "A rotor's spin is neither clockwise nor counter-clockwise.",
            where="spins",
            found=list(allocation.spins),
            expected="+1 (clockwise seen from above) or -1 (counter-clockwise)",
            do="Write 1 or -1 for every rotor.",
        )
    if not (np.isfinite(allocation.kappa) and allocation.kappa > 0.0):
        raise UserError(
            "The reaction torque coefficient is not a positive length.",
            where="kappa",
            found=allocation.kappa,
            expected="torque over thrust in metres, above zero (0.005 to 0.3 m is usual)",
            do="Divide the rotor's torque by its thrust at hover; put the sign into the spins.",
        )
    if not np.all(np.isfinite(np.array(allocation.positions, dtype=float))):
        raise UserError(
            "A rotor position is not a finite number.",
            where="positions",
            found=allocation.positions,
            expected="finite x (forward) and y (right), in metres",
            do="Give the hub of every rotor in body axes.",
        )


def _check_rank(A: NDArray[np.float64]) -> None:
    """Raise a UserError that names the lost axes if the rank of A (4, n) is below four."""
    largest = np.abs(A).max(axis=1)
    if np.any(largest <= 0.0):
        axis = AXES[int(np.argmin(largest))]
        _refuse(f"no rotor makes any {axis} torque (its row is zero)", axis, A)
    scaled = A / largest[:, None]
    left, singular, _ = np.linalg.svd(scaled)
    if len(singular) == 4 and singular[-1] > RANK_TOLERANCE * singular[0]:
        return
    for i in range(4):
        for j in range(i + 1, 4):
            ratio = float(scaled[j] @ scaled[i] / (scaled[i] @ scaled[i]))
            if np.allclose(scaled[j], ratio * scaled[i], atol=RANK_TOLERANCE):
                factor = ratio * largest[j] / largest[i]
                dependence = f"the {AXES[j]} row is {factor:.4g} times the {AXES[i]} row"
                _refuse(dependence, AXES[j], A)
    null = left[:, -1]
    involved = [AXES[i] for i in range(4) if abs(null[i]) > RANK_TOLERANCE]
    _refuse(f"the rows {', '.join(involved)} depend on one another", involved[-1], A)


def _refuse(dependence: str, axis: str, A: NDArray[np.float64]) -> None:
    """Raise the UserError for an allocation that loses a wrench axis."""
    rank = np.linalg.matrix_rank(A)
    raise UserError(
        f"The rotors cannot command {axis} on its own: {dependence}.",
        where="rotor positions and spins",
        found=f"an allocation matrix of rank {rank} for {A.shape[1]} rotors",
        expected="rank 4: thrust, roll, pitch and yaw independently",
        do="Check positions and spins; on an X quadrotor diagonal rotors turn the same way.",
    )
