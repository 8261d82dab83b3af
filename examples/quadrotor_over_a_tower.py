"""A quadrotor flies round a tower within its limits, and brings the flight home as CSV.

Shows: a vehicle, obstacles, limits on tilt and speed, the guess ladder, saving and loading.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import skyknot as sk

craft = sk.vehicles.load("hummingbird")
model = craft.wrench_model()

problem = sk.Problem(
    name="round the tower",
    states=list(model.state_names),
    controls=list(model.control_names),
    dynamics=craft.dynamics,
    horizon=4.0,
    initial=[0.0] * 12,
    final=[6.0, 1.0, -1.0] + [0.0] * 9,
    running_cost=lambda x, u: sum(
        ((u[i] - craft.hover[i]) / max(craft.control_bounds[1][i], 1e-3)) ** 2 for i in range(4)
    ),
    state_bounds=craft.state_bounds,
    control_bounds=craft.control_bounds,
    path=[
        sk.cylinder("tower", center=(3.0, 0.4), radius=0.8, clearance=0.2),
        sk.tilt_limit("tilt", np.deg2rad(40)),
        sk.speed_limit("speed", 4.0),
    ],
    vehicle=craft,
)

# A straight guess would run through the tower; bow it to the free side.
guess, rung = sk.initial_guess(problem)
states = guess.states.copy()
states[:, 1] -= 1.2 * np.sin(np.pi * guess.times / guess.duration)
bowed = sk.Trajectory(guess.times, states, guess.controls)

solution = sk.solve(problem, sk.HermiteSimpson(segments=30), guess=bowed)
print(solution.message)
distance = np.hypot(solution.states[:, 0] - 3.0, solution.states[:, 1] - 0.4)
print(f"guess: {rung}; nearest to the tower's axis: {distance.min():.3f} m")

with TemporaryDirectory() as folder:
    path = solution.save(Path(folder) / "flight.npz")
    sk.write_csv(solution, Path(folder) / "flight.csv")
    again = sk.solve(problem, sk.HermiteSimpson(segments=30), guess=sk.load(path))
print(f"solved again from the file: {again.iterations} iterations")
