"""Interval arithmetic on the instruction list of a CasADi function, over many boxes at once.

Legend: an interval is a pair (lower, upper) of arrays (M,); M boxes are enclosed side by side.
Every result is rounded outwards by one unit in the last place, elementary functions by four, so
that an enclosure holds in floating point too (Moore, Kearfott & Cloud, Introduction to Interval
Analysis, 2009).
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Interval = tuple[Array, Array]

HALF_TURN = np.pi
LAST_PLACES = 4
"""Units in the last place that elementary functions of the C library may be off."""


def enclosed(function: ca.Function, lower: list[Array], upper: list[Array]) -> list[Interval]:
    """Return enclosures of all outputs over M boxes.

    Parameters
    ----------
    function : of SX columns, expanded
    lower, upper : one array (M, n) for each input of n entries

    Returns
    -------
    one interval of arrays (M, n) for each output of n entries

    Raises
    ------
    NotImplementedError
        When an operation has no interval form here; the message names it.
    """
    M = len(lower[0])
    work: list[Interval] = [(np.zeros(M), np.zeros(M))] * function.sz_w()
    found = [
        (np.zeros((M, function.numel_out(i))), np.zeros((M, function.numel_out(i))))
        for i in range(function.n_out())
    ]
    with np.errstate(all="ignore"):
        for k in range(function.n_instructions()):
            operation = function.instruction_id(k)
            into, take = function.instruction_output(k), function.instruction_input(k)
            if operation == ca.OP_CONST:
                value = np.full(M, function.instruction_constant(k))
                work[into[0]] = (value, value)
            elif operation == ca.OP_INPUT:
                work[into[0]] = (lower[take[0]][:, take[1]], upper[take[0]][:, take[1]])
            elif operation == ca.OP_OUTPUT:
                found[into[0]][0][:, into[1]], found[into[0]][1][:, into[1]] = work[take[0]]
            else:
                work[into[0]] = _known(_applied(operation, [work[i] for i in take]))
    return found


def _applied(operation: int, x: list[Interval]) -> Interval:
    if operation in EXACT:
        return _widened(EXACT[operation](*x), 1)
    if operation in ELEMENTARY:
        return _widened(ELEMENTARY[operation](*x), LAST_PLACES)
    raise NotImplementedError(f"CasADi operation {operation}")


def _widened(x: Interval, places: int) -> Interval:
    lower, upper = x
    if places == 1:
        return np.nextafter(lower, -np.inf), np.nextafter(upper, np.inf)
    spread = places * np.finfo(float).eps
    tiny = np.finfo(float).tiny
    return lower - spread * np.abs(lower) - tiny, upper + spread * np.abs(upper) + tiny


def _known(x: Interval) -> Interval:
    """Return the interval with everything that is not a number opened to all numbers."""
    lower, upper = x
    return np.where(np.isnan(lower), -np.inf, lower), np.where(np.isnan(upper), np.inf, upper)


def _add(a: Interval, b: Interval) -> Interval:
    return a[0] + b[0], a[1] + b[1]


def _subtract(a: Interval, b: Interval) -> Interval:
    return a[0] - b[1], a[1] - b[0]


def _multiply(a: Interval, b: Interval) -> Interval:
    products = [x * y for x in a for y in b]
    # 0 · ∞ is 0 here: the factor that is zero is zero.
    known = [np.where(np.isnan(p), 0.0, p) for p in products]
    return np.minimum.reduce(known), np.maximum.reduce(known)


def _inverse(a: Interval) -> Interval:
    open_ = (a[0] <= 0) & (a[1] >= 0)
    return np.where(open_, -np.inf, 1 / a[1]), np.where(open_, np.inf, 1 / a[0])


def _divide(a: Interval, b: Interval) -> Interval:
    return _multiply(a, _widened(_inverse(b), 1))


def _square(a: Interval) -> Interval:
    low, high = a[0] ** 2, a[1] ** 2
    inside = (a[0] <= 0) & (a[1] >= 0)
    return np.where(inside, 0.0, np.minimum(low, high)), np.maximum(low, high)


def _magnitude(a: Interval) -> Interval:
    low, high = np.abs(a[0]), np.abs(a[1])
    inside = (a[0] <= 0) & (a[1] >= 0)
    return np.where(inside, 0.0, np.minimum(low, high)), np.maximum(low, high)


def _rising(function: Callable[[Array], Array]) -> Callable[[Interval], Interval]:
    def enclosure(a: Interval) -> Interval:
        return function(a[0]), function(a[1])

    return enclosure


def _root(a: Interval) -> Interval:
    return np.sqrt(np.maximum(a[0], 0.0)), np.sqrt(np.maximum(a[1], 0.0))


def _power(a: Interval, b: Interval) -> Interval:
    """Return aᵇ for one whole b, and for any b where a is positive."""
    n = float(b[0][0])
    if np.any(b[0] != n) or np.any(b[1] != n):
        logarithm = _widened((np.log(a[0]), np.log(a[1])), LAST_PLACES)
        exponent = _widened(_multiply(b, logarithm), 1)
        return np.exp(exponent[0]), np.exp(exponent[1])
    corners = a[0] ** n, a[1] ** n
    low, high = np.minimum(*corners), np.maximum(*corners)
    across = (a[0] <= 0) & (a[1] >= 0)
    if n != round(n):
        return np.where(a[0] < 0, np.nan, low), np.where(a[0] < 0, np.nan, high)
    if n < 0:
        return np.where(across, -np.inf, low), np.where(across, np.inf, high)
    if round(n) % 2 == 0:
        return np.where(across, 0.0 if n > 0 else 1.0, low), high
    return low, high


def _cosine(a: Interval) -> Interval:
    """Return the cosine: its extremes where a multiple of π lies inside."""
    ends = np.cos(a[0]), np.cos(a[1])
    first = np.ceil(a[0] / HALF_TURN)
    turns = np.floor(a[1] / HALF_TURN) - first
    even = np.mod(first, 2) == 0
    top = (turns >= 1) | ((turns >= 0) & even)
    bottom = (turns >= 1) | ((turns >= 0) & ~even)
    low, high = np.minimum(*ends), np.maximum(*ends)
    wild = ~np.isfinite(a[0]) | ~np.isfinite(a[1])
    return np.where(bottom | wild, -1.0, low), np.where(top | wild, 1.0, high)


def _sine(a: Interval) -> Interval:
    return _cosine(_widened((a[0] - HALF_TURN / 2, a[1] - HALF_TURN / 2), LAST_PLACES))


def _tangent(a: Interval) -> Interval:
    poles = np.floor(a[1] / HALF_TURN - 0.5) != np.floor(a[0] / HALF_TURN - 0.5)
    return np.where(poles, -np.inf, np.tan(a[0])), np.where(poles, np.inf, np.tan(a[1]))


def _angle(y: Interval, x: Interval) -> Interval:
    """Return atan2 where x stays positive; the whole circle elsewhere."""
    corners = [np.arctan2(b, a) for b in y for a in x]
    right = x[0] > 0
    low, high = np.minimum.reduce(corners), np.maximum.reduce(corners)
    return np.where(right, low, -HALF_TURN), np.where(right, high, HALF_TURN)


def _cosh(a: Interval) -> Interval:
    low, high = _magnitude(a)
    return np.cosh(low), np.cosh(high)


def _sign(a: Interval) -> Interval:
    return np.sign(a[0]), np.sign(a[1])


EXACT: dict[int, Callable[..., Interval]] = {
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_ADD: _add,
    ca.OP_SUB: _subtract,
    ca.OP_MUL: _multiply,
    ca.OP_DIV: _divide,
    ca.OP_INV: _inverse,
    ca.OP_NEG: lambda a: (-a[1], -a[0]),
    ca.OP_SQ: _square,
    ca.OP_TWICE: lambda a: (2 * a[0], 2 * a[1]),
    ca.OP_FABS: _magnitude,
    ca.OP_SIGN: _sign,
    ca.OP_SQRT: _root,
    ca.OP_FMIN: lambda a, b: (np.minimum(a[0], b[0]), np.minimum(a[1], b[1])),
    ca.OP_FMAX: lambda a, b: (np.maximum(a[0], b[0]), np.maximum(a[1], b[1])),
}
"""Operations that IEEE arithmetic rounds correctly."""

ELEMENTARY: dict[int, Callable[..., Interval]] = {
    ca.OP_EXP: _rising(np.exp),
    ca.OP_LOG: _rising(np.log),
    ca.OP_SIN: _sine,
    ca.OP_COS: _cosine,
    ca.OP_TAN: _tangent,
    ca.OP_ATAN: _rising(np.arctan),
    ca.OP_ASIN: _rising(np.arcsin),
    ca.OP_ACOS: lambda a: (np.arccos(a[1]), np.arccos(a[0])),
    ca.OP_SINH: _rising(np.sinh),
    ca.OP_COSH: _cosh,
    ca.OP_TANH: _rising(np.tanh),
    ca.OP_ATAN2: _angle,
    ca.OP_POW: _power,
    ca.OP_CONSTPOW: _power,
}
"""Operations of the C library."""
