"""The guess ladder: the user's own guess, else a flat lift, else a straight line at hover.

Legend: T duration, s in [0, 1] fraction of it, d^i/dt^i written by the order i.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.models.flatness import lift
from skyknot.models.quadrotor import CONTROL_NAMES
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory

Array = NDArray[np.float64]

NODES = 41
# Flights lifted at once: their samples stay in the processor's cache.
TOGETHER = 64
SIDES = "lower", "upper"
# Height of a bowed guess, as a share of the distance.
BOW = 0.3
# Rest-to-rest minimum-snap polynomial 35 s⁴ − 84 s⁵ + 70 s⁶ − 20 s⁷: three derivatives vanish at
# both ends, so the lifted attitude and body rates start and end at rest (Mellinger & Kumar 2011).
REST_TO_REST = np.polynomial.Polynomial([0, 0, 0, 0, 35, -84, 70, -20])


def initial_guess(problem: Problem) -> tuple[Trajectory, str]:
    """Return the best guess the ladder has without a solve, and the name of its rung.

    Returns
    -------
    guess : Trajectory over the problem's duration, or the start of its free horizon
    rung : "flat lift" or "straight line"
    """
    return next(ladder(problem))


def ladder(problem: Problem) -> Iterator[tuple[Trajectory, str]]:
    """Return the rungs from best to last: (guess, name).

    A flat lift where it applies, the straight line, and around drawn obstacles the straight line
    bowed to either side and over the top by ``BOW`` of its length.
    """
    return ladders([problem])[0]


def ladders(problems: Sequence[Problem]) -> list[Iterator[tuple[Trajectory, str]]]:
    """Return the ladders of problems that differ in initial states and parameters only."""
    lifts = flat_lifts(problems)
    return [_rungs(problem, lifted) for problem, lifted in zip(problems, lifts, strict=True)]


def _rungs(problem: Problem, lifted: Trajectory | None) -> Iterator[tuple[Trajectory, str]]:
    if lifted is not None:
        yield lifted, "flat lift"
    line = straight_line(problem)
    yield line, "straight line"
    if any(entry.shape is not None for entry in problem.path) and problem.nx >= 3:
        way = line.states[-1, :3] - line.states[0, :3]
        length = float(np.linalg.norm(way))
        side = np.array([-way[1], way[0], 0.0]) / max(float(np.hypot(way[0], way[1])), 1e-9)
        for direction, name in ((side, "left"), (-side, "right"), (np.array([0, 0, -1.0]), "over")):
            yield _bowed(problem, line, BOW * length * direction), f"line bowed {name}"


def _bowed(problem: Problem, line: Trajectory, offset: Array) -> Trajectory:
    times = np.linspace(line.times[0], line.times[-1], NODES)
    states = line.state(times)
    states[:, :3] += np.sin(np.pi * np.linspace(0, 1, NODES))[:, None] * offset
    return Trajectory(
        times,
        np.clip(states, problem.state_lower, problem.state_upper),
        line.control(times),
        state_names=problem.state_names,
        control_names=problem.control_names,
    )


def straight_line(problem: Problem) -> Trajectory:
    """Return states linear between the ends, controls at hover (or nearest zero)."""
    first, last = ends(problem)
    times = np.array([0.0, problem.duration_guess])
    control = resting_control(problem)
    return Trajectory(
        times,
        np.stack([first, last]),
        np.stack([control, control]),
        state_names=problem.state_names,
        control_names=problem.control_names,
    )


def ends(problem: Problem) -> tuple[Array, Array]:
    """Return first and last state: what is asked, else the target, else the nearest known."""
    return _ends_from(problem, _known(problem.initial_lower, problem.initial_upper))


def _ends_from(problem: Problem, first: Array) -> tuple[Array, Array]:
    """Return the ends from what is known of first states, (…, nx), NaN elsewhere."""
    last = _known(problem.final_lower, problem.final_upper)
    if problem.target is not None:
        last = np.where(np.isnan(last), problem.target, last)
    rest = np.clip(np.zeros(problem.nx), problem.state_lower, problem.state_upper)
    first_full = np.where(np.isnan(first), np.where(np.isnan(last), rest, last), first)
    return first_full, np.where(np.isnan(last), first_full, last)


def resting_control(problem: Problem) -> Array:
    """Return the vehicle's hover control where it fits, else the allowed value nearest zero."""
    hover = getattr(problem.vehicle, "hover", None)
    rest = np.zeros(problem.nu)
    if hover is not None:
        fitting = np.asarray(hover if _by_wrench(problem) else problem.vehicle.rotor_thrusts(hover))
        rest = fitting if fitting.shape == rest.shape else rest
    clipped: Array = np.clip(rest, problem.control_lower, problem.control_upper)
    return clipped


