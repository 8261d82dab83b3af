"""Claim: the projected gradient meets the report's figures in its structured form, and only there.

The report's transfer, N = 100, from the straight guess: defect ≤ 1e-6 and optimality ≤ 1e-4 within
300 iterations. As printed, Algorithm 1 finds no feasible optimum and must say so.
"""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot import bank as problems
from skyknot import missions
from skyknot.kernel.evaluation import defects, evaluate, residuals
from skyknot.kernel.program import Multipliers
from skyknot.solvers.descent import Form
from skyknot.solvers.metric import Metric
from skyknot.solvers.plain_descent import PrintedDescent
from skyknot.solvers.projected_gradient import FORMS, stability
from skyknot.solvers.structured_descent import StructuredDescent
from solvers.probes import mover, status_after_ctrl_c

TRANSFER = missions.load("report_transfer")
MESH = sk.HermiteSimpson(100)


def transfer(segments: int = 100, **settings) -> sk.Solution:
    solver = sk.ProjectedGradient(**settings)
    return sk.solve(
        TRANSFER.problem, sk.HermiteSimpson(segments), solver, guess=TRANSFER.guess, tolerance=1e-6
    )


@pytest.fixture(scope="module")
def structured():
    return transfer()


@pytest.fixture(scope="module")
def exact():
    return sk.solve(TRANSFER.problem, MESH, "ipopt", guess=TRANSFER.guess, tolerance=1e-9)


def regulator() -> sk.Problem:
    A, B = np.array([[0.0, 1.0], [-1.0, -0.2]]), np.array([[0.0], [1.0]])
    return problems.regulator(A, B, np.diag([2.0, 0.5]), np.eye(1), np.array([1.0, 0.0]), 2.0)


# --- the report's figures -------------------------------------------------------------------------


def test_the_reports_figures_are_met_within_300_iterations(structured):
    assert structured.status == "solved"
    assert structured.iterations <= 300
    program = MESH.program(TRANSFER.problem, structured.trajectory)
    values = evaluate(program, structured.decision)
    assert np.abs(defects(program, structured.decision, values)).max() <= 1e-6
    found = residuals(program, structured.decision, Multipliers(**structured.multipliers), values)
    assert found.stationarity <= 1e-4
    assert found.complementarity <= 1e-9


def test_on_a_refined_mesh_its_answer_is_certified():
    solution = sk.solve(
        TRANSFER.problem, sk.HermiteSimpson(25), "projected-gradient", accuracy=1e-4
    )
    certificate = solution.verify()
    assert certificate.passed, certificate.sentence


def test_the_metric_is_factored_once_and_reused(structured):
    work = structured.record.work
    assert work["linearisations"] <= 10
    assert work["gradients"] <= 2 * structured.iterations
    # most factorisations find the first active set; later iterations need none or one
    assert work["factorisations"] <= 100


def test_the_objective_agrees_with_ipopt(structured, exact):
    assert exact.objective == pytest.approx(115.179019, rel=1e-8)  # the mission's reference
    assert structured.objective == pytest.approx(exact.objective, rel=1e-6)


def test_states_controls_and_costates_agree_with_ipopt(exact):
    tight = sk.solve(
        TRANSFER.problem, MESH, "projected-gradient", guess=TRANSFER.guess, tolerance=1e-9
    )
    assert tight.status == "solved"
    np.testing.assert_allclose(tight.states, exact.states, atol=1e-5)
    np.testing.assert_allclose(tight.controls, exact.controls, atol=1e-4)
    scale = np.abs(exact.costates).max(axis=0)
    np.testing.assert_allclose(tight.costates / scale, exact.costates / scale, atol=1e-5)


def test_bounds_hold_exactly_and_their_multipliers_push_outward(structured):
    program = MESH.program(TRANSFER.problem, structured.trajectory)
    z, bounds = structured.decision, structured.multipliers["bounds"]
    assert np.all(z >= program.lower)
    assert np.all(z <= program.upper)
    free = program.lower < program.upper
    assert np.count_nonzero(bounds[free]) > 10
    assert np.all(z[free & (bounds > 0)] == program.upper[free & (bounds > 0)])
    assert np.all(z[free & (bounds < 0)] == program.lower[free & (bounds < 0)])


