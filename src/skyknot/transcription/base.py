"""How continuous becomes finite: from a Problem to a Program.

Duties of whoever adds a scheme:
1. Write its row of ``schemes.py``: points, C, A, b, orders, control points, source. The table
   checks itself when it is made. Row i must hold x_{i+1}; a point may lack rate and cost.
2. Write its front door in ``doors.py``: the name users call, with the options that make sense.
3. Nothing else: packing, recovery of trajectory and costates, and every solver follow the table.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.kernel.layout import Layout, node_major
from skyknot.kernel.program import Program
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.transcription.mesh import with_nodes_at
from skyknot.transcription.pointwise import (
    PointFunctions,
    global_names,
    parameter_names,
    parameter_values,
)
from skyknot.transcription.rates import rate_rows
from skyknot.transcription.scales import decision_scales
from skyknot.transcription.table import SchemeTable

Array = NDArray[np.float64]
Offsets = NDArray[np.intp]


@dataclass(frozen=True)
class Transcription:
    """A scheme on a mesh; made by ``HermiteSimpson(segments=100)`` and its siblings.

    Attributes
    ----------
    table : the scheme
    nodes : (N+1,) fractions of the horizon
    controls : control parametrisation, one of the table's: "hold", "linear", "quadratic",
        "polynomial" or "discontinuous"
    form : "separated" (interior states are unknowns) or "compressed" (they are eliminated)
    enforce : "points" bounds states and path at every point of the scheme, "nodes" at nodes only
    objective : "integral" by the scheme's quadrature, or "sum" over nodes 0…N−1 as in equation (10)
    """

    table: SchemeTable
    nodes: Array = field(repr=False)
    controls: str
    form: str = "separated"
    enforce: str = "points"
    objective: str = "integral"

    def __post_init__(self) -> None:
        allowed = {
            "controls": tuple(self.table.control_points),
            "form": ("separated", "compressed"),
            "enforce": ("points", "nodes"),
            "objective": ("integral", "sum"),
        }
        for name, values in allowed.items():
            if getattr(self, name) not in values:
                raise UserError(
                    f"The {self.table.name} scheme does not know this choice.",
                    where=name,
                    found=repr(getattr(self, name)),
                    expected=" or ".join(repr(value) for value in values),
                    do=f"Choose one of the values allowed for {name}.",
                )

    @property
    def segments(self) -> int:
        """Number of segments."""
        return len(self.nodes) - 1

    def program(self, problem: Problem, guess: Trajectory) -> Program:
        """Return the finite program of ``problem`` on this mesh, started from ``guess``."""
        return self.program_of(PointFunctions.of(problem), problem, guess)

    def program_of(self, functions: PointFunctions, problem: Problem, guess: Trajectory) -> Program:
        """Return the finite program of a problem whose functions were made for another mesh."""
        points = _Points(self, self._nodes_for(problem), problem)
        layout = points.layout
        states, controls = layout.states_at(layout.state), layout.controls_at(layout.control)
        lower, upper = _bounds(self, problem, layout, states, controls)
        names = global_names(problem)
        path_lower, path_upper = points.path_bounds()
        duration = None if problem.free_horizon else problem.duration_guess
        return Program(
            name=problem.name,
            state_names=problem.state_names,
            control_names=problem.control_names,
            global_names=names,
            path_names=tuple(entry.name for entry in problem.constraints),
            parameter_names=parameter_names(problem),
            parametric_point=functions.point,
            parametric_terminal=functions.terminal,
            parameters=parameter_values(problem),
            C=self.table.C,
            A=self.table.A[:, points.used],
            control_weights=points.weights[points.used],
            control_points=self.table.control_points[self.controls],
            shared=points.shared,
            fractions=points.fractions,
            used=points.used,
            segment_points=points.segment_points,
            point_state=points.state,
            point_control=points.control,
            point_weights=points.combination,
            point_time=points.time,
            segment_cost=self._segment_cost(points, problem),
            layout=layout,
            lower=lower,
            upper=upper,
            path_lower=path_lower,
            path_upper=path_upper,
            rates=rate_rows(
                problem, layout, points.fractions, points.control_points, points.shared
            ),
            start=self._start(problem, guess, states, controls, lower, upper),
            scales=decision_scales(problem, layout),
            compressed=self.form == "compressed",
            duration=duration,
        )

    def again(self, program: Program, problem: Problem, guess: Trajectory) -> Program:
        """Return the program of a problem that differs from the last one in numbers only.

        Parameters
        ----------
        program : what ``program`` returned for a problem with the same callables, horizon and
            constraints; its functions, bookkeeping and scales are kept
        problem : with its own ends, bounds and values of parameters
        """
        places = program.incidence
        lower, upper = _bounds(self, problem, program.layout, places.states, places.controls)
        return program.with_numbers(
            lower=lower,
            upper=upper,
            parameters=parameter_values(problem),
            start=self._start(problem, guess, places.states, places.controls, lower, upper),
        )

    def _start(
        self,
        problem: Problem,
        guess: Trajectory,
        states: Offsets,
        controls: Offsets,
        lower: Array,
        upper: Array,
    ) -> Array:
        """Return z of a guess; ``states`` and ``controls`` are where their values stand in z."""
        T, z = guess.duration, np.zeros(len(lower))
        for tau, positions, read in zip(
            self.taken_at(problem), (states, controls), (guess.state, guess.control), strict=True
        ):
            z[positions] = np.reshape(read(guess.times[0] + T * tau), positions.shape)
        free = [value.start for value in problem.free_parameters.values()]
        q = ([T] if problem.free_horizon else []) + free
        z[len(z) - len(q) :] = q
        return z.clip(lower, upper)

    def taken_at(self, problem: Problem) -> tuple[Array, Array]:
        """Return where in the horizon all state and all control values stand: (N·s,), (N·m,)."""
        nodes = self._nodes_for(problem)
        state, control = (
            np.minimum(nodes[:-1, None] + np.diff(nodes)[:, None] * places[None, :], 1.0).ravel()
            for places in (self.table.points, self.table.control_points[self.controls])
        )
        return state, control

    def _nodes_for(self, problem: Problem) -> Array:
        return with_nodes_at(self.nodes, [entry.at for entry in problem.points])

    def _segment_cost(self, points: _Points, problem: Problem) -> Array:
        weights: Array = points.fractions[:, None] * self.table.b[None, points.used]
        if self.objective == "integral":
            return weights
        if problem.free_horizon:
            raise UserError(
                "The plain sum over the nodes has no meaning with a free horizon.",
                where="objective",
                found="'sum' with a free horizon",
                expected="'integral', or a fixed horizon",
                do="Use objective='integral'.",
            )
        weights = np.zeros_like(weights)
        weights[:, 0] = 1 / problem.duration_guess
        return weights


class _Points:
    """Index bookkeeping of the evaluated points; used once, while a program is made."""

    def __init__(self, transcription: Transcription, nodes: Array, problem: Problem) -> None:
        table = transcription.table
        self.nodes, self.fractions, self.problem = nodes, np.diff(nodes), problem
        self.enforce = transcription.enforce
        self.weights = table.control_weights(transcription.controls)
        self.shared = table.shares_controls(transcription.controls)
        self.control_points = table.control_points[transcription.controls]
        N, s, m = len(self.fractions), len(table.points), self.weights.shape[1]
        nq = len(global_names(problem))
        self.layout: Layout = node_major(N, s, m, self.shared, problem.nx, problem.nu, nq)
        # Nodes where the scheme itself may not look, but constraints, the plain sum, or the
        # bookkeeping of shared controls do.
        has_path, plain_sum = bool(problem.constraints), transcription.objective == "sum"
        ends = [0, s - 1] if has_path or self.shared else [0] if plain_sum else []
        self.used: Offsets = np.union1d(table.used, ends).astype(np.intp)
        self.inner_time = nodes[:-1, None] + self.fractions[:, None] * table.points[None, :]
        self._list_points(N, s)

    def _list_points(self, N: int, s: int) -> None:
        places = [(k, int(j)) for k in range(N) for j in self.used]
        if self.shared:  # the last point of a segment is the first of the next
            places = [(k, j) for k, j in places if j != s - 1 or k == N - 1]
        index = {place: i for i, place in enumerate(places)}
        if self.shared:
            index.update({(k, s - 1): index[(k + 1, 0)] for k in range(N - 1)})
        self.segment_points: Offsets = np.array(
            [[index[k, int(j)] for j in self.used] for k in range(N)]
        )
        k, j = np.array(places).T
        self.state = self.layout.state[k, j]
        self.control = self.layout.control[k]
        self.combination = self.weights[j]
        self.time = self.inner_time[k, j]
        self.constrained = self._where_constraints_hold(k, j, s - 1)

    def _where_constraints_hold(self, k: Offsets, j: Offsets, last: int) -> NDArray[np.bool_]:
        """Return (P,) whether path constraints hold at point j of segment k.

        A start without a control value of its own (Radau) repeats the end of the segment before,
        with an extrapolated control: it counts at the first node only.
        """
        where = (j == 0) | (j == last) if self.enforce == "nodes" else np.ones(len(j), dtype=bool)
        if self.control_points[0] == 0:
            return where
        result: NDArray[np.bool_] = where & ((j > 0) | (k == 0))
        return result

    def path_bounds(self) -> tuple[Array, Array]:
        """Return (P, ng) bounds, infinite where a constraint does not apply."""
        path, points, P = self.problem.path, self.problem.points, len(self.time)
        lower, upper = np.full((P, len(path) + len(points)), -np.inf), None
        upper = -lower
        where = self.constrained
        for column, entry in enumerate(path):
            lower[where, column] = -np.inf if entry.lower is None else entry.lower
            upper[where, column] = np.inf if entry.upper is None else entry.upper
        for column, event in enumerate(points, start=len(path)):
            row = int(np.argmin(np.abs(self.time - event.at)))
            lower[row, column] = -np.inf if event.lower is None else event.lower
            upper[row, column] = np.inf if event.upper is None else event.upper
        return lower, upper


def _bounds(
    transcription: Transcription,
    problem: Problem,
    layout: Layout,
    states: Offsets,
    controls: Offsets,
) -> tuple[Array, Array]:
    """Return bounds of z; ``states`` and ``controls`` are where their values stand in it."""
    lower, upper = np.full(layout.size, -np.inf), np.full(layout.size, np.inf)
    bounded = states if transcription.enforce == "points" else states[:, [0, -1]]
    lower[bounded], upper[bounded] = problem.state_lower, problem.state_upper
    lower[controls], upper[controls] = problem.control_lower, problem.control_upper
    for here, low, high in (
        (states[0, 0], problem.initial_lower, problem.initial_upper),
        (states[-1, -1], problem.final_lower, problem.final_upper),
    ):
        lower[here], upper[here] = np.maximum(lower[here], low), np.minimum(upper[here], high)
    free = ([problem.horizon] if problem.free_horizon else []) + list(
        problem.free_parameters.values()
    )
    lower[layout.global_positions] = [quantity.lower for quantity in free]  # type: ignore[union-attr]
    upper[layout.global_positions] = [quantity.upper for quantity in free]  # type: ignore[union-attr]
    return lower, upper
