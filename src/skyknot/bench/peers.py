"""The contestants: each is built once for a mission and then solved again and again.

own               skyknot's interior point, Prepared(program); a solve packs the start, runs the
                  native iterations, and unpacks unknowns and multipliers
ipopt             Ipopt with MUMPS on the identical program, point functions mapped (CasADi's
                  virtual machine); a solve is the call of the solver object
fatrop            Fatrop on multiple shooting with RK4 and as many segments: another program
                  with another optimum, the fastest interior point that comes with CasADi
…, expanded       the same with the whole program written out as scalar operations
…, compiled       the expanded one as C code, compiled with -O3 when it is built
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import casadi as ca

from skyknot.bench.shooting import shooting_program
from skyknot.kernel.program import Program
from skyknot.problem.problem import Problem
from skyknot.solvers.interior_point import InteriorPoint, Prepared
from skyknot.solvers.nonlinear_program import nonlinear_program
from skyknot.trajectory import Trajectory
from skyknot.transcription import Transcription

SECONDS = 60.0
"""Time limit of one solve, where the solver has one, s."""


MAPPED: dict[str, Any] = {}
EXPANDED: dict[str, Any] = {"expand": True}
COMPILED: dict[str, Any] = {
    "expand": True,
    "jit": True,
    "compiler": "shell",
    "jit_options": {"flags": ["-O3", "-march=native"], "verbose": False},
}
"""Options of CasADi for the forms of a peer."""


@dataclass(frozen=True)
class Answer:
    """How one solve ended."""

    success: bool
    iterations: int
    objective: float


class Contestant(Protocol):
    """A solver object, built, ready to be solved again from the same start."""

    name: str

    def solve(self) -> Answer:
        """Solve from the cold start."""


@dataclass(frozen=True)
class Pose:
    """What all contestants are given: a problem, a scheme, a start and a tolerance."""

    problem: Problem
    scheme: Transcription
    guess: Trajectory
    tolerance: float

    def program(self) -> Program:
        """Return the finite program; building it is part of building every contestant."""
        return self.scheme.program(self.problem, self.guess)


class Own:
    """skyknot's interior point."""

    name = "own"

    def __init__(self, pose: Pose) -> None:
        self.program, self.tolerance = pose.program(), pose.tolerance
        self.prepared, self.settings = Prepared(self.program), InteriorPoint(max_seconds=SECONDS)

    def solve(self) -> Answer:
        """Solve from the cold start."""
        result = self.prepared.solve(self.settings, self.program.start, self.tolerance)
        return Answer(result.status.success, result.iterations, result.history[-1].objective)


class _Created:
    """A solver object of CasADi with its arguments."""

    def __init__(self, plugin: str, graph: dict[str, ca.MX], options: dict[str, Any]) -> None:
        quiet = {"print_time": False, "error_on_fail": False, "show_eval_warnings": False}
        self.solver = ca.nlpsol("peer", plugin, graph, quiet | options)
        self.arguments: dict[str, Any] = {}

    def solve(self) -> Answer:
        """Solve from the cold start."""
        answer = self.solver(**self.arguments)
        stats = self.solver.stats()
        return Answer(bool(stats["success"]), int(stats["iter_count"]), float(answer["f"]))


class IpoptMapped(_Created):
    """Ipopt on the identical program."""

    name, form = "ipopt", MAPPED

    def __init__(self, pose: Pose) -> None:
        nlp = nonlinear_program(pose.program())
        options = self.form | {
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.tol": pose.tolerance,
            "ipopt.constr_viol_tol": pose.tolerance,
            "ipopt.bound_relax_factor": 0.0,
            "ipopt.max_iter": InteriorPoint.max_iterations,
            "ipopt.max_wall_time": SECONDS,
        }
        super().__init__("ipopt", nlp.graph, options)
        self.arguments = {
            "x0": nlp.program.start[nlp.kept] / nlp.scale,
            "lbx": nlp.lower,
            "ubx": nlp.upper,
            "lbg": nlp.g_lower,
            "ubg": nlp.g_upper,
        }


class IpoptExpanded(IpoptMapped):
    """Ipopt on the identical program, written out."""

    name, form = "ipopt, expanded", EXPANDED


class IpoptCompiled(IpoptMapped):
    """Ipopt on the identical program, compiled."""

    name, form = "ipopt, compiled", COMPILED


class Fatrop(_Created):
    """Fatrop on multiple shooting."""

    name, form = "fatrop", MAPPED

    def __init__(self, pose: Pose) -> None:
        program = shooting_program(pose.problem, pose.scheme.segments, pose.guess)
        options = self.form | {
            "structure_detection": "auto",
            "equality": program.equality,
            "fatrop.print_level": 0,
            "fatrop.tolerance": pose.tolerance,
            "fatrop.max_iter": InteriorPoint.max_iterations,
        }
        super().__init__("fatrop", program.graph, options)
        self.arguments = {
            "x0": program.start,
            "lbx": program.lower,
            "ubx": program.upper,
            "lbg": program.g_lower,
            "ubg": program.g_upper,
        }


class FatropExpanded(Fatrop):
    """Fatrop on multiple shooting, written out."""

    name, form = "fatrop, expanded", EXPANDED


class FatropCompiled(Fatrop):
    """Fatrop on multiple shooting, compiled."""

    name, form = "fatrop, compiled", COMPILED


Builder = Callable[[Pose], Contestant]

ALL: dict[str, Builder] = {
    each.name: each
    for each in (
        Own,
        IpoptMapped,
        IpoptExpanded,
        IpoptCompiled,
        Fatrop,
        FatropExpanded,
        FatropCompiled,
    )
}
"""Builders of the contestants by name."""


def built(name: str, pose: Pose) -> tuple[Contestant, float]:
    """Return a contestant and the seconds it took to build."""
    began = time.perf_counter()
    contestant = ALL[name](pose)
    return contestant, time.perf_counter() - began