@pytest.mark.parametrize("segments", [25, 200])
def test_the_iterations_hardly_depend_on_the_mesh(segments):
    solution = transfer(segments)
    assert solution.success
    assert solution.iterations <= 60


def test_a_free_horizon_with_fixed_ends_is_solved():
    reference = problems.minimum_time()
    mesh = sk.HermiteSimpson(20)
    solution = sk.solve(reference.problem, mesh, "projected-gradient", guess=reference.guess)
    exact = sk.solve(reference.problem, mesh, "ipopt", guess=reference.guess)
    assert solution.success, solution.message
    assert solution.objective == pytest.approx(exact.objective, rel=1e-4)


# --- exactness ------------------------------------------------------------------------------------


def test_a_regulator_is_solved_in_one_step():
    solution = sk.solve(regulator(), sk.HermiteSimpson(30), "projected-gradient")
    exact = sk.solve(regulator(), sk.HermiteSimpson(30), "ipopt", tolerance=1e-10)
    assert solution.success
    assert solution.iterations == 1
    assert solution.record.work["factorisations"] == 1
    assert solution.objective == pytest.approx(exact.objective, rel=1e-9)


def test_the_history_has_a_record_an_iteration(structured):
    history = structured.history
    assert history[:, 0].tolist() == list(range(structured.iterations + 1))
    assert history[-1, 1] == pytest.approx(structured.objective, rel=1e-12)
    assert history[-1, 2] == pytest.approx(structured.max_defect, rel=1e-6)
    assert history[-1, 3] == pytest.approx(structured.kkt_residual, rel=1e-6)
    assert np.all(history[1:, 5] > 0)


# --- step lengths ---------------------------------------------------------------------------------


def test_the_full_step_is_unstable_and_the_detail_says_so():
    solution = transfer(step_length=1.0, max_iterations=60)
    assert solution.status == "iteration limit"
    assert "The fixed step length 1 is unstable there by equation (15)" in solution.message
    assert "Leave step_length out for Barzilai-Borwein steps" in solution.message


def test_a_stable_fixed_step_takes_more_iterations_than_barzilai_and_borwein(structured):
    solution = transfer(step_length=0.3)
    assert solution.success
    assert solution.iterations > structured.iterations
    assert solution.objective == pytest.approx(structured.objective, rel=1e-7)


@pytest.mark.parametrize("alpha", [0.4, 1.0, 1.7, 2.5])
def test_the_stability_test_in_the_hessians_own_metric_is_one_minus_alpha(alpha):
    metric = Metric(sk.HermiteSimpson(10).program(regulator(), line_of(regulator())))
    form: Form = StructuredDescent(metric, metric.no_multipliers, 1e-6, 1e-4)
    assert stability(form, form.start, alpha) == pytest.approx(abs(1 - alpha), abs=1e-3)


@pytest.mark.parametrize("alpha", [0.3, 5.0, 30.0])
def test_the_stability_test_of_the_printed_form_agrees_with_eigenvalues(alpha):
    program = sk.HermiteSimpson(10).program(regulator(), line_of(regulator()))
    form: Form = PrintedDescent(Metric(program))
    # ∇²J is diagonal: duration times cost weights times Q and R
    eigenvalues = 2.0 * np.outer(program.point_cost, [2.0, 0.5, 1.0])
    exact = np.max(np.abs(1 - alpha * eigenvalues))
    assert stability(form, form.start, alpha) == pytest.approx(exact, rel=2e-2)


def line_of(problem: sk.Problem) -> sk.Trajectory:
    return sk.Trajectory([0.0, 2.0], [[1.0, 0.0], [0.0, 0.0]], [[0.0], [0.0]])


# --- the other forms ------------------------------------------------------------------------------


@pytest.mark.parametrize("step_length", [None, 1e-3, 1.0])
def test_the_printed_form_never_claims_what_it_has_not(step_length):
    solution = transfer(form="printed", step_length=step_length, max_iterations=300)
    assert solution.status in ("stalled", "iteration limit")
    assert not solution.success
    assert "knows nothing of the defects nor of fixed states" in solution.message


