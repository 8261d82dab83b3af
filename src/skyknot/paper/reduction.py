"""Section 5.3: the reduced-order model, solved first and lifted to the full craft by flatness.

Legend: J objective (10), x position and yaw as splines in time, N segments.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.models import lifted_path
from skyknot.models.reduced_path import DEGREE, PIECE
from skyknot.paper.base import Claim, Finding, Measure, Scale, judged
from skyknot.paper.transfers import (
    FINAL_SHARE,
    GOAL,
    VEHICLE,
    Goal,
    Q,
    R,
    reduced_transfer,
    seeded_goals,
    solved,
    state_at,
    transfer,
)
from skyknot.problem.problem import Problem
from skyknot.solution import Solution
from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]

SAID_SAVING, SAID_SECONDS, SAID_LOSS = 0.67, 5.0, 0.04
"""What the source report says: time saved, time taken, s, and loss of the objective."""

SOLVER = "projected-gradient"
FEASIBLE = 1e-3
"""A start this near to the one given counts as it, in SI units."""


def reduced_order(scale: Scale) -> Finding:
    """Judge "67 % less work, under 5 s, dynamically feasible, within 4 % of the full solution"."""
    N, count = scale.pick((20, 3), (50, 20))
    goals = [GOAL, *seeded_goals(count - 1)]
    pairs = [compared(goal, N) for goal in goals]
    lifts = [pair for pair in pairs if pair.lifted is not None]
    saving = np.array([pair.saving for pair in pairs])
    loss = np.array([pair.loss for pair in lifts])
    apart = np.array([pair.start for pair in lifts])
    slowest = max(pair.seconds for pair in pairs)
    within = float(np.sum(np.abs(loss) <= SAID_LOSS)) / count
    worth = abs(float(np.median(loss)))
    feasible = float(np.median(apart)) < FEASIBLE and len(lifts) == count
    quick = float(np.median(saving)) >= SAID_SAVING and slowest < SAID_SECONDS
    claim = Claim(
        claim="Reduced-order formulation",
        section="5.3",
        said=(
            "A reduced-order formulation needs 67 % less, takes under 5 s, keeps dynamic"
            " feasibility and is within 4 % of the full solution."
        ),
        measured=(
            Measure.of_many("time of the iterations saved", 100 * saving, "%"),
            Measure("longest reduced solve, building included", 1e3 * slowest, "ms"),
            Measure.of_many("loss of J (10) along the lift", 100 * loss, "%"),
            Measure("transfers lifted and within 4 %", 100 * within, "%"),
            Measure("transfers whose lift needs no more than 89° of tilt", len(lifts)),
            Measure.of_many("state asked for at t = 0 off the one given", apart, "SI"),
            Measure.of_many("iterations, reduced", [pair.counts[1] for pair in pairs]),
            Measure.of_many("iterations, full", [pair.counts[0] for pair in pairs]),
            Measure.of_many("iterations, full from the lift", [pair.counts[2] for pair in lifts]),
        ),
        how=(
            f"{count} transfers: the report's and seeded goals, N = {N}, projected gradient,"
            " structured. Translational–yaw model (7 states), position and yaw as splines of degree"
            f" {DEGREE} over pieces of {PIECE:g} s, lifted to states and controls by flatness; J of"
            " the full problem along that; then the full problem started from it. Processor time"
            " between first and last iteration."
        ),
        verdict=judged(quick and feasible and within == 1, quick and worth <= SAID_LOSS),
        why=(
            "The reduced problem is linear with a quadratic cost and bounds: one projected step"
            " solves it. But the model may change its acceleration at once, which the craft cannot:"
            " tilting costs the torques and rates that the reduction leaves out. Lifted, it asks"
            " for another attitude at t = 0 than the one given (hence losses below zero), so it is"
            " a preliminary path and a guess, not a flight; and the loss is within 4 % for"
            f" {100 * within:.0f} % of the transfers only."
        ),
    )
    return Finding(claim, {"saving": saving.tolist(), "loss": loss.tolist()})


@dataclass(frozen=True)
class Compared:
    """One transfer, solved in full and reduced.

    Attributes
    ----------
    saving : share of the full problem's iteration time
    seconds : reduced solve, building included
    counts : iterations: full, reduced, full from the lift
    lifted : path of the reduced model as a flight; None where it needs too much tilt
    loss : of J along the lift, a share of the full optimum
    start : largest difference from the state given at t = 0
    """

    saving: float
    seconds: float
    counts: tuple[int, int, int]
    lifted: Trajectory | None
    loss: float
    start: float


def compared(goal: Goal, segments: int) -> Compared:
    """Return a transfer's full and reduced solves, and what the lift of the second is worth."""
    full, long = _timed(transfer(goal), segments)
    reduced, short = _timed(reduced_transfer(goal), segments)
    counts = full.iterations, reduced.iterations
    saving = 1 - short / long
    try:
        lifted = lifted_trajectory(reduced)
    except UserError:  # a path in free fall has no attitude
        return Compared(saving, reduced.solve_time, (*counts, 0), None, np.inf, np.inf)
    warm = solved(transfer(goal), segments, solver=SOLVER, guess=lifted)
    loss = objective_along(lifted, goal) / full.objective - 1
    start = float(np.abs(lifted.states[0]).max())
    return Compared(saving, reduced.solve_time, (*counts, warm.iterations), lifted, loss, start)


def lifted_trajectory(reduced: Solution) -> Trajectory:
    """Return states (N+1, 12) and wrenches (N+1, 4), within their bounds, along a reduced path."""
    lifted = lifted_path(VEHICLE, reduced.trajectory)
    lower, upper = VEHICLE.control_bounds
    return Trajectory(lifted.times, lifted.states, np.clip(lifted.controls, lower, upper))


def objective_along(trajectory: Trajectory, goal: Goal = GOAL) -> float:
    """Return J of equation (10) along a trajectory, by the trapezoidal rule at its nodes."""
    apart = trajectory.states - state_at(goal)
    effort = trajectory.controls - VEHICLE.hover
    density = apart**2 @ Q + effort**2 @ R
    integral = float(np.sum(0.5 * (density[1:] + density[:-1]) * np.diff(trajectory.times)))
    return integral + FINAL_SHARE * float(apart[-1] ** 2 @ Q)


def _timed(problem: Problem, segments: int) -> tuple[Solution, float]:
    """Return the solution and the processor time from its first to its last iteration, s."""
    told: list[float] = []

    def tick(_record: object) -> None:
        told.append(time.process_time())

    solution = solved(problem, segments, solver=SOLVER, callback=tick)
    return solution, told[-1] - told[0]
