"""Claim: every claim of the source report is run, finite, judged by its numbers, and kept."""

from __future__ import annotations

import json
import math
import re
import shutil

import numpy as np
import pytest
from typer.testing import CliRunner

import skyknot as sk
from skyknot.cli.main import app
from skyknot.paper import EXPERIMENTS, VERDICTS, Scale, run_claims
from skyknot.paper import run as runs
from skyknot.paper.base import (
    CHANGED,
    FAILS,
    HOLDS,
    Claim,
    Finding,
    Measure,
    judged,
    slope,
    written,
)
from skyknot.paper.stability import cost_hessian, pade, stability_function
from skyknot.paper.transfers import (
    VEHICLE,
    report_flight,
    scheme,
    seeded_goals,
    transfer,
    tried,
)

QUICK = Scale(quick=True)


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("paper")
    run_claims(place, QUICK)
    return place


@pytest.fixture(scope="session")
def findings(folder):
    return {name: runs.kept_or_run(folder, name, QUICK) for name in EXPERIMENTS}


def number(finding, name):
    return next(m.value for m in finding.claim.measured if m.name.startswith(name))


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_every_claim_has_finite_numbers_words_and_a_verdict(findings, name):
    claim = findings[name].claim
    assert claim.verdict in VERDICTS
    assert claim.measured
    assert all(math.isfinite(measure.value) for measure in claim.measured)
    assert all((claim.claim, claim.section, claim.said, claim.how, claim.why))


def test_every_equation_that_the_report_claims_something_by_is_judged(findings):
    told = " ".join(finding.claim.section for finding in findings.values())
    for equation in (13, 15, 16, 18, 20, 21, 22, 26, 27, 28):
        assert f"({equation})" in told
    for section in ("4", "5.1", "5.2", "5.3", "5.4", "6"):
        assert any(f.claim.section.split(",")[0] == section for f in findings.values())


def test_the_transfer_judged_is_the_mission_of_the_library():
    mission = sk.missions.load("report_transfer")
    theirs = sk.solve(mission.problem, sk.HermiteSimpson(100))
    assert report_flight(100).objective == pytest.approx(theirs.objective, rel=1e-8)
    assert np.array_equal(VEHICLE.rotor_positions, mission.vehicle.rotor_positions)
    assert transfer().state_names == mission.problem.state_names


def test_orders_are_four_and_five_where_three_and_four_are_said(findings):
    assert number(findings["global_order"], "order of the states") == pytest.approx(4, abs=0.2)
    assert number(findings["local_order"], "order of one segment") == pytest.approx(5, abs=0.2)
    assert findings["global_order"].claim.verdict == CHANGED
    assert findings["local_order"].claim.verdict == CHANGED


def test_the_stability_function_of_the_table_is_the_pade_approximant():
    z = np.array([-0.5, -5.0, -50.0, 2j, 1 - 3j])
    assert stability_function(z) == pytest.approx(pade(z), rel=1e-12)
    small = 1e-2
    gap = np.exp(small) - stability_function(np.array([small]))[0].real
    assert gap == pytest.approx(small**5 / 720, rel=0.02)


def test_the_stability_region_is_the_left_half_plane(findings):
    finding = findings["stability_region"]
    assert number(finding, "stable share of the left") == 1
    assert number(finding, "stable share of the right") == 0
    assert finding.claim.verdict == HOLDS


def test_the_hessian_of_the_cost_is_that_of_its_quadrature():
    H, target = cost_hessian(4)
    assert H.size == target.size == 9 * 16
    assert np.all(H > 0)
    # ∫ 2 Q dt over ten seconds, and 2 Q_f: the weight of x is 1 in Q
    assert H.reshape(9, 16)[:, 0].sum() == pytest.approx(2 * 10 + 2 * 100)


def test_the_step_size_bound_parts_descent_from_growth(findings):
    below, above = findings["step_size_test"].data["growth"]
    assert below < 1 < above


