"""The limits a certificate holds a trajectory to, with the reason for each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from skyknot.errors import UserError


@dataclass(frozen=True)
class Limits:
    """Limits of all checks; shares are relative to the size of the quantity concerned.

    Attributes
    ----------
    feasibility : at the points the scheme itself sees: bounds, ends, constraints, defects. In the
        user's units for quantities up to 1, relative to their size above: the tolerance that
        solvers are asked for by default.
    clearance : metres by which a length (unit "m") may pass its limit between nodes. One centimetre
        lies below the error of any positioning system flown outdoors.
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
