"""Every operation a tape can hold, written so that CasADi really emits it."""

from __future__ import annotations

import casadi as ca
import numpy as np

UNARY = {
    "OP_NEG": lambda x: -x,
    "OP_SQ": lambda x: x**2,
    "OP_TWICE": lambda x: x + x,
    "OP_INV": lambda x: 1 / x,
    "OP_SQRT": ca.sqrt,
    "OP_FABS": ca.fabs,
    "OP_FLOOR": ca.floor,
    "OP_CEIL": ca.ceil,
    "OP_SIGN": ca.sign,
    "OP_NOT": ca.logic_not,
    "OP_CONSTPOW": lambda x: x**1.7,
    "OP_ASIN": ca.asin,
    "OP_ACOS": ca.acos,
    "OP_ATAN": ca.atan,
    "OP_SINH": ca.sinh,
    "OP_COSH": ca.cosh,
    "OP_ASINH": ca.asinh,
    "OP_ACOSH": ca.acosh,
    "OP_ATANH": ca.atanh,
    "OP_ERF": ca.erf,
    "OP_LOG1P": ca.log1p,
    "OP_EXPM1": ca.expm1,
    "OP_CONST": lambda x: x * -2.5,
}
BINARY = {
    "OP_ADD": lambda x, y: x + y,
    "OP_SUB": lambda x, y: x - y,
    "OP_MUL": lambda x, y: x * y,
    "OP_DIV": lambda x, y: x / y,
    "OP_POW": lambda x, y: x**y,
    "OP_LT": lambda x, y: x < y,
    "OP_LE": lambda x, y: x <= y,
    "OP_EQ": lambda x, y: x == y,
    "OP_NE": lambda x, y: x != y,
    "OP_AND": ca.logic_and,
    "OP_OR": ca.logic_or,
    "OP_FMOD": ca.fmod,
    "OP_REMAINDER": ca.remainder,
    "OP_COPYSIGN": ca.copysign,
    "OP_IF_ELSE_ZERO": lambda x, y: ca.if_else(x, y, 0),
    "OP_FMIN": ca.fmin,
    "OP_FMAX": ca.fmax,
    "OP_ATAN2": ca.atan2,
    "OP_HYPOT": ca.hypot,
}
"""What the tape must evaluate exactly as CasADi does."""

OWN = {
    "OP_SIN": (np.sin, 1.0),
    "OP_COS": (np.cos, 1.0),
    "OP_TAN": (np.tan, 2.5),
    "OP_EXP": (np.exp, 1.0),
    "OP_LOG": (np.log, 1.0),
    "OP_TANH": (np.tanh, 1.5),
}
"""What the tape evaluates by itself: reference in any precision, error allowed in ulp."""

EDGES = np.array(
    [
        *(0.0, 5e-324, 1e-310, 1e-16, 1e-8, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 2.5, 3.7, 10.0, 22.5),
        *(709.7, 711.0, 746.0, 999999.9, 1e6, 1e15, 1e22, 1e300, np.inf, np.nan),
    ]
)
EDGES = np.concatenate([EDGES, -EDGES])


def all_pairs(values):
    """Return every ordered pair of the values, as two (P, 1) columns."""
    first, second = np.meshgrid(values, values)
    return [first.reshape(-1, 1), second.reshape(-1, 1)]


def function_of(expression, operands):
    """Return the CasADi function of so many scalars and the operations it uses."""
    symbols = [ca.SX.sym(name) for name in "xyzw"[:operands]]
    function = ca.Function("sample", symbols, [expression(*symbols)])
    codes = {function.instruction_id(k) for k in range(function.n_instructions())}
    return function, codes


def by_casadi(function, columns):
    """Return CasADi's own values, one (P, non-zeros) array for each output."""
    points = len(columns[0])
    results = [[] for _ in range(function.n_out())]
    for p in range(points):
        values = function.call([ca.DM(column[p]) for column in columns])
        for result, value in zip(results, values, strict=True):
            result.append(value.nonzeros())
    return [np.array(result) for result in results]
