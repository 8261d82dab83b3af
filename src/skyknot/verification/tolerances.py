"""The limits a certificate holds a trajectory to, with the reason for each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from skyknot.errors import UserError

CLASSES: dict[str, dict[str, float]] = {
    "small": {},
    "passenger": {"clearance": 0.1, "flight_rms": 0.1},
}
"""What differs by class of vehicle (``models.vehicle.KINDS``). A craft that carries people measures
ten metres and more across, flies in airspace that is surveyed to a decimetre, and moves through
states ten times as large."""


@dataclass(frozen=True)
class Limits:
    """Limits of all checks; shares are relative to the size of the quantity concerned.

    Attributes
    ----------
    feasibility : at the points the scheme itself sees: bounds, ends, constraints, defects. In the
        user's units for quantities up to 1, relative to their size above: the tolerance that
        solvers are asked for by default.
    clearance : metres by which a length (unit "m") may pass its limit between nodes. One centimetre
        lies below the error of any positioning system flown outdoors. What is proved instead of
        sampled may be a tenth more, for the room that the proof needs.
    between_nodes : share of its room by which any other state or constraint on states may pass its
        limit between nodes. One per cent is the accuracy to which such limits are known.
    control_excess : share of its room by which a control passes its bounds, averaged over the
        horizon. The average, because a polynomial through a jump overshoots by an eighth of the
        room on any mesh, for a time that shrinks with the mesh; what counts is the impulse that
        the actuator does not give.
    dynamics : integral of |dx/dt − f| over one segment, relative to the size of the state. One
        thousandth keeps a hundred segments of equal sign below ten per cent.
    flight_rms : limit of equation (26) of the source report, in state units.
    optimality : optimality conditions of the finite program: slopes of the Lagrangian relative to
        the largest of 1 and the terms they sum, products of multipliers and distances relative to
        the largest of 1 and the objective. Ten times the tolerance that solvers are asked for by
        default: they measure in units of their own.
    costate : change of a costate over one segment against its equation, relative to its largest
        value. The finite program's multipliers follow the continuous costate only as closely as
        the mesh does, worst where a control switches inside a segment; one twentieth in one
        segment is what a mesh leaves whose flight passes.
    hamiltonian : mean deviation of the Hamiltonian from its constant, relative to the largest sum
        of its terms. Limited by the mesh as the costates are; more than two per cent and the
        answer is no extremal of the continuous problem.
    minimum : what the controls cost above the pointwise least Hamiltonian, integrated, relative to
        the largest of 1 and the objective: to first order, the part of the cost that better
        controls could save.
    curvature : negative curvature of the Lagrangian along directions that keep the constraints,
        relative to the largest curvature of the same controls: below it rounding decides.
    closed_loop : share of its size by which a state may miss its end when flown with the
        solution's own feedback from its own start. As for ``arrival``.
    perturbed : the same from starts that are half a per cent off: feedback that makes more than ten
        times as much of it at the end does not hold the flight.
    arrival : share of its size by which a state may miss its end when flown open loop: the upper
        end of the "1–2 %" of section 5.4 of the source report.

    Raises
    ------
    UserError
        When a limit is not a positive number.
    """

    feasibility: float = 1e-6
    clearance: float = 0.01
    between_nodes: float = 0.01
    control_excess: float = 0.01
    dynamics: float = 1e-3
    flight_rms: float = 0.02
    arrival: float = 0.02
    optimality: float = 1e-5
    costate: float = 0.05
    hamiltonian: float = 0.02
    minimum: float = 0.01
    curvature: float = 1e-6
    closed_loop: float = 0.02
    perturbed: float = 0.05

    @classmethod
    def of(cls, vehicle: object, **given: float) -> Limits:
        """Return the limits of a vehicle's class, some of them given; of a small one for None.

        Parameters
        ----------
        vehicle : anything with a ``kind``, one of ``CLASSES``
        given : limits by name that replace the defaults
        """
        kind = getattr(vehicle, "kind", "small")
        return cls(**(CLASSES.get(kind, {}) | given))

    def __post_init__(self) -> None:
        for name in self.__dataclass_fields__:
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise UserError(
                    "A limit of the certificate must be positive.",
                    where=f"limits.{name}",
                    found=value,
                    expected="a finite number greater than zero",
                    do="Leave it out for the default.",
                )
