"""certify(problem, trajectory) -> Certificate: every check of the list, in order."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.verification import (
    costates,
    ends,
    flight,
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
    motion.dynamics_between,
    flight.flight,
    flight.arrival,
    optimality.stationarity,
    optimality.signs,
    optimality.complementarity,
    costates.costates,
    costates.costate_equation,
    costates.transversality,
    hamiltonian.constancy,
    hamiltonian.minimum,
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
    parameters : values of the free parameters found; the problem's own where left out
    limits : limits other than the defaults
    witness : the scheme's rows and the multipliers, as the solution claims them; without it
        nothing is said about optimality

    Raises
    ------
    UserError
        When the trajectory's columns do not fit the problem.
    """
    evidence = Evidence(problem, trajectory, parameters or {}, witness)
    chosen = limits or Limits()
    found = [check(evidence, chosen) for check in CHECKS]
    checks = {check.name: check for check in found if check is not None}
    return Certificate(problem.name, checks, _notes(witness))


def _notes(witness: Witness | None) -> tuple[str, ...]:
    if witness is None:
        return ("Optimality was not checked: the answer came without multipliers.",)
    return ()
