"""An independent witness: the quadrotor in matrices, plain numpy, real or complex.

Written from the laws (Newton, Euler, v = R w), sharing no code with the package.
"""

from __future__ import annotations

import numpy as np


def axis_rotation(axis, angle):
    """Return the rotation matrix about one coordinate axis."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = np.eye(3, dtype=np.result_type(angle, float))
    R[i, i], R[i, j], R[j, i], R[j, j] = c, -s, s, c
    return R


def attitude(angles):
    """Return body-to-inertial R for ZYX angles (phi, theta, psi)."""
    phi, theta, psi = angles
    return axis_rotation(2, psi) @ axis_rotation(1, theta) @ axis_rotation(0, phi)


def rate_map(angles):
    """Return W with omega = W (phi', theta', psi'), from the three successive rotations."""
    phi, theta, _ = angles
    e = np.eye(3)
    to_body = axis_rotation(0, phi).T
    return np.column_stack([e[0], to_body @ e[1], to_body @ axis_rotation(1, theta).T @ e[2]])


def derivative(x, u, mass, inertia, gravity, drag=(0, 0, 0), wind=(0, 0, 0)):
    """Return xdot for the state x (12,) and wrench u (4,)."""
    x, u = np.asarray(x), np.asarray(u)
    velocity, angles, omega = x[3:6], x[6:9], x[9:12]
    R, I = attitude(angles), np.diag(inertia)  # noqa: E741
    force = R @ np.array([0, 0, -1]) * u[0] + mass * gravity * np.array([0, 0, 1.0])
    force = force - R @ np.diag(drag) @ R.T @ (velocity - np.asarray(wind))
    spin = np.linalg.solve(I, u[1:] - np.cross(omega, I @ omega))
    return np.concatenate([velocity, force / mass, np.linalg.solve(rate_map(angles), omega), spin])


def complex_step_jacobian(function, point, step=1e-30):
    """Return the Jacobian of a complex-capable function, exact to rounding."""
    columns = []
    for i in range(len(point)):
        moved = np.array(point, dtype=complex)
        moved[i] += 1j * step
        columns.append(np.asarray(function(moved)).imag / step)
    return np.column_stack(columns)
