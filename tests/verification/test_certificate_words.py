"""A certificate says its verdict in words, in a table and as data."""

import json
import math

import pytest
from drone_on_rail import problem

import skyknot as sk
from skyknot.errors import UserError
from skyknot.models.vehicle import KINDS
from skyknot.problem.problem import Problem
from skyknot.solve import solve
from skyknot.trajectory import Trajectory
from skyknot.transcription import HermiteSimpson
from skyknot.verification import Certificate, Check, Limits, certify
from skyknot.verification.tolerances import CLASSES


@pytest.fixture(scope="module")
def answer():
    return solve(problem(), HermiteSimpson(40)).trajectory


def test_the_sentence_of_a_pass_names_the_check_closest_to_its_limit(answer):
    certificate = certify(problem(), answer)
    closest = max(certificate.checks.values(), key=lambda check: check.load)
    assert certificate.sentence.startswith(f"Certified: all {len(certificate.checks)} checks hold")
    assert f"'{closest.name}'" in certificate.sentence


def test_the_sentence_of_a_failure_names_the_worst_its_numbers_and_the_place(answer):
    certificate = certify(problem(parameters={"drag": 0.3}), answer)
    worst = certificate.failures[0]
    assert certificate.sentence.startswith("Not certified: ")
    assert f"'{worst.name}' is {worst.value:.3g}" in certificate.sentence
    assert worst.worst in certificate.sentence


def test_the_table_has_a_line_for_every_check_and_the_verdict_last(answer):
    certificate = certify(problem(rates=[1.0]), answer)
    lines = certificate.table().splitlines()
    assert len(lines) == len(certificate.checks) + 2 + len(certificate.notes)
    assert lines[-1] == certificate.sentence
    marks = {line.split("  ")[1]: line[:4] for line in lines[1 : 1 + len(certificate.checks)]}
    assert marks["rates"] == "FAIL"
    assert marks["defects"] == "pass"


def test_every_check_says_how_it_was_measured_in_one_sentence(answer):
    for check in certify(problem(), answer).checks.values():
        assert check.how.endswith(".")
        assert ". " not in check.how
        assert check.load < 1


def test_what_was_not_checked_is_said(answer):
    certificate = certify(problem(), answer)
    assert certificate.notes == (
        "Optimality was not checked: the answer came without multipliers.",
    )
    assert certificate.notes[0] in certificate.table().splitlines()
    assert certificate.as_dict()["notes"] == list(certificate.notes)


def test_the_data_survive_json_even_when_a_value_is_not_finite():
    asked = Problem("blow-up", ["x"], ["u"], lambda x, u: [x[0] ** 2 + u[0]], 2.0)
    guess = Trajectory([0, 1, 2], [[1], [2], [3]], [[0], [0], [0]])
    certificate = certify(asked, guess)
    data = json.loads(json.dumps(certificate.as_dict(), allow_nan=False))
    assert data["passed"] is False
    assert data["checks"]["open-loop flight"]["value"] is None
    assert data["checks"]["defects"]["unit"] == ""
    assert certificate.failures[0].load == math.inf


def test_other_limits_change_the_verdict_and_not_the_value(answer):
    strict = certify(problem(), answer, limits=Limits(flight_rms=1e-12))
    usual = certify(problem(), answer)
    flown = strict.checks["open-loop flight"]
    assert not flown.passed
    assert flown.limit == 1e-12
    assert flown.value == usual.checks["open-loop flight"].value


def test_a_certificate_of_nothing_does_not_pass():
    assert not Certificate("nothing").passed
    assert Certificate("nothing").sentence == "Not certified: nothing was checked."


def test_the_load_of_a_value_without_room_is_infinite():
    check = Check("ends", 1e-3, 0.0, "m", False, "Compared.", "x at 0 s")
    assert check.load == math.inf


def test_craft_that_carry_people_have_limits_of_their_own(answer):
    large = sk.vehicles.load("nasa_six_passenger")
    assert Limits.of(large).clearance == 0.1
    assert Limits.of(large, clearance=0.02).clearance == 0.02
    assert Limits.of(sk.vehicles.load("crazyflie")) == Limits.of(None) == Limits()
    asked = problem()
    asked.vehicle = large
    assert certify(asked, answer).checks["open-loop flight"].limit == 0.1
    assert set(CLASSES) == set(KINDS)


def test_information_is_not_what_comes_closest_to_its_limit():
    told = Check("told", 99, 100, "%", True, "Told.", "", information=True)
    judged = Check("judged", 1, 100, "m", True, "Judged.", "")
    certificate = Certificate("both", {"told": told, "judged": judged})
    assert "'judged', at 1 %" in certificate.sentence
    assert certificate.table().splitlines()[1].startswith("info  told")


def test_a_limit_must_be_positive():
    with pytest.raises(UserError, match=r"(?s)must be positive.*limits\.dynamics.*0"):
        Limits(dynamics=0.0)


def test_a_trajectory_of_another_problem_is_refused_with_its_columns(answer):
    other = Problem("other", ["x"], ["u"], lambda x, u: [u[0]], 2.0)
    with pytest.raises(UserError, match=r"(?s)does not fit.*2 states and 1 controls.*1 states"):
        certify(other, answer)
