"""On request: what a certificate can say only by solving again.

Three more checks: convergence over three meshes, sensitivity to the start, and a second solver.
They take as long as six or seven solves. Verification itself imports no solver; so they live here,
beside the front door, and hand their results in as checks.

Legend: J objective, p costate, x₀ initial state, δ a change of it, γ of equation (27) of the source
report: |J(x₀ + δ) − J(x₀)| ≤ γ ‖δ‖.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.problem.problem import Ends, Problem
from skyknot.solution import Solution
from skyknot.solve import resolve_transcription, solve
from skyknot.transcription import Transcription
from skyknot.transcription.schemes import SCHEMES
from skyknot.verification import Certificate, Check, Limits, certify
from skyknot.verification.evidence import Evidence

Array = NDArray[np.float64]

SETTLED = 1e-6
"""Change of the objective, relative, below which it counts as settled."""

PERTURBATION = 1e-3
"""Change of the start, as a share of the sizes of its states."""

AGREEMENT = 0.1
"""Share by which the predicted and the solved change of the objective may differ."""

OTHER_SOLVER = {"ipopt": "interior-point"}
"""Solver that checks on another; Ipopt checks on all that are not named."""


def examine(
    solution: Solution,
    problem: Problem | None = None,
    transcription: Transcription | Mapping[str, Any] | str | None = None,
    limits: Limits | None = None,
) -> Certificate:
    """Return the certificate of a solution with the checks that have to solve again.

    Parameters
    ----------
    solution : what is to be examined
    problem : the problem solved; needed for a solution read from a file
    transcription : the scheme it was solved with, its mesh aside; found from the solution where it
        is one of the schemes by their default number of points
    limits : limits other than the defaults of the vehicle's class

    Raises
    ------
    UserError
        When problem or scheme are not known.
    """
    asked = problem or solution.problem
    if asked is None or solution.witness is None:
        raise UserError(
            "This solution cannot be examined.",
            where="problem" if asked is None else "solution",
            found="no problem" if asked is None else "no multipliers",
            expected="a solution with its multipliers, and the problem that was solved",
            do="Pass the problem; solve again if the file is of an earlier version.",
        )
    chosen = limits or Limits.of(asked.vehicle)
    known = replace(solution, problem=asked)
    scheme = _scheme(known, transcription)
    base = certify(
        asked, solution.trajectory, solution.record.parameters, chosen, known.full_witness()
    )
    more = [
        convergence(known, scheme, chosen),
        sensitivity(known, scheme),
        cross_check(known, scheme, chosen),
    ]
    checks = base.checks | {check.name: check for check in more if check is not None}
    return replace(base, checks=checks)


def convergence(solution: Solution, scheme: Transcription, limits: Limits) -> Check:
    """Check that objective and states settle over the mesh, its halves and its quarters.

    The objective is judged: where an optimum is flat, or not unique, states may move between
    meshes though neither is wrong. The observed order of the states is told.
    """
    problem = _asked(solution)
    meshes = [solution]
    for parts in (2, 4):
        mesh = replace(scheme, nodes=_divided(scheme.nodes, parts))
        again = solve(problem, mesh, guess=solution, tolerance=solution.record.tolerance)
        if not again.success:
            return _failed("mesh convergence", f"solving on {mesh.segments} segments", again)
        meshes.append(again)
    sizes = Evidence(problem, solution.trajectory, solution.record.parameters).state_sizes
    gaps = [
        np.abs(_at(fine, scheme.nodes) - _at(coarse, scheme.nodes)) / sizes
        for coarse, fine in pairwise(meshes)
    ]
    size = max(1.0, abs(solution.objective))
    change, last = (
        abs(fine.objective - coarse.objective) / size for coarse, fine in pairwise(meshes)
    )
    apart, closer = (float(np.max(gap)) for gap in gaps)
    order = float(np.log2(apart / closer)) if closer > 0 else np.inf
    k, i = np.unravel_index(int(np.argmax(gaps[0])), gaps[0].shape)
    return Check(
        name="mesh convergence",
        value=change,
        limit=limits.minimum,
        unit="",
        passed=bool(change <= limits.minimum and (last <= change or last <= SETTLED)),
        how="Solved again with every segment in halves and in quarters: change of the objective"
        " from this mesh to the halves, relative to the largest of 1 and the objective, which must"
        f" not grow on the way to the quarters; the states at the nodes move by {apart:.2g} of"
        f" their sizes, with observed order {order:.2g}.",
        worst=f"states of order {order:.2g}, {problem.state_names[i]} by {apart:.2g} of its size at"
        f" {solution.times[k]:.4g} s",
    )


def sensitivity(solution: Solution, scheme: Transcription) -> Check | None:
    """Check γ of equation (27): the slope of J by the multipliers against solving again."""
    problem = _asked(solution)
    fixed = problem.initial_lower == problem.initial_upper
    sizes = Evidence(problem, solution.trajectory, solution.record.parameters).state_sizes
    x0, step = solution.states[0], PERTURBATION * sizes
    inside = (x0 - step > problem.state_lower) & (x0 + step < problem.state_upper)
    moved = fixed & inside
    slope = _initial_slope(solution)
    scaled = np.where(moved, slope * sizes, 0.0)
    if not np.any(scaled):
        return None
    delta = step * scaled / np.linalg.norm(scaled)
    objectives = []
    for sign in (1.0, -1.0):
        start = problem.varied(initial=_initial(problem, x0 + sign * delta, moved))
        again = solve(start, scheme, guess=solution, tolerance=solution.record.tolerance)
        if not again.success:
            return _failed("sensitivity", "solving from another start", again)
        objectives.append(again.objective)
    found = 0.5 * (objectives[0] - objectives[1])
    predicted = float(slope @ delta)
    gamma = float(np.linalg.norm(slope[moved]))
    value = abs(found - predicted) / abs(predicted)
    return Check(
        name="sensitivity",
        value=value,
        limit=AGREEMENT,
        unit="",
        passed=bool(value <= AGREEMENT),
        how="Slope of the objective along the initial state, from the multipliers, against solving"
        f" again from two opposite starts {PERTURBATION:g} of their sizes off in the worst"
        f" direction: share by which they differ; γ of equation (27) is {gamma:.4g}, in SI units.",
        worst=f"γ = {gamma:.4g}; {found:.4g} solved, {predicted:.4g} predicted",
    )


def cross_check(solution: Solution, scheme: Transcription, limits: Limits) -> Check:
    """Check that another solver ends at the same objective from this trajectory, unhelped."""
    other = OTHER_SOLVER.get(solution.record.solver, "ipopt")
    again = solve(
        _asked(solution),
        scheme,
        other,
        guess=solution.trajectory,
        tolerance=solution.record.tolerance,
    )
    if not again.success:
        return _failed("second solver", f"solver '{other}'", again)
    value = abs(again.objective - solution.objective) / max(1.0, abs(solution.objective))
    apart = float(np.max(np.abs(again.states - solution.states)))
    return Check(
        name="second solver",
        value=value,
        limit=10 * limits.optimality,
        unit="",
        passed=bool(value <= 10 * limits.optimality),
        how=f"Solved again by '{other}' on the same mesh from the trajectory alone, without"
        " multipliers: difference of the objectives, relative to the largest of 1 and the"
        " objective.",
        worst=f"states at most {apart:.2g} apart",
    )


def _scheme(
    solution: Solution, choice: Transcription | Mapping[str, Any] | str | None
) -> Transcription:
    """Return the scheme of a solution on the solution's own mesh."""
    w, times = solution.witness, solution.times
    assert w is not None
    nodes = (times - times[0]) / solution.trajectory.duration
    nodes[-1] = 1.0
    if choice is not None:
        found = replace(resolve_transcription(choice), nodes=nodes)
        places = found.table.control_points[found.controls]
        if _same(found.table.points, w.points) and _same(places, w.control_points):
            return found
    for table in () if choice is not None else SCHEMES.values():
        for controls, places in table.control_points.items():
            alike = _same(table.points, w.points) and _same(places, w.control_points)
            if alike and _same(table.A, w.A) and table.shares_controls(controls) == w.shared:
                return Transcription(table, nodes, controls)
    raise UserError(
        "The scheme of this solution is not known.",
        where="transcription",
        found=solution.record.transcription,
        expected="the transcription it was solved with",
        do="Pass it, e.g. transcription=sk.Lobatto(points=7).",
    )


