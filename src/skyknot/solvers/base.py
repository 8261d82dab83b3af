"""HOW a program is solved. Solvers know no flight and no scheme names.

Duties of whoever adds a solver:
1. Take a Program, a tolerance, an optional start of multipliers and an optional callback; give a
   SolverResult. Never raise for a numerical failure: that is a result with a status.
2. Call ``callback(record)`` once an iteration; stop with status INTERRUPTED when it returns True.
3. Return the best iterate when failing, and name in ``detail`` the variable or constraint at fault.
4. Return multipliers signed as in kernel/program.py, of the separated program.
5. Refuse by name, with a UserError, what the solver cannot handle, before iterating.
6. Register the class in ``solvers/__init__.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.program import Multipliers, Program
from skyknot.status import Status

Array = NDArray[np.float64]


class IterationRecord(NamedTuple):
    """One line of a solve's history.

    Attributes
    ----------
    iteration : count, from 0
    objective : value of the objective
    primal_infeasibility : largest constraint violation
    dual_infeasibility : largest entry of the Lagrangian's gradient
    barrier : barrier parameter (0 where the solver has none)
    step : accepted primal step length
    regularisation : multiple of the identity added to the Hessian
    """

    iteration: int
    objective: float
    primal_infeasibility: float
    dual_infeasibility: float
    barrier: float = 0.0
    step: float = 0.0
    regularisation: float = 0.0


Callback = Callable[[IterationRecord], bool | None]


@dataclass(frozen=True)
class SolverResult:
    """What a solver returns.

    Attributes
    ----------
    z : decision vector
    multipliers : signed as in kernel/program.py
    status : how it ended
    iterations : number of iterations
    history : one record an iteration
    work : counts, e.g. evaluations and factorisations
    detail : names the variable or constraint at fault; empty on success
    gains : feedback gains, (N, nu, nx) of held controls, (N+1, nu, nx) at the nodes of others
    barrier : last barrier parameter, for warm starts
    """

    z: Array
    multipliers: Multipliers
    status: Status
    iterations: int
    history: tuple[IterationRecord, ...] = ()
    work: dict[str, int] = field(default_factory=dict)
    detail: str = ""
    gains: Array | None = None
    barrier: float = 0.0


class Solver(Protocol):
    """The contract of this room; see the module's numbered duties."""

    @property
    def name(self) -> str:
        """What users call the solver."""

    def solve(
        self,
        program: Program,
        tolerance: float,
        multipliers: Multipliers | None = None,
        callback: Callback | None = None,
    ) -> SolverResult:
        """Solve the program to ``tolerance``."""
