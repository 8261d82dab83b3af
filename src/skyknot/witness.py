"""What an answer brings to be judged by: its scheme and its multipliers, as plain numbers.

Legend: N segments with s state points and m control values each, r = s − 1 rows of the scheme, nx
states, nu controls, ng constraints (path, then point), R rate rows, nq globals (a free duration,
then free parameters).

The finite program that the numbers belong to reads
    minimise    T Σ_kj w_kj ℓ(x_kj, u_kj) + M(x_N)
    subject to  Σ_j C_ij x_kj + h_k Σ_j A_ij f(x_kj, u_kj) = 0         (row i of segment k)
                g(x_kj, u_kj), states, controls, rates and globals within their bounds
with L = objective + λᵀ defects + μᵀ g + ρᵀ rates + ζᵀ z; μ, ρ and ζ are positive at an upper bound
and negative at a lower one. A point shared by two segments carries its multipliers once: with the
segment it begins; in the other they are zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Offsets = NDArray[np.intp]


@dataclass(frozen=True)
class Witness:
    """Scheme and multipliers of one answer; nothing in here computes.

    Attributes
    ----------
    points : (s,) places τ of the state points
    C, A : (r, s) rows of the scheme
    weights : (N, s) weights w of the running cost, shares of the horizon
    control_points : (m,) places τ of the control values
    shared : whether the first and last control value belong to the nodes
    defects : (N, r, nx) λ
    path : (N, s, ng) μ
    state_bounds : (N, s, nx), control_bounds : (N, m, nu), global_bounds : (nq,) ζ
    rates : (R,) ρ, of lower ≤ Σ weight · value / (T span) ≤ upper
    rate_values : (R, w) which control values a row reads: positions in (N, m, nu), flattened
    rate_weights : (R, w)
    rate_spans : (R,) length of the row's base, share of the horizon
    costates : (N+1, nx) at the nodes; None where none are claimed
    gains : (N+1, nu, nx) feedback gains at the nodes, or (N, nu, nx) of held controls; None where
        the solver has none
    """

    points: Array
    C: Array
    A: Array
    weights: Array
    control_points: Array
    shared: bool
    defects: Array
    path: Array
    state_bounds: Array
    control_bounds: Array
    global_bounds: Array
    rates: Array
    rate_values: Offsets
    rate_weights: Array
    rate_spans: Array
    costates: Array | None = None
    gains: Array | None = None
