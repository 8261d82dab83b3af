"""The solvers by name."""

from __future__ import annotations

from collections.abc import Callable

from skyknot.solvers.base import Solver
from skyknot.solvers.interior_point import InteriorPoint
from skyknot.solvers.ipopt import Ipopt

SOLVERS: dict[str, Callable[..., Solver]] = {
    "interior-point": InteriorPoint,
    "ipopt": Ipopt,
}
