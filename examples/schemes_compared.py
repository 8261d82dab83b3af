"""What a scheme's order buys: one smooth problem, three schemes, four meshes.

Shows: transcriptions as objects, and an error table against a closed form (Hager, Numerische
Mathematik 87, 2000).
"""

import numpy as np

import skyknot as sk

problem = sk.Problem(
    name="hager",
    states=["x"],
    controls=["u"],
    dynamics=lambda x, u: [0.5 * x[0] + u[0]],
    horizon=1.0,
    initial=[1],
    running_cost=lambda x, u: 0.5 * (u[0] ** 2 + 2 * x[0] ** 2),
)


def exact(t):
    """Return the optimal state."""
    return (2 * np.exp(3 * t) + np.exp(3)) / (np.exp(1.5 * t) * (2 + np.exp(3)))


print("segments " + "".join(f"{name:>18}" for name in ("Euler", "trapezoid", "Hermite–Simpson")))
for segments in (5, 10, 20, 40):
    errors = []
    for scheme in (sk.Euler, sk.Trapezoid, sk.HermiteSimpson):
        solution = sk.solve(problem, scheme(segments), tolerance=1e-12)
        errors.append(np.abs(solution.states[:, 0] - exact(solution.times)).max())
    print(f"{segments:8d} " + "".join(f"{error:18.2e}" for error in errors))
