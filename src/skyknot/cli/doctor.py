"""skyknot doctor: is this installation sound, told by solving problems whose answer is known."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version

import casadi as ca
import typer

from skyknot.cli.exits import Exit, command, print_json
from skyknot.cli.solving import JsonOption
from skyknot.kernel import isa_name
from skyknot.problem.constraints import PathConstraint
from skyknot.problem.problem import Problem
from skyknot.solve import solve
from skyknot.solvers import SOLVERS
from skyknot.transcription import HermiteSimpson
from skyknot.version import __version__

ALLOWED = 1e-5
"""Relative error of a known optimum that still counts as healthy."""

SEGMENTS = 30
"""A multiple of three, so that the nodes meet the corners of the Bryson–Denham optimum."""


def double_integrator() -> Problem:
    """Return minimum energy from rest to rest over 1 m in 1 s; the optimum of ½∫a² dt is 6.

    a(t) = 6 − 12 t, so ½∫a² = 6; cubic in position, hence exact for Hermite–Simpson.
    """
    return Problem(
        name="double integrator",
        states=["x", "v"],
        controls=["a"],
        dynamics=lambda x, u: [x[1], u[0]],
        horizon=1.0,
        initial=[0, 0],
        final=[1, 0],
        running_cost=lambda _x, u: 0.5 * u[0] ** 2,
    )


def bryson_denham() -> Problem:
    """Return the Bryson–Denham problem with x ≤ ℓ = 1/9; the optimum is 4/(9 ℓ) = 4.

    A. E. Bryson and Y.-C. Ho, Applied Optimal Control, 1975, section 3.11.
    """
    return Problem(
        name="Bryson–Denham",
        states=["x", "v"],
        controls=["a"],
        dynamics=lambda x, u: [x[1], u[0]],
        horizon=1.0,
        initial=[0, 1],
        final=[0, -1],
        running_cost=lambda _x, u: 0.5 * u[0] ** 2,
        path=[PathConstraint("wall", lambda x, _u: x[0], upper=1 / 9, unit="m")],
    )


KNOWN: tuple[tuple[Callable[[], Problem], float], ...] = (
    (double_integrator, 6.0),
    (bryson_denham, 4.0),
)


@dataclass(frozen=True)
class Trial:
    """A known optimum, solved: the error is relative."""

    problem: str
    solver: str
    objective: float
    exact: float
    solved: bool

    @property
    def error(self) -> float:
        """Relative error of the objective."""
        return abs(self.objective - self.exact) / abs(self.exact)

    @property
    def healthy(self) -> bool:
        """Whether it was solved and is near enough."""
        return self.solved and self.error <= ALLOWED


@command
def doctor(as_json: JsonOption = False) -> Exit:
    """Check this installation: versions, instruction set, and optima that are known.

    Exit status: 0 healthy, 3 a known optimum was missed.
    """
    facts, trials = environment(), [_trial(*entry) for entry in KNOWN]
    healthy = all(trial.healthy for trial in trials)
    worst = max(trial.error for trial in trials)
    verdict = (
        f"Healthy: {len(trials)} known optima met, largest relative error {worst:.1e}."
        if healthy
        else f"Not healthy: a known optimum was missed by {worst:.1e}; reinstall skyknot."
    )
    status = Exit.GOOD if healthy else Exit.NOT_SOLVED
    if as_json:
        told = [vars(trial) | {"error": trial.error, "healthy": trial.healthy} for trial in trials]
        print_json(
            {
                "environment": facts,
                "trials": told,
                "healthy": healthy,
                "verdict": verdict,
                "exit_status": int(status),
            }
        )
        return status
    for name, value in facts.items():
        typer.echo(f"{name:<16} {value}")
    for trial in trials:
        typer.echo(
            f"{trial.problem:<16} {trial.solver}: {trial.objective:.9g}, known {trial.exact:g}, "
            f"relative error {trial.error:.1e}"
        )
    typer.echo(verdict)
    return status


def environment() -> dict[str, str]:
    """Return versions of what matters, the processor, and the kernel's instruction set."""
    return {
        "skyknot": __version__,
        "kernel": f"instruction set {isa_name()}",
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}, {os.cpu_count()} processors",
        "casadi": str(ca.CasadiMeta.version()),
        **{name: version(name) for name in ("numpy", "scipy", "pydantic")},
        "solvers": ", ".join(SOLVERS),
    }


def _trial(make: Callable[[], Problem], exact: float) -> Trial:
    problem = make()
    solution = solve(problem, HermiteSimpson(segments=SEGMENTS))
    return Trial(
        problem.name, solution.record.solver, solution.objective, exact, bool(solution.success)
    )
