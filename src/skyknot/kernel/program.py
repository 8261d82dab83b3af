"""The finite program: what a transcription builds and every solver solves.

Legend: N segments, s state points and m control values in a segment, P evaluated points, nx states,
nu controls, nq globals q (free duration, free parameters), p parameters that are given, ng path
rows, T duration.

    minimise    Σ_j c_j L(x_j, u_j, q; τ_j) + M(x_N, q)
    subject to  Σ_j C_ij x_kj + δ_k Σ_j A_ij F(x_kj, u_kj, q; τ_kj) = 0  (defects, row i, segment k)
                path_lower ≤ g(x_j, u_j, q; τ_j) ≤ path_upper               (at each point)
                δ_k T rate_lower ≤ D_k U_k ≤ δ_k T rate_upper               (rows on control values)
                lower ≤ z ≤ upper
with L = T ℓ and F = T f, so that the segment lengths δ_k are fractions of the horizon and the
duration enters only through the point functions. L, F, g and M read p as well.

Multipliers follow L = objective + λᵀ defects + μᵀ g + ρᵀ rates + ζᵀ z with μ, ρ, ζ positive at
an upper bound and negative at a lower one.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.kernel.functions import Functions
from skyknot.kernel.incidence import Chosen, Incidence
from skyknot.kernel.layout import Layout
from skyknot.kernel.slopes import Slopes, slopes_of

Array = NDArray[np.float64]
Offsets = NDArray[np.intp]

ALL = slice(None)


@dataclass(frozen=True)
class RateRows:
    """Bounds on du/dt: rows over control values, lower·T·length ≤ Σ weight·u ≤ upper·T·length.

    Attributes
    ----------
    positions : (R, w) positions in z, weights : (R, w) their coefficients
    length : (R,) length of the row's base as a fraction of the horizon
    lower, upper : (R,) bounds on the rate, control unit per second
    names : (R,) control concerned
    """

    positions: Offsets
    weights: Array
    length: Array
    lower: Array
    upper: Array
    names: tuple[str, ...]


@dataclass(frozen=True)
class Multipliers:
    """Multipliers of a program, signed as in the module's legend.

    Attributes
    ----------
    defects : (N, s−1, nx), path : (P, ng), rates : (R,), bounds : (size,)
    """

    defects: Array
    path: Array
    rates: Array
    bounds: Array


@dataclass(frozen=True)
class Program:
    """A transcribed problem; see the module's legend.

    Attributes
    ----------
    parametric_point : CasADi function (x, u, q, τ, p) → (L, F, g)
    parametric_terminal : CasADi function (x, q, p) → M
    parameters : (np,) values of p, named ``parameter_names``
    C, A : scheme rows; A has one column per *evaluated* point of a segment
    control_weights : (s_used, m) control at evaluated point = Σ weight · control value
    shared : whether first and last control value belong to the nodes
    fractions : (N,) segment lengths δ_k
    segment_points : (N, s_used) index of the evaluated points of each segment
    used : (s_used,) which state points of a segment are evaluated
    point_state : (P,) offset of x in z, point_control : (P, m) offsets of control values,
    point_weights : (P, m), point_time : (P,) τ_j
    segment_cost : (N, s_used) share of each segment in the cost weights c_j of its points
    compressed : whether interior states are eliminated before a general solver sees them
    duration : fixed T, or None when T is q[0]
    """

    name: str
    state_names: tuple[str, ...]
    control_names: tuple[str, ...]
    global_names: tuple[str, ...]
    path_names: tuple[str, ...]
    parameter_names: tuple[str, ...]
    parametric_point: ca.Function
    parametric_terminal: ca.Function
    parameters: Array
    C: Array
    A: Array
    control_weights: Array
    control_points: Array
    shared: bool
    fractions: Array
    used: Offsets
    segment_points: Offsets
    point_state: Offsets
    point_control: Offsets
    point_weights: Array
    point_time: Array
    segment_cost: Array
    layout: Layout
    lower: Array
    upper: Array
    path_lower: Array
    path_upper: Array
    rates: RateRows
    start: Array
    scales: Array
    compressed: bool
    duration: float | None

    @property
    def sizes(self) -> tuple[int, int, int, int]:
        """(nx, nu, nq, ng)."""
        return self.layout.nx, self.layout.nu, self.layout.nq, len(self.path_names)

    @property
    def segments(self) -> int:
        """N."""
        return len(self.fractions)

    @cached_property
    def point(self) -> ca.Function:
        """(x, u, q, τ) → (L, F, g) at the program's parameters."""
        return _at(self.parametric_point, self.parameters)

    @cached_property
    def terminal(self) -> ca.Function:
        """(x, q) → M at the program's parameters."""
        return _at(self.parametric_terminal, self.parameters)

    @cached_property
    def incidence(self) -> Incidence:
        """Which entries of z the parts of the program read."""
        return Incidence.of(self)

    @cached_property
    def slopes(self) -> Slopes:
        """Values and first derivatives of the point functions, as tapes."""
        return slopes_of(self.functions)

    @cached_property
    def functions(self) -> Functions:
        """The functions, as they are known again."""
        return Functions.of(self.parametric_point, self.parametric_terminal)

    @property
    def point_cost(self) -> Array:
        """(P,) cost weights c_j."""
        return self.incidence.point_cost

    def point_states(self, z: Array, points: Chosen = ALL) -> Array:
        """Return (P, nx) states of the evaluated points, or of some of them."""
        return z[self.incidence.point_states[points]]

    def point_controls(self, z: Array, points: Chosen = ALL) -> Array:
        """Return (P, nu) controls of the evaluated points, or of some of them."""
        values = z[self.incidence.point_controls[points]]
        result: Array = np.einsum("pm,pmu->pu", self.point_weights[points], values)
        return result

    def globals_of(self, z: Array) -> Array:
        """Return (nq,) globals."""
        return z[self.incidence.globals]

    def duration_of(self, z: Array) -> float:
        """Return T, s."""
        return self.duration if self.duration is not None else float(z[self.layout.globals])

    def with_numbers(self, **numbers: Array) -> Program:
        """Return the same program with other bounds, start or parameters, by field."""
        for made_once in ("incidence", "slopes", "functions"):
            getattr(self, made_once)
        other = copy.copy(self)
        other.__dict__.update(numbers)
        for of_parameters in ("point", "terminal"):
            other.__dict__.pop(of_parameters, None)
        return other

    def starting_at(self, z: Array) -> Program:
        """Return the same program with another start."""
        return self.with_numbers(start=z)

    def with_parameters(self, values: Array) -> Program:
        """Return the same program at other parameters, (np,)."""
        return self.with_numbers(parameters=values)

    def empty_multipliers(self) -> Multipliers:
        """Return zero multipliers of the right shapes."""
        nx, _, _, ng = self.sizes
        return Multipliers(
            np.zeros((self.segments, len(self.C), nx)),
            np.zeros((len(self.point_state), ng)),
            np.zeros(len(self.rates.length)),
            np.zeros(self.layout.size),
        )

    def variable_name(self, position: int) -> str:
        """Return what stands at a position of z, in the user's words, e.g. 'vz at 1.25 (node)'."""
        layout = self.layout
        if position >= layout.globals:
            return self.global_names[position - layout.globals]
        starts = np.concatenate([layout.state.ravel(), layout.control.ravel()])
        first = starts[starts <= position].max()
        inside = position - first
        if np.any(layout.state == first):
            k, j = np.argwhere(layout.state == first)[0]
            return f"{self.state_names[inside]} in segment {k + (j == len(self.C))}"
        k = int(np.argwhere(layout.control == first)[0][0])
        return f"{self.control_names[inside]} in segment {k}"


def _at(function: ca.Function, parameters: Array) -> ca.Function:
    """Return a function without its last input, which takes these values."""
    inputs = [
        ca.SX.sym(function.name_in(i), *function.size_in(i)) for i in range(function.n_in() - 1)
    ]
    return ca.Function(function.name(), inputs, function.call([*inputs, ca.SX(parameters)]))
