"""The reduced-order road: a path of the translational–yaw model, as a flight of the whole craft.

The model may change its acceleration at once; the craft cannot, since tilting takes torque. So the
path is smoothed first, by least squares with splines whose snap is continuous, and then lifted by
differential flatness.

Legend: B basis of splines (M, n), c their coefficients, p degree, t knots.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.models.flatness import RigidBody, lift
from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]

DEGREE = 7
"""Degree of the splines: snap, the fourth derivative, is smooth."""

PIECE = 0.5
"""Length of a piece, s: about as long as a small craft takes to tilt and stop tilting."""

SAMPLES = 8
"""Samples for each node of the path."""

FLAT = ("x", "y", "z", "psi")


def lifted_path(vehicle: RigidBody, path: Trajectory, piece: float = PIECE) -> Trajectory:
    """Return states (N+1, 12) and wrenches (N+1, 4) that fly a path, at its own times.

    A guess for the full problem, and a first look at it: the path is flown closely, not exactly,
    and bounds are not looked at.

    Parameters
    ----------
    vehicle : mass, inertia, gravity; a ``Vehicle`` will do. Drag is ignored
    path : with states named x, y, z (NED, m) and psi (rad), as of the translational–yaw model
    piece : length of the pieces of the splines, s; longer ones ask for less torque

    Raises
    ------
    UserError
        When those states are missing, or the path asks for free fall or 89 deg of tilt.

    References
    ----------
    C. de Boor, A Practical Guide to Splines, 1978, chapters IX and X. Flatness: ``lift``.

    Checked by tests/models/test_reduced_path.py
    """
    if not set(FLAT) <= set(path.state_names):
        raise UserError(
            "The path does not tell position and yaw.",
            where="path.state_names",
            found=", ".join(path.state_names) or "no names",
            expected="x, y, z and psi among them",
            do="Give the trajectory of a problem with a translational-yaw model.",
        )
    times = path.times
    dense = np.linspace(times[0], times[-1], SAMPLES * len(times))
    columns = [path.state_names.index(name) for name in FLAT]
    t = _knots(times[0], times[-1], piece)
    B: Array = spline_basis(dense, t, DEGREE)
    flat = path.state(dense)[:, columns]
    c: Array = np.asarray(np.linalg.lstsq(B, flat, rcond=None)[0], dtype=np.float64)
    jets = [_derivative(times, t, c, order) for order in range(5)]
    states, controls = lift(
        vehicle, *(jet[:, :3] for jet in jets), *(jet[:, 3] for jet in jets[:3])
    )
    return Trajectory(times, states, controls)


def spline_basis(x: Array, t: Array, p: int) -> Array:
    """Return B, the (M, n) values of all splines of degree p on the knots t, by Cox and de Boor."""
    last = np.flatnonzero(t < t[-1])[-1]  # the last piece holds its right end too
    inside = (t[None, :-1] <= x[:, None]) & (x[:, None] < t[None, 1:])
    inside[x >= t[-1], last] = True
    B = inside.astype(float)
    for q in range(1, p + 1):
        rising = _ratio(x[:, None] - t[: -q - 1], t[q:-1] - t[: -q - 1])
        falling = _ratio(t[q + 1 :] - x[:, None], t[q + 1 :] - t[1:-q])
        B = rising * B[:, :-1] + falling * B[:, 1:]
    return B


def _derivative(x: Array, t: Array, c: Array, order: int) -> Array:
    """Return a derivative of the spline at x; each lowers the degree and drops the end knots."""
    p = DEGREE
    for _ in range(order):
        c = p * np.diff(c, axis=0) / (t[p + 1 : -1] - t[1 : -p - 1])[:, None]
        t, p = t[1:-1], p - 1
    result: Array = spline_basis(x, t, p) @ c
    return result


def _knots(start: float, end: float, piece: float) -> Array:
    """Return knots of equal pieces, the ends repeated."""
    count = max(1, round((end - start) / piece))
    inner = np.linspace(start, end, count + 1)
    return np.concatenate([[start] * DEGREE, inner, [end] * DEGREE])


def _ratio(over: Array, under: Array) -> Array:
    """Return the quotient, 0 where knots coincide."""
    return np.where(under > 0, over / np.where(under > 0, under, 1.0), 0.0)