def _same(a: Array, b: Array) -> bool:
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=0, atol=1e-12))


def _asked(solution: Solution) -> Problem:
    assert solution.problem is not None
    return solution.problem


def _divided(nodes: Array, parts: int) -> Array:
    """Return the mesh with every segment in equal parts."""
    shares = np.arange(parts) / parts
    inner = nodes[:-1, None] + np.diff(nodes)[:, None] * shares
    return np.append(inner.ravel(), 1.0)


def _at(solution: Solution, nodes: Array) -> Array:
    """Return (N+1, nx) states at fractions of the horizon that are nodes of its mesh."""
    times = solution.times[0] + nodes * solution.trajectory.duration
    nearest = np.argmin(np.abs(solution.times[None, :] - times[:, None]), axis=1)
    result: Array = solution.states[nearest]
    return result


def _initial_slope(solution: Solution) -> Array:
    """Return (nx,) ∂J/∂x₀: minus the multipliers that hold the initial state."""
    assert solution.witness is not None
    result: Array = -solution.witness.state_bounds[0, 0]
    return result


def _initial(problem: Problem, start: Array, moved: NDArray[np.bool_]) -> Ends:
    """Return the initial condition with some of its states moved."""
    low = np.where(moved, start, problem.initial_lower)
    high = np.where(moved, start, problem.initial_upper)
    return [
        (float(a) if np.isfinite(a) else None, float(b) if np.isfinite(b) else None)
        for a, b in zip(low, high, strict=True)
    ]


def _failed(name: str, what: str, again: Solution) -> Check:
    """Return the failed check of a solve that did not succeed."""
    return Check(
        name=name,
        value=np.inf,
        limit=1.0,
        unit="",
        passed=False,
        how=f"{what[:1].upper()}{what[1:]} did not succeed: {again.status.value}.",
        worst=what,
    )
