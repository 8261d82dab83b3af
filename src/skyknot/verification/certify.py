"""certify(problem, trajectory) -> Certificate: every check of the list, in order."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.verification import (
    costates,
    curvature,
    ends,
    flight,
    guarantee,
    hamiltonian,
    motion,
    optimality,
    rate_limits,
    room,
)
from skyknot.verification.base import Check
from skyknot.verification.certificate import Certificate
from skyknot.verification.evidence import Evidence
from skyknot.verification.tolerances import Limits
from skyknot.witness import Witness

CHECKS: tuple[Callable[[Evidence, Limits], Check | None], ...] = (
    ends.horizon,
    ends.ends,
    ends.points,
    room.state_bounds,
    room.control_bounds,
    room.path,
    rate_limits.rates,
    motion.defects,
    motion.interpolant,
    room.states_between,
    room.controls_between,
    room.path_between,
    guarantee.guarantee,
    motion.dynamics_between,
    flight.flight,
    flight.arrival,
    flight.feedback,
    flight.perturbed,
    optimality.stationarity,
    optimality.signs,
    optimality.complementarity,
    costates.costates,
    costates.costate_equation,
    costates.transversality,
    hamiltonian.constancy,
    hamiltonian.minimum,
    curvature.second_order,
    room.saturation,
)
"""All checks in the order of the table: what was asked, equations, between the nodes, flown."""


def certify(
    problem: Problem,
    trajectory: Trajectory,
    parameters: Mapping[str, float] | None = None,
    limits: Limits | None = None,
    witness: Witness | None = None,
) -> Certificate:
    """Return the certificate of a trajectory, whoever computed it.

    Everything is recomputed from the problem's callables; nothing is taken from a solver.

    Parameters
    ----------
    problem : what was asked
    trajectory : states (N+1, nx), controls (N+1, nu) and the interpolant between the nodes; without
        segment data it is read as linear between nodes
    parameters : values of the free parameters found; the problem's own where left out; others are
        not taken from here
    limits : limits other than the defaults of the vehicle's class
    witness : the scheme's rows and the multipliers, as the solution claims them; without it
        nothing is said about optimality

    Raises
    ------
    UserError
        When the trajectory's columns do not fit the problem.
    """
    evidence = Evidence(problem, trajectory, parameters or {}, witness)
    chosen = limits or Limits.of(problem.vehicle)
    with np.errstate(all="ignore"):  # what is not a number is a failed check, not a warning
        found = [check(evidence, chosen) for check in CHECKS]
    checks = {check.name: check for check in found if check is not None}
    return Certificate(problem.name, checks, _notes(evidence))


def _notes(evidence: Evidence) -> tuple[str, ...]:
    """Return a sentence for everything that could not be judged."""
    witness, adjoint = evidence.witness, evidence.adjoint
    if witness is None:
        return ("Optimality was not checked: the answer came without multipliers.",)
    notes = []
    if adjoint is None:
        notes.append("Costates were not checked: the answer claims none.")
    flat = ", ".join(adjoint.flat_controls) if adjoint is not None else ""
    if witness.gains is None:
        notes.append("Not flown with feedback: the answer carries no gains.")
    elif flat:
        notes.append(f"Not flown with feedback: the cost does not curve in {flat}.")
    if flat:
        notes.append(f"Second order was not judged: the cost does not curve in {flat}.")
    reason = hamiltonian.unjudged(evidence)
    if reason:
        notes.append(f"The minimum principle was not checked: {reason}.")
    return tuple(notes)
