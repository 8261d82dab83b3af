"""Solution: trajectory, multipliers, status, history, work counts; saved to one file."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from skyknot.deferral import Deferring
from skyknot.errors import UserError
from skyknot.status import Status
from skyknot.trajectory import Trajectory, lagrange_basis, located
from skyknot.witness import Witness

if TYPE_CHECKING:
    from skyknot.problem.problem import Problem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MeshRound:
    """One mesh of a refinement and its errors, as shares of the states' sizes.

    Attributes
    ----------
    segments, iterations : counts
    seconds : time for everything: solve, estimate, next mesh
    status : how the solve ended
    dynamics : largest error of a state between the nodes
    flight : largest distance of the open-loop flight from the nodes
    constraints : largest passing of a limit between the nodes, share of the limit
    switching : largest share of the horizon over which a jump of a control is spread
    error : the number compared with the accuracy
    """

    segments: int
    iterations: int
    seconds: float
    status: str
    dynamics: float
    flight: float
    constraints: float
    switching: float
    error: float


@dataclass(frozen=True)
class Record(Deferring):
    """What a solution says about how it came to be; all plain data, saved as JSON.

    Attributes
    ----------
    problem, transcription, solver : names
    segments : number of segments
    tolerance : tolerance asked for
    frame : frame of the positions
    state_units, control_units : units of the columns
    parameters : values of parameters and of free globals
    guess : rung of the guess ladder
    versions : of skyknot, CasADi, NumPy and Python
    inputs_hash : SHA-256 of the finite program solved
    detail : names the variable or constraint at fault; empty on success
    timings : seconds spent in each phase
    work : counts of evaluations and factorisations
    accuracy : accuracy asked for between the nodes and in flight; None when solved on one mesh
    rounds : the meshes of the refinement, in order; iterations, times and counts of a refined
        solution are those of all of them
    """

    problem: str
    transcription: str
    solver: str
    segments: int
    tolerance: float
    frame: str = "NED"
    state_units: tuple[str, ...] = ()
    control_units: tuple[str, ...] = ()
    parameters: dict[str, float] = field(default_factory=dict)
    guess: str = "user"
    versions: dict[str, str] = field(default_factory=dict)
    inputs_hash: str = field(default_factory=str)
    detail: str = ""
    timings: dict[str, float] = field(default_factory=dict)
    work: dict[str, int] = field(default_factory=dict)
    accuracy: float | None = None
    rounds: tuple[MeshRound, ...] = ()


@dataclass(frozen=True)
class Solution(Deferring):
    """What ``solve`` returns, solved or not.

    Costates, residuals and witness of what ``solve`` returns are computed when first read, and so
    is the hash of its record.

    Attributes
    ----------
    status : closed vocabulary, see Status; ``success`` is True for solved and acceptable
    objective : value of the objective
    iterations, solve_time : count, and seconds in the solver
    history : (iterations, 7) columns ``HISTORY``
    trajectory : Trajectory with the scheme's own interpolant
    costates : (N+1, nx) at the nodes, by the transformed adjoint
    kkt_residual : largest of stationarity, feasibility, complementarity, unscaled
    max_defect : largest defect, state units
    multipliers : arrays "defects", "path", "rates", "bounds", signed as in kernel/program.py
    decision : decision vector z, for warm starts
    record : names, versions, units, counts
    problem : the problem solved; None for a solution read from a file
    gains : feedback gains, where the solver has them: (N+1, nu, nx) at the nodes, or
        (N, nu, nx) of the segments when controls are held
    witness : scheme and multipliers as plain numbers, for the certificate; None in files written
        before there were any
    """

    status: Status
    objective: float
    iterations: int
    solve_time: float
    history: Array
    trajectory: Trajectory
    costates: Array
    kkt_residual: float
    max_defect: float
    multipliers: dict[str, Array]
    decision: Array
    record: Record
    problem: Problem | None = None
    gains: Array | None = None
    witness: Witness | None = field(default_factory=lambda: None)

    @property
    def success(self) -> bool:
        """Whether the tolerances were met."""
        return self.status.success

    @property
    def message(self) -> str:
        """The outcome as a sentence, with what to try when there is something to try."""
        meshes = f" on {len(self.rounds)} meshes" if len(self.rounds) > 1 else ""
        effort = f"{self.iterations} iterations{meshes}, {_seconds(self.solve_time)}"
        head = f"{self.status.value.capitalize()}: objective {self.objective:.6g} after {effort}."
        parts = [head, self.status.sentence, self.record.detail, self.status.advice]
        return " ".join(part for part in parts if part)

    @property
    def rounds(self) -> tuple[MeshRound, ...]:
        """The meshes that were solved on, when an accuracy was asked for."""
        return self.record.rounds

    @property
    def times(self) -> Array:
        """(N+1,) node times, s."""
        return self.trajectory.times

    @property
    def states(self) -> Array:
        """(N+1, nx) states at the nodes."""
        return self.trajectory.states

    @property
    def controls(self) -> Array:
        """(N+1, nu) controls at the nodes."""
        return self.trajectory.controls

    @property
    def midpoint_states(self) -> Array:
        """(N, nx) states in the middle of the segments."""
        segments = self.trajectory.segments
        if segments is not None and np.array_equal(segments.interior_points, [0.5]):
            return segments.interior_states[:, 0]
        return self.state(0.5 * (self.times[:-1] + self.times[1:]))

    @property
    def midpoint_controls(self) -> Array:
        """(N, nu) controls in the middle of the segments."""
        return self.control(0.5 * (self.times[:-1] + self.times[1:]))

    def state(self, t: ArrayLike) -> Array:
        """Return the state at t [s], (nx,) or (M, nx), by the scheme's own interpolant."""
        return self.trajectory.state(t)

    def control(self, t: ArrayLike) -> Array:
        """Return the control at t [s], (nu,) or (M, nu), by the scheme's own interpolant."""
        return self.trajectory.control(t)

    @property
    def interior_costates(self) -> Array:
        """(N, i, nx) costates at the interior points of the segments, by covector mapping.

        ψ_j = Σ_i A_ij λ_i / b_j, with which the scheme's own controls minimise H. Of order s − 1
        with Lobatto's s points, s with Radau's, 2 at a Hermite–Simpson midpoint.

        Raises
        ------
        UserError
            When the solution comes from a file without its scheme.

        References
        ----------
        Q. Gong, I. M. Ross, W. Kang & F. Fahroo, Comput. Optim. Appl. 41 (2008) 307–335; D. Garg
        et al., Automatica 46 (2010) 1843–1851; W. W. Hager, Numer. Math. 87 (2000) 247–282.
        """
        A, b = self._known_witness.A, self._known_witness.A[-1]
        inside = slice(1, -1)
        weighted = np.einsum("ij,kix->kjx", A[:, inside], self._known_witness.defects)
        result: Array = weighted / b[inside, None]
        return result

    def costate(self, t: ArrayLike) -> Array:
        """Return the costate p(t), (nx,) or (M, nx), with H = ℓ + pᵀf.

        In every segment the polynomial through node and interior costates; the node costates are of
        higher order (``costates``).

        Raises
        ------
        UserError
            When the solution comes from a file without its scheme.
        """
        values = np.concatenate(
            [self.costates[:-1, None], self.interior_costates, self.costates[1:, None]], axis=1
        )
        k, tau, _, scalar = located(self.times, t)
        basis = lagrange_basis(self._known_witness.points, tau)
        result: Array = np.einsum("tj,tjx->tx", basis, values[k])
        return result[0] if scalar else result

    @property
    def _known_witness(self) -> Witness:
        if self.witness is None:
            raise UserError(
                "This solution does not carry its scheme.",
                where="solution",
                found="a file written by an earlier version",
                expected="a solution with scheme and multipliers",
                do="Solve again, with guess= the solution read.",
            )
        return self.witness

    def feedback(self, t: ArrayLike) -> Array:
        """Return the gains K(t), (nu, nx) or (M, nu, nx): u = u*(t) − K(t)(x − x*(t)).

        Raises
        ------
        UserError
            When the solver has no factorisation to take gains from.
        """
        if self.gains is None:
            raise UserError(
                "This solution carries no feedback gains.",
                where="solution.feedback",
                found=f"solver '{self.record.solver}'",
                expected="a solver with a Riccati factorisation, and more than one long segment",
                do="Solve with the interior point on several segments, not Radau with linear"
                " controls; or design gains from the trajectory.",
            )
        t = np.asarray(t, dtype=float)
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        if len(self.gains) == len(self.times) - 1:  # held from node to node
            return np.asarray(self.gains[k])
        share = np.clip((t - self.times[k]) / (self.times[k + 1] - self.times[k]), 0, 1)
        share = np.asarray(share)[..., None, None]
        result: Array = (1 - share) * self.gains[k] + share * self.gains[k + 1]
        return result

    def verify(self, problem: Problem | None = None) -> Any:
        """Return the Certificate: an independent check that shares no code with the solver.

        Parameters
        ----------
        problem : the problem solved; needed for a solution read from a file

        Raises
        ------
        UserError
            When no problem is at hand.
        """
        from skyknot.verification import certify  # room entered on request: it imports scipy

        asked = problem or self.problem
        if asked is None:
            raise UserError(
                "A solution read from a file does not carry its problem.",
                where="solution.verify",
                found="no problem",
                expected="the problem that was solved",
                do="Call solution.verify(problem), or 'skyknot verify DIR' for a saved run.",
            )
        return certify(asked, self.trajectory, self.record.parameters, witness=self.full_witness())

    def full_witness(self) -> Witness | None:
        """Return the witness with the costates and gains that this solution claims."""
        if self.witness is None:
            return None
        return replace(self.witness, costates=self.costates, gains=self.gains)

    def report(self, path: str | Path) -> Path:
        """Write a one-page HTML report with figures and verdict; return its path."""
        from skyknot.report import write_report  # room entered on request: it imports matplotlib

        written: Path = write_report(self, Path(path))
        return written

    def plot(self, kind: str = "overview") -> Any:
        """Return a matplotlib figure of the given kind."""
        from skyknot.report import draw  # room entered on request: it imports matplotlib

        return draw(self, kind)

    def animate(self, path: str | Path) -> Path:
        """Write a film of the flight, .gif or (where ffmpeg is installed) .mp4; return its path."""
        from skyknot.report.animation import write_film  # room entered on request: matplotlib

        written: Path = write_film(self, Path(path))
        return written

    def export(self, path: str | Path, to: str | None = None, **options: Any) -> Any:
        """Write the flight for other programs; see ``skyknot.export.write_export``."""
        from skyknot.export import write_export  # room entered on request: it imports the formats

        return write_export(self, path, to, **options)

    def save(self, path: str | Path) -> Path:
        """Write everything to one NPZ file, through a temporary file; return its path."""
        from skyknot.storage import save

        return save(self, Path(path))


HISTORY = (
    "iteration",
    "objective",
    "primal_infeasibility",
    "dual_infeasibility",
    "barrier",
    "step",
    "regularisation",
)


def _seconds(seconds: float) -> str:
    return f"{1e3 * seconds:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"