def test_the_unknowns_are_counted_not_quoted(findings):
    finding = findings["decision_vector"]
    assert number(finding, "explicit Euler") == 101 * 12 + 100 * 4
    assert number(finding, "Hermite–Simpson") == 201 * 16
    assert finding.claim.verdict == CHANGED


def test_the_minimum_time_is_met_and_the_control_minimises_the_hamiltonian(findings):
    finding = findings["minimum_time"]
    assert number(finding, "T computed") == pytest.approx(np.sqrt(30), rel=2e-3)
    assert number(finding, "nodes where") > 97
    assert finding.claim.verdict == HOLDS


def test_the_flight_drifts_by_metres_at_100_segments_and_passes_with_as_many_graded(findings):
    finding = findings["forward_simulation"]
    rows = {(row["mesh"], row["segments"]): row for row in finding.data["rows"]}
    equal, graded = rows["equal", 100], rows["graded", 100]
    assert equal["miss"] > 1 > 0.1 > graded["miss"]
    assert equal["rms"] > 1
    assert graded["rms"] < 0.02
    assert not equal["certified"]
    assert graded["certified"]
    refined = next(row for row in finding.data["rows"] if row["mesh"] == "refined")
    assert refined["segments"] < 200
    assert refined["rms"] < 0.02
    assert refined["certified"]
    assert max(equal["defect"], graded["defect"]) <= 1e-6
    assert rows["equal", 400]["rms"] < 0.02
    assert finding.claim.verdict == CHANGED


def test_the_initial_costate_is_the_slope_of_the_optimum(findings):
    finding = findings["sensitivity"]
    assert number(finding, "costate against solving anew") < 1e-3
    assert max(finding.data["ratios"]) <= 1.05 * number(finding, "γ = ‖p(0)‖")


def test_a_gradient_converges_linearly_and_newton_quadratically(findings):
    finding = findings["quadratic_near_solution"]
    assert number(finding, "projected gradient: exponent") == pytest.approx(1.0, abs=0.35)
    assert number(findings["quadratic_near_solution"], "interior point: exponent, without") > 1.7


def test_verdicts_follow_from_their_conditions():
    assert [judged(True), judged(False, True), judged(False)] == [HOLDS, CHANGED, FAILS]
    assert slope([1, 2, 4], [3, 24, 192]) == pytest.approx(3)


def test_a_finding_survives_its_file():
    claim = Claim("c", "1", "s", (Measure("m", 1.5e-3, "s"),), "h", HOLDS, "w")
    finding = Finding(claim, {"h": [0.1, 0.2]})
    assert Finding.from_dict(json.loads(json.dumps(finding.as_dict()))) == finding
    assert claim.measured[0].text == "m: 0.0015 s"


def test_many_values_are_told_by_median_and_spread():
    measure = Measure.of_many("cost", [1.0, 2.0, 3.0, 4.0, 1e-5], "J")
    assert measure.text == "cost, median: 2 (0.4 to 3.6) J"
    claim = Claim("c", "1", "s", (measure,), "h", HOLDS, "w")
    assert Finding.from_dict(json.loads(json.dumps(Finding(claim).as_dict()))).claim == claim


@pytest.mark.parametrize(
    ("value", "text"), [(-3.25e-7, "−3.25e−7"), (1e12, "1e12"), (0.5, "0.5"), (0.0, "0")]
)
def test_numbers_are_written_for_people(value, text):
    assert written(value) == text


def test_the_structured_form_alone_reaches_the_figures_that_the_report_gives(findings):
    """Defect ≤ 1e-6, optimality ≤ 1e-4 within 300 iterations, and the objective of Ipopt."""
    finding = findings["optimality_after_iterations"]
    assert number(finding, "optimality error (20), structured") <= 1e-4
    assert number(finding, "largest defect (19), structured") <= 1e-6
    assert number(finding, "iterations, structured") <= 100
    assert number(finding, "objective off that of Ipopt") < 1e-4
    assert number(finding, "optimality error (20), with multipliers") > 1e-2


