"""The flights that the claims are judged on: the report's transfer, and smooth relatives of it.

The source report (V. P. Gautam and S. Nerella, AOE 5404, Virginia Tech) publishes its model, its
cost (10) and its size (N = 100, Δt = 0.1 s), but neither vehicle nor weights. Those below are the
project's reference problem, the library mission ``report_transfer``; a test holds them together.

Legend: N segments, x state (12), u wrench [T τx τy τz], NED, SI units.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.models import Allocation, Quadrotor, TranslationalYaw, Vehicle, WrenchLimits
from skyknot.models.translational_yaw import flyable_accelerations
from skyknot.problem.costs import QuadraticTracking
from skyknot.problem.problem import Problem
from skyknot.problem.variables import Control, State
from skyknot.solution import Solution
from skyknot.solve import solve
from skyknot.status import Status

Array = NDArray[np.float64]

SEGMENTS, DURATION = 100, 10.0
"""Size of the report's transfer: N, and t_f = N Δt with Δt = 0.1 s."""

Goal = tuple[float, float, float, float]
GOAL: Goal = (8.0, 6.0, -5.0, np.pi / 2)
"""Position, m, and yaw, rad, of the goal."""

NEAREST, SEED = 0.3, 18
"""Seeded goals: each coordinate of the report's goal by a factor from here to 1, either sign."""

GRADING = 2.0
"""Nodes of the graded mesh at t_f (k/N) to this power: dense where the flight begins."""

ACCURACY = 1e-4
"""Accuracy asked for where the mesh is refined: a share of each state's size."""

Q = np.array([1, 1, 1, 0.2, 0.2, 0.2, 0.5, 0.5, 1, 0.05, 0.05, 0.05])
R = np.array([0.02, 2, 2, 4])
FINAL_SHARE = 100.0
"""Weights of equation (10): Q and R diagonal, Q_f = 100 Q."""

REDUCED_TILT, REDUCED_YAW_RATE = float(np.deg2rad(60.0)), float(np.pi)
"""Bounds of the translational–yaw model, rad and rad/s: wide, so as not to slow it artificially."""

VEHICLE = Vehicle(
    name="report",
    title="Quadrotor of the source report",
    kind="small",
    mass=1.2,
    inertia=(0.012, 0.012, 0.022),
    gravity=9.81,
    allocation=Allocation.x(arm=0.25, kappa=0.05),
    thrust_min=0.0,
    thrust_max=6.0,
    wrench_limits=WrenchLimits(thrust=(0.0, 24.0), torque=(0.5, 0.5, 0.2)),
)


def state_at(place: Goal) -> Array:
    """Return the state (12,) of hover at a place: position, m, and yaw, rad."""
    state = np.zeros(12)
    state[:3], state[8] = place[:3], place[3]
    return state


def transfer(goal: Goal = GOAL, start: Array | None = None) -> Problem:
    """Return the report's transfer to a goal, from rest at the origin or another state (12,)."""
    target = state_at(goal)
    tracking = QuadraticTracking(target, Q, R, FINAL_SHARE * Q, VEHICLE.hover)
    return Problem(
        initial=list(np.zeros(12) if start is None else start),
        target=list(target),
        **_craft(VEHICLE.wrench_model(), bounded=True),
        **_costs(tracking),
    )


def seeded_goals(count: int) -> list[Goal]:
    """Return goals drawn with a fixed seed: up to the report's distance, any side, up or down."""
    generator = np.random.default_rng(SEED)
    goals: list[Goal] = []
    for _ in range(count):
        share = generator.uniform(NEAREST, 1.0, 4) * generator.choice([-1.0, 1.0], 4)
        x, y, z, yaw = (float(value) for value in share * np.array(GOAL))
        goals.append((x, y, z, yaw))
    return goals


def smooth_transfer(duration: float = 4.0) -> Problem:
    """Return a transfer with fixed ends, least control effort and no bounds: a smooth optimum."""
    tracking = QuadraticTracking(np.zeros(12), 0 * Q, R, None, VEHICLE.hover)
    goal = state_at((2.0, 1.5, -1.0, 0.6))
    chosen = _craft(VEHICLE.wrench_model(), bounded=False) | {"horizon": duration}
    return Problem(
        initial=[0.0] * 12,
        final=list(goal),
        running_cost=tracking.running_cost,
        **chosen,
    )


