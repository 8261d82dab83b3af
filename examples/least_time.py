"""Two problems of least time: the brachistochrone, and a cart that may push harder than brake.

Shows: a free horizon, a guess of one's own, and a mesh that moves onto the switch of a control.
"""

import casadi as ca
import numpy as np

import skyknot as sk

GRAVITY = 9.80665

brachistochrone = sk.Problem(
    name="brachistochrone",
    states=["x", "y", "v"],
    controls=["angle"],
    dynamics=lambda s, u: [s[2] * ca.sin(u[0]), -s[2] * ca.cos(u[0]), GRAVITY * ca.cos(u[0])],
    horizon=sk.Free(0.5, 5.0),
    initial=[0, 5, 0],
    final=[10, 0, None],
    terminal_cost=lambda s, tf: tf,
)
guess = sk.Trajectory([0, 2], [[0, 5, 0], [10, 0, 9.9]], [[0.1], [1.7]])
solution = sk.solve(brachistochrone, sk.HermiteSimpson(20), guess=guess)
print(f"brachistochrone: {solution.times[-1]:.6f} s (cycloid: 1.801603 s)")

cart = sk.Problem(
    name="cart",
    states=["x", "v"],
    controls=["a"],
    dynamics=lambda s, u: [s[1], u[0]],
    horizon=sk.Free(1.0, 20.0),
    initial=[0, 0],
    final=[10, 0],
    running_cost=lambda s, u: 1,
    control_bounds=(-2, 1),
)
exact = np.sqrt(2 * 10 * (1 / 1 + 1 / 2))
for name, accuracy in (("10 equal segments", None), ("refined", 1e-4)):
    solution = sk.solve(cart, sk.HermiteSimpson(10), tolerance=1e-9, accuracy=accuracy)
    error = solution.objective - exact
    print(f"cart, {name}: {solution.objective:.6f} s, error {error:.1e}")
for mesh in solution.rounds:
    spread = 100 * mesh.switching
    print(f"  {mesh.segments:3d} segments: the switch is spread over {spread:.2f} % of the time")