def test_the_printed_form_hovers_at_the_goal_from_the_first_instant():
    """Line 8 is met, since a hover has no defects; the start is the price."""
    solution = transfer(form="printed", max_iterations=300)
    assert solution.status == "stalled"
    assert solution.max_defect < 1e-6
    assert solution.objective == pytest.approx(0.0, abs=1e-6)
    assert solution.states[0, :3] == pytest.approx([8.0, 6.0, -5.0], abs=1e-4)
    assert "The value of x in segment 0 lies 8 outside its bounds" in solution.message


def test_the_printed_form_refuses_an_unstable_step_before_it_iterates():
    solution = transfer(form="printed", step_length=1.0)
    assert solution.iterations == 0
    assert "unstable there by equation (15)" in solution.message


def test_the_printed_form_may_say_solved_where_nothing_is_to_be_done():
    still = problems.regulator(np.zeros((1, 1)), np.eye(1), np.eye(1), np.eye(1), np.zeros(1), 1.0)
    solution = sk.solve(still, sk.HermiteSimpson(5), sk.ProjectedGradient(form="printed"))
    assert solution.success
    assert solution.kkt_residual == 0.0


def test_the_form_with_multipliers_solves_a_small_regulator():
    mesh = sk.HermiteSimpson(5)
    solution = sk.solve(
        regulator(), mesh, sk.ProjectedGradient(form="multipliers", max_iterations=20000)
    )
    exact = sk.solve(regulator(), mesh, "ipopt", tolerance=1e-10)
    assert solution.success, solution.message
    assert solution.iterations > 100  # against one in the structured form
    assert solution.objective == pytest.approx(exact.objective, rel=1e-5)


def test_the_form_with_multipliers_says_that_it_has_not_solved_the_transfer():
    solution = transfer(20, form="multipliers", max_iterations=300)
    assert solution.status in ("stalled", "iteration limit")
    assert "The largest violation is" in solution.message


# --- refusals and interruptions -------------------------------------------------------------------


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    ("words", "extras"),
    [
        (
            "path constraint on 'fence'",
            {"path": [sk.PathConstraint("fence", lambda x, u: x[0], lower=0.1)]},
        ),
        ("rate bound on 'push'", {"rates": (-5.0, 5.0)}),
    ],
)
def test_what_cannot_be_held_is_refused_by_name_in_five_parts(form, words, extras):
    with pytest.raises(sk.UserError, match="The projected gradient cannot hold a") as caught:
        sk.solve(mover(**extras), MESH, sk.ProjectedGradient(form=form))
    assert words in caught.value.where
    assert all(part.strip() for part in caught.value.parts().values())
    assert "interior-point" in caught.value.do


def test_a_form_that_does_not_exist_is_a_user_error():
    with pytest.raises(sk.UserError, match="no form of this name") as caught:
        sk.ProjectedGradient(form="momentum")
    assert caught.value.found == "'momentum'"
    assert "'structured' or 'multipliers' or 'printed'" in caught.value.expected


@pytest.mark.parametrize(
    "settings",
    [
        {"step_length": 0.0},
        {"optimality_tolerance": -1.0},
        {"max_iterations": -1},
        {"max_seconds": 0.0},
        {"step_length": float("nan")},
    ],
)
def test_settings_without_room_to_iterate_are_refused_by_name(settings):
    with pytest.raises(sk.UserError, match="needs room to iterate") as caught:
        sk.ProjectedGradient(**settings)
    assert caught.value.where == f"ProjectedGradient.{next(iter(settings))}"


@pytest.mark.parametrize("form", FORMS)
def test_a_callback_stops_every_form(form):
    solution = transfer(10, form=form, max_iterations=50)
    stopped = sk.solve(
        TRANSFER.problem,
        sk.HermiteSimpson(10),
        sk.ProjectedGradient(form=form),
        guess=TRANSFER.guess,
        callback=lambda record: record.iteration == 2,
    )
    assert solution.iterations > 2
    assert stopped.status == "interrupted"
    assert stopped.iterations == 2


def test_ctrl_c_during_the_solve_returns_an_interrupted_solution():
    assert (
        status_after_ctrl_c("sk.ProjectedGradient(form='multipliers', max_iterations=100000)")
        == "interrupted"
    )