def reduced_transfer(goal: Goal = GOAL) -> Problem:
    """Return the transfer to a goal for the translational–yaw model.

    Position, velocity and yaw keep their weights. What the model lacks is put in terms of what it
    has, to first order at hover: tilt = horizontal acceleration / g, thrust − m g = −m a_z, and
    r = ψ'. Pitch and roll rates and torques are left out: that is the reduction.
    """
    mass, g = VEHICLE.mass, VEHICLE.gravity
    keep = [0, 1, 2, 3, 4, 5, 8]
    effort = np.array([Q[7] / g**2, Q[6] / g**2, R[0] * mass**2, Q[11]])
    target = state_at(goal)[keep]
    tracking = QuadraticTracking(target, Q[keep], effort, FINAL_SHARE * Q[keep])
    return Problem(
        initial=[0.0] * 7,
        target=list(target),
        **_craft(_reduced_model(), bounded=True),
        **_costs(tracking),
    )


def _costs(tracking: QuadraticTracking) -> dict[str, Any]:
    return dict(tracking.callables())


def _reduced_model() -> TranslationalYaw:
    """Return the model with as much tilt and yaw rate as the full craft uses, not less."""
    mass, g = VEHICLE.mass, VEHICLE.gravity
    most = float(VEHICLE.control_bounds[1][0])
    box = flyable_accelerations(mass, g, most, REDUCED_TILT)
    rotors = VEHICLE.allocation.rotor_count
    return TranslationalYaw(mass, g, rotors, box, REDUCED_YAW_RATE)


def _craft(model: Quadrotor | TranslationalYaw, bounded: bool) -> dict[str, Any]:
    """Return the arguments of a Problem that come from the model."""
    states = zip(model.state_names, model.state_units, strict=True)
    controls = zip(model.control_names, model.control_units, strict=True)
    arguments: dict[str, Any] = {
        "name": f"transfer, {model.name}",
        "states": [State(*pair) for pair in states],
        "controls": [Control(*pair) for pair in controls],
        "dynamics": model.dynamics,
        "horizon": DURATION,
        "vehicle": VEHICLE,
    }
    if bounded:
        arguments |= {"state_bounds": model.state_bounds, "control_bounds": model.control_bounds}
    return arguments


def scheme(segments: int, name: str = "hermite-simpson", **choices: str) -> dict[str, Any]:
    """Return the choice of a transcription for ``solve``."""
    return {"scheme": name, "segments": segments, **choices}


def graded(segments: int) -> dict[str, Any]:
    """Return Hermite–Simpson on nodes that lie densest at the start, for ``solve``."""
    nodes = np.linspace(0.0, 1.0, segments + 1) ** GRADING
    return {"scheme": "hermite-simpson", "mesh": nodes}


def solved(problem: Problem, mesh: int | dict[str, Any], **choices: Any) -> Solution:
    """Return the solution on a number of equal segments, or with the transcription given.

    ``choices`` as for ``solve``.

    Raises
    ------
    RuntimeError
        When it is not solved: no number may rest on it.
    """
    chosen = scheme(mesh) if isinstance(mesh, int) else mesh
    solution = tried(problem, chosen, **choices)
    if not solution.success:
        raise RuntimeError(f"{problem.name}: {solution.message}")
    return solution


def tried(problem: Problem, mesh: dict[str, Any], **choices: Any) -> Solution:
    """Return the solution, solved or not; ``choices`` as for ``solve``.

    Raises
    ------
    KeyboardInterrupt
        When the solve was interrupted, so that nobody takes half a solve for a measurement.
    """
    solution = solve(problem, mesh, **choices)
    if solution.status is Status.INTERRUPTED:
        raise KeyboardInterrupt
    return solution


@lru_cache(maxsize=8)
def report_flight(segments: int = SEGMENTS) -> Solution:
    """Return the report's transfer, solved by the default solver; kept for all experiments."""
    return solved(transfer(), segments)


@lru_cache(maxsize=4)
def graded_flight(segments: int = SEGMENTS) -> Solution:
    """Return the report's transfer on the graded mesh."""
    return solved(transfer(), graded(segments))


@lru_cache(maxsize=1)
def refined_flight() -> Solution:
    """Return the report's transfer on a mesh refined to ``ACCURACY`` from a quarter of N."""
    return solved(transfer(), SEGMENTS // 4, accuracy=ACCURACY)


@lru_cache(maxsize=4)
def descent_flight(segments: int = SEGMENTS) -> Solution:
    """Return the report's transfer, solved by the projected gradient in its structured form."""
    return solved(transfer(), segments, solver="projected-gradient")
