"""Values and first derivatives of a program's functions, as tapes.

They are made of expressions that they share with the program's functions. CasADi lets go of the
interpreter while it differentiates, and counts references in a way that does not survive two
threads at one expression: so they are made once, before threads share a family of programs.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca

from skyknot.kernel.functions import Functions
from skyknot.kernel.tape import Tape


@dataclass(frozen=True, eq=False)
class Slopes:
    """Tapes with first derivatives, dense.

    Attributes
    ----------
    point : (x, u, q, τ, p) → (L, F, g, ∂L, ∂F, ∂g) with Jacobians over y = (x, u, q)
    terminal : (x, q, p) → (M, ∂M) with the gradient over (x, q)
    """

    point: Tape
    terminal: Tape


@lru_cache(maxsize=32)
def slopes_of(functions: Functions) -> Slopes:
    """Return the tapes of a program's functions; the same where they are written alike."""
    point, terminal = functions.point, functions.terminal
    inputs = _symbols(point)
    values = [ca.densify(value) for value in point(*inputs)]
    y = ca.vertcat(*inputs[:3])
    jacobians = [ca.densify(ca.jacobian(e, y)) for e in values]
    first_order = ca.Function("first_order", inputs, ca.cse([*values, *jacobians]))
    ends = _symbols(terminal)
    M = ca.densify(terminal(*ends))
    slope = ca.densify(ca.gradient(M, ca.vertcat(*ends[:2])))
    return Slopes(Tape(first_order), Tape(ca.Function("terminal", ends, [M, slope])))


def _symbols(function: ca.Function) -> list[ca.SX]:
    names = range(function.n_in())
    return [ca.SX.sym(function.name_in(i), *function.size_in(i)) for i in names]
