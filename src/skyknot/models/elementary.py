"""Sine and cosine of whatever arrives: CasADi entries, numbers or arrays, real or complex."""

from __future__ import annotations

import casadi
import numpy as np

from skyknot.models.base import Expression


def is_casadi(value: object) -> bool:
    """Return whether the value is a CasADi SX, MX or DM."""
    return isinstance(value, casadi.SX | casadi.MX | casadi.DM)


def sine(angle: Expression) -> Expression:
    """Return the sine of an angle in radians, of the type that came in."""
    return casadi.sin(angle) if is_casadi(angle) else np.sin(angle)


def cosine(angle: Expression) -> Expression:
    """Return the cosine of an angle in radians, of the type that came in."""
    return casadi.cos(angle) if is_casadi(angle) else np.cos(angle)


def linear_combination(coefficients: list[float], components: list[Expression]) -> Expression:
    """Return the sum of coefficient times component, leaving out zero coefficients.

    Zeros are left out so that CasADi expressions carry no dead operations.
    """
    total: Expression = 0.0
    for coefficient, component in zip(coefficients, components, strict=True):
        if coefficient != 0.0:
            total = total + coefficient * component
    return total
