"""Ipopt (Wächter & Biegler 2006), bundled with CasADi, on the program every solver gets."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.kernel.program import Multipliers, Program
from skyknot.solvers.base import Callback, IterationRecord, SolverResult
from skyknot.solvers.blame import worst_violation
from skyknot.solvers.nonlinear_program import NonlinearProgram, nonlinear_program
from skyknot.status import Status

Array = NDArray[np.float64]

_STATUS = {
    "Solve_Succeeded": Status.SOLVED,
    "Solved_To_Acceptable_Level": Status.ACCEPTABLE,
    "Infeasible_Problem_Detected": Status.INFEASIBLE,
    "Maximum_Iterations_Exceeded": Status.ITERATION_LIMIT,
    "Maximum_CpuTime_Exceeded": Status.TIME_LIMIT,
    "Maximum_WallTime_Exceeded": Status.TIME_LIMIT,
    "Diverging_Iterates": Status.UNBOUNDED,
    "Invalid_Number_Detected": Status.EVALUATION_ERROR,
    "User_Requested_Stop": Status.INTERRUPTED,
    "NonIpopt_Exception_Thrown": Status.INTERRUPTED,  # CasADi tells Ctrl-C this way
}


@dataclass(frozen=True)
class Ipopt:
    """Settings of the Ipopt solver.

    Parameters
    ----------
    max_iterations : stop after this many iterations
    max_seconds : stop after this much time, s
    linear_solver : Ipopt's name of it
    expand : write the graph out as scalar operations first (slower to build, faster to run)
    """

    max_iterations: int = 1000
    max_seconds: float = 600.0
    linear_solver: str = "mumps"
    expand: bool = False
    name: str = "ipopt"

    def __post_init__(self) -> None:
        if self.max_iterations < 0 or not self.max_seconds > 0:
            raise UserError(
                "Ipopt needs room to iterate.",
                where="Ipopt.max_iterations, Ipopt.max_seconds",
                found=f"{self.max_iterations} iterations, {self.max_seconds:g} s",
                expected="0 or more iterations, and a positive time",
                do="Leave them out for the defaults.",
            )

    def solve(
        self,
        program: Program,
        tolerance: float,
        multipliers: Multipliers | None = None,
        callback: Callback | None = None,
    ) -> SolverResult:
        """Solve the program to ``tolerance``; see Solver."""
        nlp = nonlinear_program(program)
        watch = _Watch(nlp, callback, self.max_seconds)
        options = self._options(tolerance, watch)
        if multipliers is not None:
            options |= _warm_start(tolerance)
        solver = self._created(nlp, options)
        start = {"x0": program.start[nlp.kept] / nlp.scale}
        if multipliers is not None:
            start["lam_x0"] = multipliers.bounds[nlp.kept] * nlp.scale
            start["lam_g0"] = nlp.lowered(multipliers)
        answer = solver(lbx=nlp.lower, ubx=nlp.upper, lbg=nlp.g_lower, ubg=nlp.g_upper, **start)
        stats = solver.stats()
        if watch.error is not None:
            raise watch.error
        if stats["return_status"] == "Invalid_Option":
            raise self._refused("it is not installed")
        return self._result(program, nlp, answer, stats, watch)

    def _created(self, nlp: NonlinearProgram, options: dict[str, Any]) -> ca.Function:
        try:
            return ca.nlpsol("ipopt", "ipopt", nlp.graph, options)
        except RuntimeError as error:
            if "Invalid options" not in str(error):
                raise
            raise self._refused("Ipopt does not know it") from error

    def _refused(self, reason: str) -> UserError:
        return UserError(
            "Ipopt cannot use this linear solver.",
            where="Ipopt.linear_solver",
            found=f"'{self.linear_solver}': {reason}",
            expected="'mumps', which comes with CasADi, or an installed one such as 'ma57'",
            do="Leave linear_solver out.",
        )

    def _options(self, tolerance: float, watch: _Watch) -> dict[str, Any]:
        return {
            "print_time": False,
            "expand": self.expand,
            "error_on_fail": False,
            "show_eval_warnings": False,
            "iteration_callback": watch,
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.tol": tolerance,
            "ipopt.constr_viol_tol": tolerance,
            "ipopt.max_iter": self.max_iterations,
            "ipopt.max_wall_time": self.max_seconds,
            "ipopt.linear_solver": self.linear_solver,
            # bounds mean what they say; bang-bang times differ in the 8th digit otherwise
            "ipopt.bound_relax_factor": 0.0,
        }

    def _result(
        self,
        program: Program,
        nlp: NonlinearProgram,
        answer: dict[str, ca.DM],
        stats: dict[str, Any],
        watch: _Watch,
    ) -> SolverResult:
        status = _STATUS.get(stats["return_status"], Status.STALLED)
        if status is Status.INTERRUPTED and watch.out_of_time:
            status = Status.TIME_LIMIT
        y, lam_x, lam_g = (np.asarray(answer[k]).ravel() for k in ("x", "lam_x", "lam_g"))
        if not np.all(np.isfinite(y)):
            y, lam_x, lam_g = (
                program.start[nlp.kept] / nlp.scale,
                np.zeros_like(lam_x),
                np.zeros_like(lam_g),
            )
        z, multipliers = nlp.lifted(y, lam_x, lam_g)
        detail = "" if status.success else worst_violation(program, z)
        return SolverResult(
            z=z,
            multipliers=multipliers,
            status=status,
            iterations=int(stats["iter_count"]),
            history=_history(stats),
            work=_work(stats),
            detail=detail,
        )


def _warm_start(tolerance: float) -> dict[str, Any]:
    """Return the options that keep Ipopt near the start it is given."""
    pushes = ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac", "mult_bound_push")
    near = {f"ipopt.warm_start_{name}": 0.1 * tolerance for name in pushes}
    return {"ipopt.warm_start_init_point": "yes", "ipopt.mu_init": 10 * tolerance, **near}


class _Watch(ca.Callback):
    """Sees every iterate: reports it, and stops Ipopt on request."""

    def __init__(self, nlp: NonlinearProgram, report: Callback | None, max_seconds: float) -> None:
        ca.Callback.__init__(self)
        self.nlp, self.report = nlp, report
        self.deadline = time.monotonic() + max_seconds
        self.out_of_time, self.count = False, 0
        self.error: Exception | None = None
        self.n, self.m = nlp.graph["x"].numel(), nlp.graph["g"].numel()
        self.construct("watch", {})

    def get_n_in(self) -> int:
        return ca.nlpsol_n_out()

    def get_n_out(self) -> int:
        return 1

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        sizes = {"f": 1, "x": self.n, "lam_x": self.n, "g": self.m, "lam_g": self.m}
        name = ca.nlpsol_out(i)
        return ca.Sparsity.dense(sizes[name]) if name in sizes else ca.Sparsity(0, 0)

    def eval(self, arguments: Any) -> list[int]:
        self.out_of_time = time.monotonic() > self.deadline
        stop = self.out_of_time
        if self.report is not None:
            named = {ca.nlpsol_out(i): value for i, value in enumerate(arguments)}
            g = np.asarray(named["g"]).ravel()
            violation = np.maximum(self.nlp.g_lower - g, g - self.nlp.g_upper)
            record = IterationRecord(
                self.count, float(named["f"]), float(max(violation.max(initial=0), 0)), np.nan
            )
            stop = self._reported(record) or stop
        self.count += 1
        return [int(stop)]

    def _reported(self, record: IterationRecord) -> bool:
        """Report, and keep what the report raises: an exception must not cross Ipopt."""
        assert self.report is not None
        try:
            return bool(self.report(record))
        except KeyboardInterrupt:
            return True
        except Exception as error:  # noqa: BLE001  (kept, and raised again after Ipopt has stopped)
            self.error = error
            return True


def _history(stats: dict[str, Any]) -> tuple[IterationRecord, ...]:
    rows = stats.get("iterations") or {}
    names = ("obj", "inf_pr", "inf_du", "mu", "alpha_pr", "regularization_size")
    columns = [rows.get(name, []) for name in names]
    return tuple(IterationRecord(i, *row) for i, row in enumerate(zip(*columns, strict=False)))


def _work(stats: dict[str, Any]) -> dict[str, int]:
    counts = {
        "objective": "n_call_nlp_f",
        "gradient": "n_call_nlp_grad_f",
        "constraints": "n_call_nlp_g",
        "jacobian": "n_call_nlp_jac_g",
        "hessian": "n_call_nlp_hess_l",
    }
    return {name: int(stats[key]) for name, key in counts.items() if key in stats}
