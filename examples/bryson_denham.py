"""The first problem to solve: rise and come back within a ceiling, with the least effort.

Shows: stating a problem, solving it, reading the answer, and what the multipliers mean.
The optimum is 4 / (9 l) for a ceiling l (Bryson, Denham & Dreyfus, AIAA Journal 1, 1963).
"""

import skyknot as sk

CEILING = 1 / 9

problem = sk.Problem(
    name="bryson-denham",
    states=[sk.State("x", unit="m", upper=CEILING), sk.State("v", unit="m/s")],
    controls=[sk.Control("a", unit="m/s²")],
    dynamics=lambda x, u: [x[1], u[0]],
    horizon=1.0,
    initial=[0, 1],
    final=[0, -1],
    running_cost=lambda x, u: 0.5 * u[0] ** 2,
)

solution = sk.solve(problem, sk.HermiteSimpson(segments=60), tolerance=1e-8)

print(solution.message)
print(f"objective {solution.objective:.4f}, closed form {4 / (9 * CEILING):.4f}")
print(f"highest point {solution.state(0.5)[0]:.4f} m of {CEILING:.4f} m")
# The costate of x falls by 18 where the ceiling is met, and again where it is left.
print("costate of x before, on and after the ceiling:", solution.costates[[0, 30, 60], 0].round(2))
