"""The projected gradient: Algorithm 1 of the source report, in three forms.

Legend: z unknowns, J cost, c defects, λ multipliers, α step length, M metric, H = ∇²L.

Source: V. P. Gautam, S. Nerella, "Numerical Optimal Control of a UAM Vehicle using Hermite–Simpson
Collocation", AOE 5404, Virginia Tech: Algorithm 1, equations (15) and (17)–(20).

    form           line 4: gradient        line 6: projection on             metric
    printed        ∇J                      control bounds                    plain
    multipliers    ∇J + ∇cᵀ(λ + ρc)        bounds                            plain
    structured     ∇J + ∇cᵀλ               linearised defects and bounds     Gauss–Newton, Riccati
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from itertools import count

import numpy as np

from skyknot.errors import UserError
from skyknot.kernel.evaluation import complete_fixed
from skyknot.kernel.program import Multipliers, Program
from skyknot.solvers.base import Callback, IterationRecord, SolverResult
from skyknot.solvers.blame import undefined_value, worst_violation
from skyknot.solvers.descent import Errors, Form, Iterate, Move, errors, projected
from skyknot.solvers.metric import Array, Metric
from skyknot.solvers.plain_descent import MultiplierDescent, PrintedDescent
from skyknot.solvers.step_size import barzilai_borwein, cauchy_length, dot, spectral_norm
from skyknot.solvers.structured_descent import StructuredDescent
from skyknot.status import Status

FORMS = ("structured", "multipliers", "printed")
"""The forms of the projected gradient."""

_UNSTABLE = 1.0 + 1e-6


@dataclass(frozen=True)
class ProjectedGradient:
    """Settings of the projected gradient.

    It takes fixed and free horizons, fixed ends, control and state bounds; path constraints and
    rate bounds are refused by name.

    Parameters
    ----------
    form : "structured" projects each step on linearised defects and bounds in the metric of a
        Riccati-factored Gauss–Newton matrix; "multipliers" is an augmented Lagrangian, slow;
        "printed" is Algorithm 1 to the letter, which finds no feasible optimum and says so
    step_length : fixed step length α; None for Barzilai and Borwein's, equation (18)
    optimality_tolerance : largest entry of ∇J + ∇cᵀλ, equation (20), in the user's units; never
        more than ten times the tolerance of ``solve``, which is for the defects (19)
    max_iterations : stop after this many iterations
    max_seconds : stop after this much time, s

    Raises
    ------
    UserError
        For a form that does not exist and for settings that leave no room.
    """

    form: str = "structured"
    step_length: float | None = None
    optimality_tolerance: float = 1e-5
    max_iterations: int = 1000
    max_seconds: float = 600.0
    name: str = "projected-gradient"

    def __post_init__(self) -> None:
        if self.form not in FORMS:
            raise UserError(
                "The projected gradient has no form of this name.",
                where="ProjectedGradient.form",
                found=repr(self.form),
                expected=" or ".join(repr(form) for form in FORMS),
                do="Leave it out for 'structured'.",
            )
        limits = {
            "step_length": 1.0 if self.step_length is None else self.step_length,
            "optimality_tolerance": self.optimality_tolerance,
            "max_seconds": self.max_seconds,
            "max_iterations": self.max_iterations + 1,
        }
        for setting, value in limits.items():
            if not 0 < value < np.inf:
                raise UserError(
                    "The projected gradient needs room to iterate.",
                    where=f"ProjectedGradient.{setting}",
                    found=getattr(self, setting),
                    expected="a positive number (0 or more iterations)",
                    do="Leave it out for the default.",
                )

    def solve(
        self,
        program: Program,
        tolerance: float,
        multipliers: Multipliers | None = None,
        callback: Callback | None = None,
    ) -> SolverResult:
        """Solve the program to ``tolerance``; see Solver.

        Raises
        ------
        UserError
            When the program has path constraints or rate bounds, by name.
        """
        _refuse(program)
        metric = Metric(program)
        run = _Run(self, metric, tolerance, callback)
        start = metric.no_multipliers
        if multipliers is not None:
            start = metric.scaled_multipliers(multipliers)
        form = self._form(metric, start, run)
        status, why = self._descend(form, run)
        return run.result(status, why, form.work)

    def _form(self, metric: Metric, multipliers: Array, run: _Run) -> Form:
        if self.form == "printed":
            return PrintedDescent(metric)
        if self.form == "multipliers":
            return MultiplierDescent(metric, multipliers, run.tolerance, run.optimality)
        return StructuredDescent(metric, multipliers, run.tolerance, run.optimality)

    def _descend(self, form: Form, run: _Run) -> tuple[Status, str]:
        """Follow Algorithm 1; its lines are told at the right."""
        at, move, alpha = form.start, None, 0.0
        try:
            for i in count():
                gradient = form.gradient(at)  # 4: ∇J(z), with λ (17)
                found = errors(form.metric, at, gradient)  # 7: defects (19), optimality (20)
                stop = run.see(i, at, gradient, found, form, alpha)  # 3 and 8
                if stop is not None:
                    return stop, self._why(stop, form, at)
                alpha = self._length(form, at, gradient, move, alpha)  # (18)
                if i == 0 and not form.safeguarded and self._unstable(form, at):
                    return Status.STALLED, self._why(Status.STALLED, form, at)
                move = form.advance(at, gradient, found, alpha)  # 5, 6: update and projection
                if move is None:
                    return form.why_status, self._why(form.why_status, form, at)
                at = move.to
        except KeyboardInterrupt:
            pass
        return Status.INTERRUPTED, ""

    def _length(
        self, form: Form, at: Iterate, gradient: Array, move: Move | None, last: float
    ) -> float:
        """Return the step length: fixed, the form's first, or Barzilai and Borwein's."""
        if self.step_length is not None:
            return self.step_length
        if move is None:
            if form.first_length is not None:
                return form.first_length
            curved = form.metric_times(form.curvature(at, gradient))
            return cauchy_length(gradient, form.metric_times(gradient), curved)
        change = gradient - move.before
        return barzilai_borwein(move.step, change, form.metric_times(move.step), last)

    def _unstable(self, form: Form, at: Iterate) -> str:
        """Return a sentence when a fixed step length fails the stability test (15)."""
        if self.step_length is None:
            return ""
        size = stability(form, at, self.step_length)
        if size <= _UNSTABLE:
            return ""
        return (
            f"The fixed step length {self.step_length:.3g} is unstable there by equation (15): "
            f"|I - step * Hessian in the metric| is {size:.3g}, not below 1. "
            "Leave step_length out for Barzilai-Borwein steps."
        )

    def _why(self, status: Status, form: Form, at: Iterate) -> str:
        """Return what the form has to say about an end that is not success."""
        if status.success or status in (Status.INTERRUPTED, Status.EVALUATION_ERROR):
            return ""
        return " ".join(part for part in (form.why, self._unstable(form, at)) if part)


def stability(form: Form, at: Iterate, alpha: float) -> float:
    """Return ‖I − α M⁻¹∇²L‖ at an iterate, the left side of equation (15).

    On the steps that the form may take: with "structured", those that defects and bounds leave.
    """

    def norm(v: Array) -> float:
        return float(np.sqrt(max(0.0, dot(v, form.metric_times(v)))))

    direction = np.random.default_rng(0).normal(size=len(at.w))
    return spectral_norm(
        lambda v: form.curvature(at, v),
        norm,
        lambda v: form.tangent(at, v),
        np.where(form.metric.here, direction, 0.0),
        alpha,
    )


@dataclass
class _Run:
    """One solve: limits, history, the callback and the last iterate with values."""

    settings: ProjectedGradient
    metric: Metric
    tolerance: float
    callback: Callback | None
    history: list[IterationRecord] = field(default_factory=list)
    last: tuple[Iterate, Array] | None = None
    undefined: str = ""

    def __post_init__(self) -> None:
        self.optimality = min(self.settings.optimality_tolerance, 10.0 * self.tolerance)
        self.started = time.perf_counter()

    def see(
        self, i: int, at: Iterate, gradient: Array, found: Errors, form: Form, step: float
    ) -> Status | None:
        """Record an iterate; return how the solve ends when it ends here."""
        record = IterationRecord(
            i,
            at.point.objective,
            found.primal,
            found.optimality,
            step=step,
            regularisation=form.regularisation,
        )
        self.history.append(record)
        measure = found.measure(self.tolerance, self.optimality)
        known = bool(np.isfinite(measure) and np.isfinite(at.point.objective))
        if known or self.last is None:
            self.last = at, gradient
        if not known:
            self.undefined = self._undefined(at)
            return Status.EVALUATION_ERROR
        if self.callback is not None and self.callback(record):
            return Status.INTERRUPTED
        if measure <= 1.0:
            return Status.SOLVED
        if form.ends_without_defects and found.defect < self.tolerance and i > 0:
            return Status.STALLED
        if i >= self.settings.max_iterations:
            return Status.ITERATION_LIMIT
        if time.perf_counter() - self.started > self.settings.max_seconds:
            return Status.TIME_LIMIT
        return None

    def result(self, status: Status, why: str, work: dict[str, int]) -> SolverResult:
        """Return the last iterate with its multipliers, signed as in kernel/program.py."""
        if self.last is None:  # interrupted before the first iterate was seen
            raise KeyboardInterrupt
        metric, (at, gradient) = self.metric, self.last
        if not status.success and status != Status.INTERRUPTED:
            self.undefined = self.undefined or self._undefined(at)
            status = Status.EVALUATION_ERROR if self.undefined else status
        held = projected(metric, at.w, gradient) - gradient
        bounds = np.where(metric.moving & np.isfinite(held), held, 0.0)
        z, m = metric.unscaled(at.w), metric.multipliers(at.multipliers, bounds)
        program = metric.program
        complete_fixed(program, z, m)
        parts = [] if status.success else [self.undefined or worst_violation(program, z)]
        parts += [] if status.success else [_outside(program, z, self.tolerance), why]
        return SolverResult(
            z=z,
            multipliers=m,
            status=status,
            iterations=len(self.history) - 1,
            history=tuple(self.history),
            work=metric.work | work,
            detail=" ".join(part for part in parts if part),
        )

    def _undefined(self, at: Iterate) -> str:
        return undefined_value(self.metric.program, self.metric.unscaled(at.w))


def _outside(program: Program, z: Array, tolerance: float) -> str:
    """Return a sentence naming the unknown farthest outside its bounds, if there is one."""
    by = np.maximum(program.lower - z, z - program.upper)
    worst = int(np.argmax(by))
    if not by[worst] > tolerance:
        return ""
    name = program.variable_name(worst)
    return f"The value of {name} lies {by[worst]:.3g} outside its bounds or off its fixed value."


def _refuse(program: Program) -> None:
    """Refuse what the projection cannot hold, by name."""
    for kind, names in (
        ("path constraint", program.path_names),
        ("rate bound", tuple(dict.fromkeys(program.rates.names))),
    ):
        if names:
            quoted = ", ".join(f"'{name}'" for name in names)
            raise UserError(
                f"The projected gradient cannot hold a {kind}.",
                where=f"solver 'projected-gradient', {kind} on {quoted}",
                found=f"{len(names)} {kind}{'s' if len(names) > 1 else ''}",
                expected="bounds on states and controls, and fixed ends",
                do="Solve with 'interior-point' or 'ipopt', or leave the constraint out.",
            )
