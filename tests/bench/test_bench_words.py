"""Claim: tables, slopes and headline say what was measured, also where own loses."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from typer.testing import CliRunner

from skyknot.bench import tables
from skyknot.bench.growth_figure import write_growth_figure
from skyknot.bench.measurement import Contest, Timing
from skyknot.bench.peers import Answer
from skyknot.bench.suite import Plan, Results, measured, plan, slope
from skyknot.cli.exits import finite
from skyknot.cli.main import app


def timed(name, seconds, *, solved=True, iterations=10):
    return Timing(name, 0.1, [seconds] * 3, [seconds] * 3, Answer(solved, iterations, 1.0))


def race(mission, own, peer, segments=10):
    timings = {"own": timed("own", own), "peer": timed("peer", peer)}
    return Contest(mission, segments, timings)


FACTS = {"processor": "p", "processors": 2, "instruction_set": "v4", "load_average": [1, 1, 1]}


def results(contests, growth=()):
    return Results(list(contests), list(growth), {}, FACTS)


def test_the_headline_gives_the_range_of_ratios():
    text = results([race("hop", 0.01, 0.05), race("city", 0.01, 0.2)]).headline()
    assert "own is 5 to 20 times as fast on 2 missions; slower on none." in text


def test_the_headline_says_where_own_loses():
    text = results([race("hop", 0.01, 0.05), race("city", 0.4, 0.1)]).headline()
    assert "slower on city (4 times slower)" in text


def test_the_fastest_form_of_the_peers_counts():
    contest = race("hop", 0.01, 0.5)
    contest.timings["faster"] = timed("faster", 0.02)
    assert "own is 2 to 2 times as fast" in results([contest]).headline()


def test_the_headline_says_what_own_does_not_solve():
    contest = race("hop", 0.01, 0.05)
    contest.timings["own"] = timed("own", 0.01, solved=False)
    text = results([contest, race("city", 0.01, 0.2)]).headline()
    assert "own does not solve hop" in text


def test_a_peer_that_fails_has_no_time():
    contest = Contest(
        "hop", 10, {"own": timed("own", 0.1), "peer": timed("peer", 0.2, solved=False)}
    )
    assert math.isnan(contest.ratio("peer"))
    _, rows = tables.mission_rows([contest])
    assert rows[1][5] == "10, not solved"
    assert rows[1][-1] == "–"


def test_slopes_are_the_exponents_of_powers():
    N = np.array([25.0, 100.0, 400.0, 800.0])
    assert slope(list(zip(N, 0.003 * N**1.25, strict=True))) == pytest.approx(1.25)
    assert math.isnan(slope([(25, 1.0), (50, 2.0), (100, math.nan)]))


def test_the_growth_table_ends_with_the_exponents():
    growth = [race("hop", 1e-4 * n, 1e-5 * n**2, n) for n in (10, 20, 40)]
    head, rows = tables.growth_rows(results([], growth))
    assert [row[0] for row in rows] == ["10", "20", "40", "exponent of N"]
    assert rows[-1][1:] == ["1", "1", "", "2", "2", ""]
    assert all(len(row) == len(head) for row in rows)


def test_markdown_has_a_line_for_every_row():
    head, rows = tables.mission_rows([race("hop", 0.01, 0.05)])
    text = tables.in_markdown("Missions", head, rows).splitlines()
    assert text[0] == "## Missions"
    assert len(text) == 2 + 2 + len(rows)
    assert len({line.count("|") for line in text[2:]}) == 1


def test_numbers_have_three_digits_or_a_dash():
    assert [tables.number(v) for v in (0.012345, 12.34, 12345.6, math.nan)] == [
        "0.0123",
        "12.3",
        "12346",
        "–",
    ]


def test_a_small_bench_measures_solves_and_draws(tmp_path):
    asked = Plan(("yaw_point_transfer",), (6, 9, 12), ("own", "ipopt"), ("own",), 2, 5.0, 0)
    told = []
    found = measured(asked, told.append)
    assert [each.segments for each in found.growth] == [6, 9, 12]
    assert told == [*found.contests, *found.growth]
    assert all(t.answer.success for each in told for t in each.timings.values())
    facts = json.loads(json.dumps(finite(found.as_dict()), allow_nan=False))
    assert facts["headline"].startswith("Against the fastest peer form")
    assert set(facts["slopes"]["own"]) == {"time", "time_per_iteration"}
    write_growth_figure(found, tmp_path / "growth.png")
    assert (tmp_path / "growth.png").stat().st_size > 10_000


def test_the_full_plan_has_every_mission_and_the_quick_one_a_few():
    assert set(plan(quick=True).missions) < set(plan(quick=False).missions)
    assert "fatrop, compiled" in plan(quick=False, compiled=True).forms
    assert plan(quick=False, rounds=17).rounds == 17


def test_the_command_counts_cold_starts(tmp_path):
    asked = ["bench", "--robustness", "--cases", "2", "--out", str(tmp_path)]
    done = CliRunner().invoke(app, asked)
    assert done.exit_code == 0, done.output
    assert done.output.splitlines()[-1].startswith("Own solves")
    facts = json.loads((tmp_path / "robustness.json").read_text(encoding="utf-8"))
    assert facts["missions"] == 2
    assert [case["seed"] for case in facts["cases"]] == [0, 1]
