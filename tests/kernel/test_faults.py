"""Claim: whatever is asked of it, the interior point ends, says how, and says no untruth."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from skyknot.solvers import InteriorPoint
from skyknot.status import Status

DOORS = [
    ("euler", sk.Euler, {}),
    ("trapezoid", sk.Trapezoid, {}),
    ("trapezoid, hold", sk.Trapezoid, {"controls": "hold"}),
    ("hermite-simpson", sk.HermiteSimpson, {}),
    ("hermite-simpson, linear", sk.HermiteSimpson, {"controls": "linear"}),
    ("hermite-simpson, hold", sk.HermiteSimpson, {"controls": "hold"}),
]
every_door = pytest.mark.parametrize(
    ("door", "choice"), [row[1:] for row in DOORS], ids=[row[0] for row in DOORS]
)


def slide(**changes) -> sk.Problem:
    """Return a mass moved from rest to rest by 1 m in 1 s, least ∫a² (12 at the optimum)."""
    asked = {
        "name": "slide",
        "states": [sk.State("x", "m"), sk.State("v", "m/s")],
        "controls": [sk.Control("a", "m/s2")],
        "dynamics": lambda x, u: [x[1], u[0]],
        "horizon": 1.0,
        "initial": [0, 0],
        "final": [1, 0],
        "running_cost": lambda x, u: u[0] ** 2,
    }
    return sk.Problem(**(asked | changes))


def solved(problem: sk.Problem, scheme=None, **settings) -> sk.Solution:
    scheme = scheme or sk.HermiteSimpson(10)
    return sk.solve(problem, scheme, solver=InteriorPoint(**settings), tolerance=1e-7)


# --- not a number ---------------------------------------------------------------------------------

UNDEFINED = {
    "dynamics": (
        {"dynamics": lambda x, u: [x[1], u[0] + ca.log(x[0] - 5)]},
        "rate of v is not a number at t = 0",
    ),
    "pole": (
        {"dynamics": lambda x, u: [x[1], u[0] + 1 / x[0]]},
        "rate of v is not a number at t = 0",
    ),
    "cost": (
        {"running_cost": lambda x, u: ca.sqrt(-1 - x[0] ** 2)},
        "running cost is not a number at t = 0",
    ),
    "path": (
        {"path": [sk.PathConstraint("root", lambda x, u: ca.sqrt(x[0] - 3), lower=0)]},
        "'root' is not a number at t = 0",
    ),
    "terminal": ({"terminal_cost": lambda x, tf: ca.log(x[0] - 1.5)}, "terminal cost"),
}


@pytest.mark.parametrize("fault", UNDEFINED)
def test_a_model_undefined_at_the_start_is_an_evaluation_error_with_a_name(fault: str) -> None:
    changes, words = UNDEFINED[fault]
    solution = solved(slide(**changes))
    assert solution.status == Status.EVALUATION_ERROR
    assert words in solution.message


SLOPES = {
    "root of a free state": {
        "initial": [None, 0],
        "final": [None, None],
        "running_cost": lambda x, u: ca.sqrt(x[0]) + u[0] ** 2,
    },
    "root of a speed": {
        "final": [0, 0],
        "running_cost": lambda x, u: u[0] ** 2 + ca.sqrt(ca.fabs(x[1])),
    },
    "norm": {
        "initial": [None, None],
        "final": [0, 0],
        "running_cost": lambda x, u: ca.sqrt(x[0] ** 2 + x[1] ** 2) + u[0] ** 2,
    },
    "drag": {"dynamics": lambda x, u: [x[1], u[0] - ca.sqrt(ca.fabs(x[1])) * ca.sign(x[1])]},
}


@pytest.mark.parametrize("fault", SLOPES)
def test_an_undefined_slope_is_never_an_optimum(fault: str) -> None:
    solution = solved(slide(**SLOPES[fault]))
    assert solution.status == Status.EVALUATION_ERROR
    assert "slope" in solution.message


def test_steps_into_the_undefined_are_shortened() -> None:
    def cost(x, u):
        return u[0] ** 2 - 0.1 * ca.log(1.02 - x[0])  # the first full step overshoots x = 1.02

    start = sk.Trajectory([0.0, 1.0], [[0.0, 8.0], [1.0, 8.0]], [[0.0], [0.0]])
    solution = sk.solve(slide(running_cost=cost), sk.HermiteSimpson(10), guess=start)
    assert solution.success
    assert solution.kkt_residual < 1e-5


# --- bounds ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("far", [1e3, 1e5, 1e9, 1e15, 1e19])
@pytest.mark.parametrize("which", ["state_bounds", "control_bounds"])
def test_bounds_that_mean_nothing_change_nothing(which: str, far: float) -> None:
    solution = solved(slide(**{which: (-far, far)}))
    assert solution.success, solution.message
    assert solution.objective == pytest.approx(12.0, rel=1e-6)
    assert solution.iterations < 20


def test_a_slit_between_bounds_is_enough() -> None:
    slit = solved(slide(state_bounds=([0, None], [1 + 1e-9, None])))
    assert slit.success
    assert slit.objective == pytest.approx(12.0, rel=1e-6)


def test_fixed_controls_are_simply_flown() -> None:
    solution = solved(slide(control_bounds=(0.5, 0.5), final=None))
    assert solution.success
    np.testing.assert_allclose(solution.states[-1], [0.25, 0.5], atol=1e-9)
    np.testing.assert_array_equal(solution.controls, 0.5)


def test_fixed_controls_that_miss_the_end_are_infeasible() -> None:
    solution = solved(slide(control_bounds=(0.5, 0.5)))
    assert solution.status == Status.INFEASIBLE
    assert "defect of" in solution.message


def test_nothing_left_to_choose_is_solved_at_once() -> None:
    nothing = {"state_bounds": (0, 0), "control_bounds": (0, 0), "final": [0, 0]}
    solution = solved(slide(**nothing))
    assert solution.success
    assert solution.iterations == 0


def test_nothing_left_to_choose_and_wrong_is_infeasible() -> None:
    ends = [0, 1]
    wrong = {"state_bounds": (ends, ends), "initial": ends, "final": ends}
    assert solved(slide(control_bounds=(0, 0), **wrong)).status == Status.INFEASIBLE


def test_no_bounds_and_no_ends_leave_the_cheapest_rest() -> None:
    solution = solved(slide(initial=None, final=None))
    assert solution.success
    assert solution.objective == pytest.approx(0.0, abs=1e-12)


# --- meshes ---------------------------------------------------------------------------------------


@every_door
def test_one_segment_is_a_mesh(door, choice) -> None:
    scheme = door(1, **choice)
    solution = solved(slide(final=[None, 1.0]), scheme)
    assert solution.success, solution.message
    assert solution.states[-1, 1] == pytest.approx(1.0, abs=1e-7)


@every_door
@pytest.mark.parametrize("extras", [{}, {"rates": [50.0]}, {"horizon": sk.Free(0.9, 1.1)}])
def test_segments_of_a_billionth_do_no_harm(door, choice, extras) -> None:
    mesh = [0, 1e-9, 0.3, 0.5, 0.5 + 1e-9, 0.8, 1 - 1e-9, 1]
    solution = solved(slide(final=[1.0, None], **extras), door(mesh=mesh, **choice))
    assert solution.success, solution.message
    assert solution.max_defect < 1e-7


# --- objectives -----------------------------------------------------------------------------------


def test_no_objective_is_a_search_for_any_flight() -> None:
    solution = solved(slide(running_cost=None))
    assert solution.success, solution.message
    assert solution.max_defect < 1e-9


@pytest.mark.parametrize(
    "cost", [lambda x, u: u[0], lambda x, u: -ca.exp(x[0]), lambda x, u: x[0] - 1e-3 * x[0] ** 2]
)
def test_an_objective_without_bottom_ends_without_success(cost) -> None:
    solution = solved(slide(running_cost=cost, final=None))
    assert not solution.success
    assert solution.iterations < 200


def test_a_control_that_does_nothing_does_no_harm() -> None:
    solution = solved(slide(controls=["a", "idle"]))
    assert solution.success
    assert solution.objective == pytest.approx(12.0, rel=1e-6)


@pytest.mark.parametrize(("value", "success"), [(1.0, True), (3.0, False)])
def test_a_constant_path_row_is_met_or_not(value: float, success: bool) -> None:
    constant = sk.PathConstraint("constant", lambda x, u: value, upper=2.0)
    solution = solved(slide(path=[constant]))
    assert solution.success == success
    assert success or "'constant'" in solution.message


def test_contradicting_rows_are_infeasible_by_name() -> None:
    rows = [
        sk.PathConstraint("one", lambda x, u: u[0], 1.0, 1.0),
        sk.PathConstraint("two", lambda x, u: u[0], 2.0, 2.0),
    ]
    solution = solved(slide(path=rows, final=None))
    assert solution.status == Status.INFEASIBLE
    assert "'one'" in solution.message or "'two'" in solution.message


# --- limits and interrupts ------------------------------------------------------------------------


def pendulum() -> sk.Problem:
    """Return a problem that takes a few dozen iterations."""
    return slide(
        dynamics=lambda x, u: [x[1], -9.81 * ca.sin(x[0]) + u[0]],
        horizon=4.0,
        final=[np.pi, 0],
        control_bounds=(-3.0, 3.0),
    )


@pytest.mark.parametrize("most", [0, 1, 3])
def test_the_iteration_limit_is_kept(most: int) -> None:
    solution = solved(pendulum(), max_iterations=most)
    assert solution.status == Status.ITERATION_LIMIT
    assert solution.iterations == most


def test_the_time_limit_is_kept() -> None:
    solution = solved(pendulum(), max_seconds=0.0)
    assert solution.status == Status.TIME_LIMIT
    assert solution.iterations == 0


def test_a_callback_stops_the_solve() -> None:
    solution = sk.solve(pendulum(), sk.HermiteSimpson(10), callback=lambda row: row.iteration == 2)
    assert solution.status == Status.INTERRUPTED
    assert solution.iterations == 2


def test_an_error_in_a_callback_reaches_the_caller() -> None:
    def broken(_row):
        raise ZeroDivisionError("in the callback")

    with pytest.raises(ZeroDivisionError, match="in the callback"):
        sk.solve(slide(), sk.HermiteSimpson(10), callback=broken)


INTERRUPTED = """
import os, signal, time
import skyknot as sk
from kernel.test_faults import pendulum

def callback(row):
    if row.iteration == 2:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.1)

solution = sk.solve(pendulum(), sk.HermiteSimpson(10), callback=callback)
print(solution.status, solution.iterations)
"""


def test_an_interrupt_from_the_keyboard_returns_the_best_so_far() -> None:
    path = os.pathsep.join([str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(
        [sys.executable, "-c", INTERRUPTED],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        env=os.environ | {"PYTHONPATH": path},
    )
    assert run.stdout.split() == ["interrupted", "2"], run.stderr
