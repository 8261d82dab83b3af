"""What a scheme's order buys: one smooth problem, five schemes, five meshes, one long segment.

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


COLUMNS = {
    "Euler": sk.Euler,
    "trapezoid": sk.Trapezoid,
    "Hermite–Simpson": sk.HermiteSimpson,
    "Radau, 3 points": lambda segments: sk.Radau(segments, 3),
    "Lobatto, 5 points": lambda segments: sk.Lobatto(segments, 5),
}
print("segments " + "".join(f"{name:>19}" for name in COLUMNS))
for segments in (2, 4, 8, 16, 32):
    errors = []
    for scheme in COLUMNS.values():
        solution = sk.solve(problem, scheme(segments), tolerance=1e-12)
        errors.append(np.abs(solution.states[:, 0] - exact(solution.times)).max())
    print(f"{segments:8d} " + "".join(f"{error:19.2e}" for error in errors))

print("\none segment, points: error of the state, Lobatto")
for points in (4, 8, 12, 16):
    solution = sk.solve(problem, sk.Lobatto(1, points), tolerance=1e-12)
    t = np.linspace(0, 1, 200)
    print(f"{points:8d} {np.abs(solution.state(t)[:, 0] - exact(t)).max():19.2e}")
