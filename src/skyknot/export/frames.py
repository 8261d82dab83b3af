"""North-east-down and forward-right-down to east-north-up and forward-left-up, all in one file.

Legend
------
n, e, d : world axes north, east, down (NED). f, r, d : body axes forward, right, down (FRD).
q = [w x y z] : unit quaternion, w first, of the rotation that takes body components to world
    components. ⊗ : Hamilton product.
P : NED → ENU, (n, e, d) ↦ (e, n, −d); half a turn about (1, 1, 0)/√2, its own inverse.
D : FRD → FLU, (f, r, d) ↦ (f, −r, −d); half a turn about the forward axis, its own inverse.

R_enu←flu = P R_ned←frd D, hence q_enu←flu = q_P ⊗ q_ned←frd ⊗ q_D. Body rates and body
accelerations are body vectors and go through D, positions, velocities and accelerations are world
vectors and go through P. Axes: ROS REP 103 (ENU, FLU) and the MAVLink frames LOCAL_NED, BODY_FRD.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HALF = float(np.sqrt(0.5))
Q_P = np.array([0.0, HALF, HALF, 0.0])
Q_D = np.array([0.0, 1.0, 0.0, 0.0])


def enu_from_ned(vectors: Array) -> Array:
    """Return world vectors (…, 3), north east down, as east, north, up."""
    return np.stack([vectors[..., 1], vectors[..., 0], 0.0 - vectors[..., 2]], axis=-1)


def flu_from_frd(vectors: Array) -> Array:
    """Return body vectors (…, 3), forward right down, as forward, left, up."""
    return np.stack([vectors[..., 0], 0.0 - vectors[..., 1], 0.0 - vectors[..., 2]], axis=-1)


def enu_yaw_from_ned(yaw: Array) -> Array:
    """Return angles (…,) from north clockwise as angles from east counter-clockwise, rad.

    Not wrapped: a yaw that turns twice still turns twice.
    """
    return 0.5 * np.pi - yaw


def enu_attitude_from_ned(quaternions: Array) -> Array:
    """Return FRD → NED quaternions (M, 4), w first, as FLU → ENU quaternions, w first."""
    return continuous(quaternion_product(quaternion_product(Q_P, quaternions), Q_D))


def quaternion_of_angles(angles: Array) -> Array:
    """Return FRD → NED quaternions (M, 4), w first, of roll, pitch, yaw (M, 3), rad.

    R = Rz(ψ) Ry(θ) Rx(φ), equation (5) of the source report. Signs are chosen so that one row
    follows the other without a jump, and the first has w ≥ 0.
    """
    half = 0.5 * np.asarray(angles, dtype=float)
    turns = []
    for axis, angle in zip((2, 1, 0), (half[:, 2], half[:, 1], half[:, 0]), strict=True):
        turn = np.zeros((len(half), 4))
        turn[:, 0], turn[:, 1 + axis] = np.cos(angle), np.sin(angle)
        turns.append(turn)
    return continuous(quaternion_product(quaternion_product(turns[0], turns[1]), turns[2]))


def quaternion_product(left: Array, right: Array) -> Array:
    """Return the Hamilton product left ⊗ right, (…, 4), w first."""
    a, b, c, d = np.moveaxis(left, -1, 0)
    w, x, y, z = np.moveaxis(right, -1, 0)
    return np.stack(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ],
        axis=-1,
    )


def rotated(quaternions: Array, vectors: Array) -> Array:
    """Return body vectors (M, 3) in the world axes of quaternions (M, 4), w first."""
    pure = np.concatenate([np.zeros((len(vectors), 1)), vectors], axis=1)
    conjugate = quaternions * np.array([1.0, -1.0, -1.0, -1.0])
    turned: Array = quaternion_product(quaternion_product(quaternions, pure), conjugate)[:, 1:]
    return turned


def continuous(quaternions: Array) -> Array:
    """Return the same rotations (M, 4) with the first w ≥ 0 and no jump of sign between rows."""
    agree = np.einsum("mi,mi->m", quaternions[:-1], quaternions[1:]) >= 0
    first = 1.0 if quaternions[0, 0] >= 0 else -1.0
    signs = first * np.cumprod(np.append(1.0, np.where(agree, 1.0, -1.0)))
    return np.asarray(signs[:, None] * quaternions)


def x_first(quaternions: Array) -> Array:
    """Return quaternions (…, 4) in the order x, y, z, w, as ROS and SciPy write them."""
    return np.asarray(quaternions[..., [1, 2, 3, 0]])
