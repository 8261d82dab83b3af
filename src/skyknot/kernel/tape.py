"""A CasADi function of one point, compiled to the kernel's tape and run over lanes of points.

The instruction list of an SX function is read once. The native tape then works every instruction
on 8 points at a time in vector registers, without the GIL.

Arithmetic agrees with CasADi to the bit. Sine, cosine, tangent, exponential, logarithm and
hyperbolic tangent are the tape's own, within 2 units in the last place; the rest is the C library.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from types import ModuleType
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from skyknot.errors import UserError
from skyknot.kernel import native

Array = NDArray[np.float64]

OPERATIONS: dict[int, str] = {
    **{
        getattr(ca, f"OP_{name.upper()}"): name
        for name in (
            *("assign", "input", "output", "add", "sub", "mul", "div", "neg", "sq", "twice"),
            *("inv", "sqrt", "fabs", "floor", "ceil", "fmin", "fmax", "sign", "copysign"),
            *("lt", "le", "eq", "ne", "if_else_zero", "sin", "cos", "tan", "exp", "log", "tanh"),
            *("pow", "asin", "acos", "atan", "atan2", "sinh", "cosh", "asinh", "acosh", "atanh"),
            *("fmod", "remainder", "hypot", "erf", "erfinv", "log1p", "expm1"),
        )
    },
    ca.OP_CONST: "constant",
    ca.OP_NOT: "not_",
    ca.OP_AND: "and_",
    ca.OP_OR: "or_",
    ca.OP_CONSTPOW: "pow",
    ca.OP_LIFT: "assign",  # x, with a hint for another solver's start
    ca.OP_PRINTME: "assign",  # x, printed by CasADi's own machine only
}
"""CasADi's operation codes and the tape's names for them."""


class Tape:
    """An SX function of one point, ready to be evaluated at many.

    Parameters
    ----------
    function : casadi.Function
        Made of SX expressions (``MXFunction.expand()`` gives one). Any number of inputs and
        outputs; of sparse ones only the non-zeros are seen, column by column as in CasADi.
    module : module
        The build of the native kernel to use; the one picked for this processor unless told.

    Attributes
    ----------
    native : the native tape, for other parts of the kernel
    input_offsets : (inputs + 1,) where each input begins among all input non-zeros
    output_offsets : (outputs + 1,) the same for outputs

    Raises
    ------
    UserError
        If the function is not made of SX expressions, or uses an operation the tape cannot do.
    """

    def __init__(self, function: ca.Function, module: ModuleType = native) -> None:
        if not function.is_a("SXFunction"):
            raise UserError(
                "The kernel evaluates functions of SX expressions only.",
                where=f"function {function.name()}",
                found=function.class_name(),
                expected="SXFunction",
                do="build the function from casadi.SX symbols, or call expand() on it",
            )
        self.function = function
        self.input_offsets = _offsets([function.nnz_in(i) for i in range(function.n_in())])
        self.output_offsets = _offsets([function.nnz_out(i) for i in range(function.n_out())])
        self._inputs = list(pairwise(self.input_offsets.tolist()))
        self._outputs = list(pairwise(self.output_offsets.tolist()))
        listing = _read(function, self.input_offsets, self.output_offsets)
        codes = module.operation_codes()
        self.native = module.Tape(
            np.array([codes[name] for name in listing.operations], dtype=np.uint32),
            *(np.array(column, dtype=np.uint32) for column in listing[1:4]),
            np.array(listing.constants, dtype=np.float64),
            int(self.input_offsets[-1]),
            int(self.output_offsets[-1]),
        )

    def evaluate(self, inputs: Sequence[ArrayLike]) -> list[Array]:
        """Evaluate the function at P points.

        Parameters
        ----------
        inputs : one (P, non-zeros) array for each input of the function

        Returns
        -------
        list of (P, non-zeros) arrays, one for each output of the function

        Raises
        ------
        ValueError
            If the arrays do not fit the function's inputs or disagree on P.
        """
        arrays = [np.asarray(value, dtype=np.float64) for value in inputs]
        points = len(arrays[0]) if arrays and arrays[0].ndim else 0
        if [array.shape for array in arrays] != [(points, b - a) for a, b in self._inputs]:
            sizes, shapes = [b - a for a, b in self._inputs], [array.shape for array in arrays]
            raise ValueError(f"inputs of shapes (P, {sizes}) expected, found {shapes}")
        packed = np.concatenate(arrays, axis=1)
        results = np.empty((points, self._outputs[-1][1]))
        self.native.evaluate_points(packed, results)
        return [results[:, a:b] for a, b in self._outputs]


class _Listing(NamedTuple):
    operations: list[str]
    results: list[int]
    first: list[int]
    second: list[int]
    constants: list[float]


def _offsets(sizes: Sequence[int]) -> NDArray[np.intp]:
    return np.concatenate([[0], np.cumsum(sizes, dtype=np.intp)]).astype(np.intp)


def _read(
    function: ca.Function, input_offsets: NDArray[np.intp], output_offsets: NDArray[np.intp]
) -> _Listing:
    """Return the function's instructions with inputs and outputs numbered by their non-zeros."""
    listing = _Listing([], [], [], [], [])
    for k in range(function.n_instructions()):
        name = _operation_name(function, function.instruction_id(k))
        operands = function.instruction_input(k)
        results = function.instruction_output(k)
        constant = 0.0
        if name == "input":
            operands = [input_offsets[operands[0]] + operands[1]]
        elif name == "output":
            results = [output_offsets[results[0]] + results[1]]
        elif name == "constant":
            constant = function.instruction_constant(k)
        listing.operations.append(name)
        listing.results.append(results[0])
        listing.first.append(operands[0] if operands else 0)
        listing.second.append(operands[1] if len(operands) > 1 else 0)
        listing.constants.append(constant)
    return listing


def _operation_name(function: ca.Function, code: int) -> str:
    if code in OPERATIONS:
        return OPERATIONS[code]
    names = [name for name in dir(ca) if name.startswith("OP_") and getattr(ca, name) == code]
    raise UserError(
        "The kernel cannot do one of the function's operations.",
        where=f"function {function.name()}",
        found=", ".join(names) or f"operation {code}",
        expected="the elementary operations of casadi.SX",
        do="write the expression with elementary operations, or use the Ipopt solver",
    )
