"""The solvers by name."""

from __future__ import annotations

from collections.abc import Callable

from skyknot.solvers.base import Solver
from skyknot.solvers.interior_point import InteriorPoint
from skyknot.solvers.ipopt import Ipopt
from skyknot.solvers.projected_gradient import ProjectedGradient

SOLVERS: dict[str, Callable[..., Solver]] = {
    "interior-point": InteriorPoint,
    "ipopt": Ipopt,
    "projected-gradient": ProjectedGradient,
}
