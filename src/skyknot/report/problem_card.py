"""What was asked and how it was solved, as rows of label and text."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.report.reading import Reading

Array = NDArray[np.float64]

Rows = list[tuple[str, str]]


def problem_rows(reading: Reading) -> Rows:
    """Return vehicle, start, goal, horizon and limits; empty for a solution without its problem."""
    problem = reading.problem
    if problem is None:
        return []
    rows: Rows = []
    vehicle = reading.vehicle
    if vehicle is not None:
        ratio = f"thrust-to-weight {number(vehicle.thrust_to_weight)}"
        rows.append(("Vehicle", f"{vehicle.title}: {number(vehicle.mass)} kg, {ratio}"))
    rows.append(("Start", _place(reading, reading.trajectory.states[0])))
    if reading.target is not None:
        pulled = np.all(np.isinf(problem.final_lower) & np.isinf(problem.final_upper))
        manner = " (aimed at by the cost)" if pulled else ""
        rows.append(("Goal", _place(reading, reading.target) + manner))
    rows.append(("Horizon", _horizon(reading)))
    for label, kind in (("State limits", "state"), ("Control limits", "control")):
        names, units = getattr(problem, f"{kind}_names"), getattr(problem, f"{kind}s")
        low, high = getattr(problem, f"{kind}_lower"), getattr(problem, f"{kind}_upper")
        limits = [
            within(n, float(a), float(b), u.unit)
            for n, a, b, u in zip(names, low, high, units, strict=True)
            if np.isfinite(a) or np.isfinite(b)
        ]
        rows.append((label, "; ".join(limits) or "none"))
    for label, words in (
        ("Along the way", _along_the_way(problem.path)),
        ("Waypoints", [_constraint(entry) for entry in problem.points]),
    ):
        if words:
            rows.append((label, "; ".join(words)))
    return rows


def _along_the_way(path: Any) -> list[str]:
    """Return path constraints in words, obstacles together by the distance to keep."""
    kept: dict[float, list[str]] = {}
    words = []
    for entry in path:
        if entry.shape is not None and not entry.shape.keep_in:
            kept.setdefault(entry.shape.sizes.get("clearance", 0.0), []).append(entry.name)
        elif entry.shape is not None and entry.shape.kind != "band":
            words.append(f"inside {entry.name}")
        else:
            words.append(_constraint(entry))
    for distance, names in sorted(kept.items(), reverse=True):
        away = f"at least {number(distance)} m from" if distance else "clear of"
        words.insert(0, f"{away} {', '.join(names)}")
    return words


def solution_rows(reading: Reading) -> Rows:
    """Return scheme, mesh, solver, sizes and what came out."""
    solution, record = reading.solution, reading.solution.record
    steps = np.diff(solution.times)
    even = np.allclose(steps, steps[0], rtol=1e-6)
    length = (
        f"{number(steps[0])} s" if even else f"{number(steps.min())} to {number(steps.max())} s"
    )
    sizes = [
        f"{solution.decision.size} unknowns",
        f"{solution.multipliers['defects'].size} defects",
    ]
    rows = [
        ("Scheme", record.transcription),
        ("Mesh", f"{record.segments} segments of {length}"),
        ("Solver", f"{record.solver}, tolerance {number(record.tolerance)}, guess: {record.guess}"),
        ("Sizes", ", ".join(sizes)),
        ("Outcome", solution.message),
        ("KKT residual", f"{number(solution.kkt_residual)} (unscaled, the user's units)"),
        ("Largest defect", number(solution.max_defect)),
    ]
    if solution.rounds:
        rows.insert(2, ("Refinement", _refinement(solution)))
    if record.parameters:
        values = (f"{name} = {number(value)}" for name, value in record.parameters.items())
        rows.append(("Parameters", ", ".join(values)))
    return rows


def _refinement(solution: Any) -> str:
    """Return the meshes of a refinement, and how accurate the best one is."""
    meshes = ", ".join(str(entry.segments) for entry in solution.rounds)
    error = min(entry.error for entry in solution.rounds)
    reached = f"error {number(error)} of the states' sizes" if np.isfinite(error) else "none solved"
    return f"meshes of {meshes} segments; {reached}, {number(solution.record.accuracy)} asked for"


def headline_facts(reading: Reading) -> Rows:
    """Return the few numbers that people look for first."""
    solution = reading.solution
    return [
        ("Flight time" if reading.flies else "Duration", f"{solution.trajectory.duration:.4g} s"),
        ("Objective", f"{solution.objective:.6g}"),
        ("Segments", str(solution.record.segments)),
        ("Iterations", str(solution.iterations)),
        ("Solver time", seconds(solution.solve_time)),
    ]


def number(value: float) -> str:
    """Return a number in four digits with a proper minus sign."""
    return f"{value:.4g}".replace("-", "−")


def seconds(value: float) -> str:
    """Return a time in ms or s, three digits."""
    return f"{1e3 * value:.3g} ms" if value < 1 else f"{value:.3g} s"


def within(name: str, low: float, high: float, unit: str) -> str:
    """Return bounds in words: "v ≤ 2 m/s", "T 0 … 24 N"."""
    if low == high:
        text = f"{name} = {number(low)}"
    elif np.isinf(low):
        text = f"{name} ≤ {number(high)}"
    elif np.isinf(high):
        text = f"{name} ≥ {number(low)}"
    else:
        text = f"{name} {number(low)} … {number(high)}"
    return f"{text} {unit}".rstrip()


def _constraint(entry: Any) -> str:
    low = -np.inf if entry.lower is None else entry.lower
    high = np.inf if entry.upper is None else entry.upper
    when = f" at {100 * entry.at:.3g} % of the horizon" if hasattr(entry, "at") else ""
    return within(entry.name, low, high, entry.unit) + when


def _horizon(reading: Reading) -> str:
    horizon = reading.problem.horizon
    if not reading.problem.free_horizon:
        return f"{number(horizon)} s"
    found = number(reading.trajectory.duration)
    return f"free, {number(horizon.lower)} to {number(horizon.upper)} s; found {found} s"


def _place(reading: Reading, state: Array) -> str:
    """Return a state in words: position and heading of a craft, else every state that is known."""
    if not reading.flies:
        known = zip(reading.state_names, state, strict=True)
        return ", ".join(f"{name} = {number(value)}" for name, value in known if np.isfinite(value))
    parts = []
    for name, word, sign in (("x", "north", 1), ("y", "east", 1), ("z", "altitude", -1)):
        value = sign * float(reading.columns(state, name)[0])
        parts.append(f"{word} {number(value + 0.0)} m")
    if reading.has("psi") and np.isfinite(reading.columns(state, "psi")[0]):
        parts.append(f"heading {number(np.rad2deg(reading.columns(state, 'psi')[0]))}°")
    return ", ".join(part for part in parts if "nan" not in part)
