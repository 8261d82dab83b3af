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
from skyknot.paper.base import CHANGED, FAILS, HOLDS, Claim, Finding, Measure, judged, slope
from skyknot.paper.stability import cost_hessian, pade, stability_function
from skyknot.paper.transfers import VEHICLE, report_flight, transfer

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


def test_the_flight_drifts_by_metres_at_100_segments_and_passes_on_a_finer_mesh(findings):
    finding = findings["forward_simulation"]
    assert number(finding, "e_RMS at N = 100") > 1
    assert number(finding, "e_RMS at N = 400") < 0.02
    assert finding.claim.verdict == CHANGED


def test_the_initial_costate_is_the_slope_of_the_optimum(findings):
    finding = findings["sensitivity"]
    assert number(finding, "costate against solving anew") < 1e-3
    assert max(finding.data["ratios"]) <= 1.05 * number(finding, "γ = ‖p(0)‖")


def test_without_bounds_the_last_steps_converge_quadratically(findings):
    assert number(findings["quadratic_near_solution"], "exponent, without") > 1.7


def test_verdicts_follow_from_their_conditions():
    assert [judged(True), judged(False, True), judged(False)] == [HOLDS, CHANGED, FAILS]
    assert slope([1, 2, 4], [3, 24, 192]) == pytest.approx(3)


def test_a_finding_survives_its_file():
    claim = Claim("c", "1", "s", (Measure("m", 1.5e-3, "s"),), "h", HOLDS, "w")
    finding = Finding(claim, {"h": [0.1, 0.2]})
    assert Finding.from_dict(json.loads(json.dumps(finding.as_dict()))) == finding
    assert claim.measured[0].text == "m: 0.0015 s"


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
    assert re.findall(r"<h3>Figure (\d+)\.", page) == [str(n) for n in range(2, 13)]
    assert not re.search(r"(src|href)=\"http", page)
    assert len(list(folder.glob("figure-*.svg"))) == 11
    assert len(json.loads((folder / "claims.json").read_text())["claims"]) == len(EXPERIMENTS)


def test_the_command_tells_every_claim_and_ends_with_the_count(folder, tmp_path, monkeypatch):
    shutil.copytree(folder / runs.KEPT, tmp_path / runs.KEPT)
    monkeypatch.setattr(runs, "numbered_figures", lambda _findings, _scale: [])
    told = CliRunner().invoke(app, ["paper", "--quick", "--out", str(tmp_path)])
    assert told.exit_code == 0, told.output
    last = told.output.strip().splitlines()[-1]
    assert last.startswith(f"{len(EXPERIMENTS)} claims run: ")


def test_the_command_refuses_a_folder_of_others(tmp_path):
    (tmp_path / "diary.txt").write_text("mine")
    told = CliRunner().invoke(app, ["paper", "--quick", "--out", str(tmp_path)])
    assert told.exit_code == 2
    assert "not a run of skyknot paper" in told.output