def test_as_printed_the_algorithm_leaves_the_start_and_says_that_it_has_not_solved(findings):
    finding = findings["iterations_and_time"]
    assert number(finding, "x(0) as printed") > 1
    assert "'stalled'" in finding.claim.why
    assert finding.claim.verdict == CHANGED
    histories = finding.data
    assert set(histories) == {"structured", "printed", "multipliers"}
    assert histories["structured"]["optimality"][-1] < histories["multipliers"]["optimality"][-1]


def test_the_saving_is_measured_on_many_transfers_against_many_fixed_steps(findings):
    saved = findings["barzilai_borwein_saving"].data["saved"]
    assert all(len(shares) == 3 for shares in saved.values())
    assert len(seeded_goals(20)) == len(set(seeded_goals(20))) == 20


def test_the_reduced_model_is_solved_in_fewer_iterations_but_does_not_start_at_rest(findings):
    finding = findings["reduced_order"]
    assert number(finding, "iterations, reduced") < number(finding, "iterations, full")
    assert number(finding, "state asked for at t = 0") > 0.1
    assert finding.claim.verdict != HOLDS


def test_what_is_kept_is_not_run_again(folder, monkeypatch):
    def refuse(_scale):
        raise AssertionError("run again")

    monkeypatch.setitem(runs.EXPERIMENTS, "decision_vector", refuse)
    kept = runs.kept_or_run(folder, "decision_vector", QUICK)
    assert kept.claim.claim == "Size of the decision vector"
    with pytest.raises(AssertionError, match="run again"):
        runs.kept_or_run(folder, "decision_vector", Scale())


def test_a_broken_file_is_run_again(tmp_path):
    (tmp_path / runs.KEPT).mkdir()
    path = tmp_path / runs.KEPT / "decision_vector.json"
    path.write_text("{")
    runs.kept_or_run(tmp_path, "decision_vector", QUICK)
    assert json.loads(path.read_text())["quick"] is True


def test_the_page_holds_every_claim_and_figure_and_loads_nothing(folder):
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert page.count('class="said"') == len(EXPERIMENTS)
    assert sorted(re.findall(r"<h3>Figure (\d+)\.", page), key=int) == [
        str(n) for n in range(1, 16)
    ]
    assert not re.search(r"(src|href)=\"http", page)
    assert len(list(folder.glob("figure-*.svg"))) == 15
    assert len(json.loads((folder / "claims.json").read_text())["claims"]) == len(EXPERIMENTS)


def test_the_command_tells_every_claim_and_ends_with_the_count(folder, tmp_path, monkeypatch):
    shutil.copytree(folder / runs.KEPT, tmp_path / runs.KEPT)
    monkeypatch.setattr(runs, "numbered_figures", lambda _findings, _scale: [])
    told = CliRunner().invoke(app, ["paper", "--quick", "--out", str(tmp_path)])
    assert told.exit_code == 0, told.output
    lines = told.output.strip().splitlines()
    assert lines[0] == f"1 of {len(EXPERIMENTS) + 1}: bounds respected"
    assert lines[-1].startswith(f"{len(EXPERIMENTS)} claims run: ")


def test_an_interrupted_run_says_what_is_kept_and_is_taken_up_there(tmp_path, monkeypatch):
    def press(_scale):
        raise KeyboardInterrupt

    (tmp_path / runs.KEPT).mkdir()
    monkeypatch.setitem(runs.EXPERIMENTS, next(iter(EXPERIMENTS)), press)
    told = CliRunner().invoke(app, ["paper", "--quick", "--out", str(tmp_path)])
    assert told.exit_code == 130
    assert f"Interrupted: 0 of {len(EXPERIMENTS)} claims are kept" in told.output


def test_an_interrupted_solve_is_no_measurement():
    def press(_record):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tried(transfer(), scheme(10), callback=press)


def test_the_command_refuses_a_folder_of_others(tmp_path):
    (tmp_path / "diary.txt").write_text("mine")
    told = CliRunner().invoke(app, ["paper", "--quick", "--out", str(tmp_path)])
    assert told.exit_code == 2
    assert "not a run of skyknot paper" in told.output