def flat_lift(problem: Problem) -> Trajectory | None:
    """Return the lift of the translational–yaw motion, or None where it does not apply.

    The translational–yaw model has a closed-form minimum-snap solution between two rests; its
    position and yaw determine every state and control of the quadrotor by differential flatness.
    """
    return flat_lifts([problem])[0]


def flat_lifts(problems: Sequence[Problem]) -> list[Trajectory | None]:
    """Return the flat lifts of problems that differ in initial states and parameters only."""
    found: list[Trajectory | None] = []
    for begin in range(0, len(problems), TOGETHER):
        found += _lifts(problems[begin : begin + TOGETHER])
    return found


def _lifts(problems: Sequence[Problem]) -> list[Trajectory | None]:
    one, n = problems[0], len(problems)
    if one.vehicle is None or one.nx != 12:
        return [None] * n
    known = _known(*(np.array([getattr(p, f"initial_{side}") for p in problems]) for side in SIDES))
    first, last = _ends_from(one, known)
    moves = np.column_stack([last[:, :3] - first[:, :3], last[:, 8] - first[:, 8]])
    if not np.any(moves):
        return [None] * n
    try:
        states, wrenches = _rest_to_rest_lift(one, first, moves)
    except UserError:  # too steep for the vehicle: the next rung of the ladder serves
        return [None] if n == 1 else [flat_lift(problem) for problem in problems]
    times = one.duration_guess * _rest_to_rest()[0]
    states = states.clip(one.state_lower, one.state_upper)
    return [
        _lifted(one, times, states[i], wrenches[i]) if np.any(moves[i]) else None for i in range(n)
    ]


def _rest_to_rest_lift(problem: Problem, first: Array, moves: Array) -> tuple[Array, Array]:
    """Return states (n, NODES, 12) and wrenches (n, NODES, 4) of moves (n, 4) from (n, 12)."""
    T, n = problem.duration_guess, len(first)
    shapes = np.array([d / T**i for i, d in enumerate(_rest_to_rest()[1])])
    flat = shapes[:, None, :, None] * moves[:, None, :]
    position, velocity, acceleration, jerk, snap = flat[..., :3]
    yaw, yaw_rate, yaw_acceleration = flat[:3, ..., 3]
    states, wrenches = lift(
        problem.vehicle,
        (first[:, None, :3] + position).reshape(-1, 3),
        velocity.reshape(-1, 3),
        acceleration.reshape(-1, 3),
        jerk.reshape(-1, 3),
        snap.reshape(-1, 3),
        (first[:, None, 8] + yaw).ravel(),
        yaw_rate.ravel(),
        yaw_acceleration.ravel(),
    )
    return states.reshape(n, NODES, 12), wrenches.reshape(n, NODES, 4)


def _lifted(problem: Problem, times: Array, states: Array, wrenches: Array) -> Trajectory | None:
    """Return a lifted flight with the problem's own controls, or None where it has no such."""
    by_wrench = _by_wrench(problem)
    controls = wrenches if by_wrench else problem.vehicle.rotor_thrusts(wrenches)
    if controls.shape[1] != problem.nu or not np.isfinite(states).all():
        return None
    return Trajectory(
        times,
        states,
        controls.clip(problem.control_lower, problem.control_upper),
        state_names=problem.state_names,
        control_names=problem.control_names,
    )


@cache
def _rest_to_rest() -> tuple[Array, tuple[Array, ...]]:
    """Return s, (NODES,), and the polynomial with its four derivatives there."""
    s = np.linspace(0, 1, NODES)
    return s, (REST_TO_REST(s), *(REST_TO_REST.deriv(i)(s) for i in range(1, 5)))


def _by_wrench(problem: Problem) -> bool:
    """Whether the controls are thrust and torques, not the thrust of each rotor."""
    return problem.control_names == CONTROL_NAMES


def _known(lower: Array, upper: Array) -> Array:
    """Return the fixed or middle value where both bounds are finite, NaN elsewhere."""
    bounded = np.isfinite(lower) & np.isfinite(upper)
    return np.where(
        bounded, 0.5 * (np.where(bounded, lower, 0) + np.where(bounded, upper, 0)), np.nan
    )
