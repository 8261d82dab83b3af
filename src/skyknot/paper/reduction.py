"""Section 5.3: the reduced-order model, solved first and lifted to the full craft by flatness.

Legend: J objective (10), x position and yaw as splines in time, N segments.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_lsq_spline

from skyknot.models import lift
from skyknot.paper.base import Claim, Finding, Measure, Scale, judged
from skyknot.paper.transfers import (
    FINAL_SHARE,
    GOAL,
    SEGMENTS,
    VEHICLE,
    Q,
    R,
    reduced_transfer,
    solved,
    state_at,
    transfer,
)
from skyknot.solution import Solution
from skyknot.trajectory import Trajectory
from skyknot.verification.evidence import Evidence

Array = NDArray[np.float64]

SAID_SAVING, SAID_SECONDS, SAID_LOSS = 0.67, 5.0, 0.04
"""What the source report says: time saved, time taken, s, and loss of the objective."""

DEGREE, PIECE = 7, 0.5
"""Degree of the splines (snap is continuous) and length of their pieces, s."""


def reduced_order(scale: Scale) -> Finding:
    """Judge "67 % less work, under 5 s, dynamically feasible, within 4 % of the full solution"."""
    N, repeats = scale.pick(50, SEGMENTS), scale.pick(2, 5)
    runs = [(solved(transfer(), N), solved(reduced_transfer(), N)) for _ in range(repeats)]
    full, reduced = runs[-1]
    seconds = [min(pair[i].solve_time for pair in runs) for i in (0, 1)]
    work = [pair.solve_time / pair.iterations for pair in (full, reduced)]
    lifted = lifted_trajectory(reduced)
    loss = objective_along(lifted) / full.objective - 1
    warm = solved(transfer(), N, guess=lifted)
    gaps = Evidence(transfer(), lifted, {}).samples
    slip = float(np.abs(gaps.state_rates - gaps.rates).max())
    start = float(np.abs(lifted.states[0]).max())
    saving = 1 - seconds[1] / seconds[0]
    feasible = start < 1e-3
    claim = Claim(
        claim="Reduced-order formulation",
        section="5.3",
        said=(
            "A reduced-order formulation needs 67 % less, takes under 5 s, keeps dynamic"
            " feasibility and is within 4 % of the full solution."
        ),
        measured=(
            Measure("time saved", 100 * saving, "%"),
            Measure("time of the reduced solve", 1e3 * seconds[1], "ms"),
            Measure("time per iteration, reduced over full", work[1] / work[0]),
            Measure("loss of J (10) along the lifted trajectory", 100 * loss, "%"),
            Measure("own objective off the full one", 100 * _apart(reduced, full), "%"),
            Measure("largest state asked for at t = 0, where 0 is given", start, "SI"),
            Measure("largest slip of dx/dt along the lift", slip, "SI/s"),
            Measure("iterations of the full problem from the lift", warm.iterations),
            Measure("iterations of the full problem from a straight line", full.iterations),
        ),
        how=(
            f"Translational–yaw model (7 states), N = {N}, best of {repeats} in turns; position"
            f" and yaw as splines of degree {DEGREE} over pieces of {PIECE:g} s, lifted to states"
            " and controls by flatness; J of the full problem along that; then the full problem"
            " started from it."
        ),
        verdict=judged(
            saving >= SAID_SAVING and seconds[1] < SAID_SECONDS and loss <= SAID_LOSS and feasible,
            seconds[1] < SAID_SECONDS and saving > 0 and loss <= SAID_LOSS,
        ),
        why=(
            "The reduced model is quick, but it may change its acceleration at once, which the"
            " craft cannot: tilting costs the torques and rates that the reduction leaves out."
            " Lifted, it asks for another attitude at t = 0 than the one given, so it is a guess"
            " for the full problem, not an answer."
        ),
    )
    data = {"times": lifted.times.tolist(), "lifted": lifted.states[:, :3].tolist()}
    return Finding(claim, data)


def lifted_trajectory(reduced: Solution) -> Trajectory:
    """Return states (N+1, 12) and wrenches (N+1, 4) that fly the reduced model's path."""
    times = reduced.times
    dense = np.linspace(times[0], times[-1], 8 * len(times))
    flat = reduced.state(dense)[:, [0, 1, 2, 6]]
    inner = np.arange(times[0] + PIECE, times[-1] - PIECE / 2, PIECE)
    knots = np.concatenate([[times[0]] * (DEGREE + 1), inner, [times[-1]] * (DEGREE + 1)])
    spline: BSpline = make_lsq_spline(dense, flat, knots, k=DEGREE)
    jets = [spline.derivative(order)(times) if order else spline(times) for order in range(5)]
    states, controls = lift(
        VEHICLE, *(jet[:, :3] for jet in jets), *(jet[:, 3] for jet in jets[:3])
    )
    lower, upper = VEHICLE.control_bounds
    return Trajectory(times, states, np.clip(controls, lower, upper))


def objective_along(trajectory: Trajectory) -> float:
    """Return J of equation (10) along a trajectory, by the trapezoidal rule at its nodes."""
    apart = trajectory.states - state_at(GOAL)
    effort = trajectory.controls - VEHICLE.hover
    density = apart**2 @ Q + effort**2 @ R
    integral = float(np.sum(0.5 * (density[1:] + density[:-1]) * np.diff(trajectory.times)))
    return integral + FINAL_SHARE * float(apart[-1] ** 2 @ Q)


def _apart(reduced: Solution, full: Solution) -> float:
    return abs(reduced.objective - full.objective) / full.objective
