"""Claim: what is not certified stays in the house, unless marked; files are whole or absent."""

from __future__ import annotations

import errno
from dataclasses import replace

import pytest

from export.flights import CERTIFIED, FAILED, flown
from export.readers import HOME, READERS
from report.gallery import flight, rail
from skyknot.errors import UserError
from skyknot.export import FORMATS, Origin, base, uncertified_because, write_export
from skyknot.export.writing import MARK
from skyknot.status import Status

FLIGHT = flown("asymmetric path")


def write(path, name, solution=FLIGHT, **options):
    given = {"certificate": CERTIFIED, "origin": Origin(*HOME)} | options
    return write_export(solution, path, name, **given)


@pytest.mark.parametrize("name", FORMATS)
def test_a_failing_certificate_stops_the_export(name, tmp_path):
    path = tmp_path / FORMATS[name].file_name
    with pytest.raises(UserError, match="not certified") as caught:
        write(path, name, certificate=FAILED)
    assert "arrival" in caught.value.found
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("name", FORMATS)
def test_an_uncertified_file_says_so_and_a_certified_one_does_not(name, tmp_path):
    path = tmp_path / FORMATS[name].file_name
    marked = write(path, name, certificate=FAILED, uncertified=True)
    assert MARK in READERS[name](path).text
    assert marked.verdict.startswith(MARK)
    write(path, name, uncertified=True)
    assert MARK not in READERS[name](path).text
    assert "certified" in READERS[name](path).text.lower()


@pytest.mark.parametrize("name", FORMATS)
def test_the_same_flight_gives_the_same_bytes(name, tmp_path):
    first, second = tmp_path / "a", tmp_path / "b"
    write(first, name)
    write(second, name)
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.parametrize("name", FORMATS)
def test_the_file_names_what_was_flown(name, tmp_path):
    write(tmp_path / "file", name)
    assert "asymmetric path" in READERS[name](tmp_path / "file").text


def test_an_unsolved_flight_is_not_certified():
    unsolved = replace(FLIGHT, status=Status.ITERATION_LIMIT)
    assert "not solved" in uncertified_because(unsolved)


def test_a_flight_without_its_problem_needs_a_certificate():
    assert "not at hand" in uncertified_because(replace(FLIGHT, problem=None))
    assert uncertified_because(replace(FLIGHT, problem=None), CERTIFIED) == ""


def test_a_certificate_is_made_when_none_is_given():
    assert uncertified_because(rail()) == ""
    shifted = rail().trajectory
    shifted = replace(shifted, states=shifted.states + 0.1)
    assert "checks fail" in uncertified_because(replace(rail(), trajectory=shifted))


@pytest.mark.parametrize("name", [n for n, known in FORMATS.items() if "origin" in known.needs])
def test_a_place_on_earth_is_asked_for(name, tmp_path):
    with pytest.raises(UserError, match="needs a place on Earth") as caught:
        write(tmp_path / "file", name, origin=None)
    assert "--origin LAT,LON,ALT" in caught.value.do


@pytest.mark.parametrize("name", [n for n, known in FORMATS.items() if "rotors" in known.needs])
def test_rotors_are_asked_for(name, tmp_path):
    with pytest.raises(UserError, match="does not tell") as caught:
        write(tmp_path / "file", name, replace(FLIGHT, problem=None))
    assert caught.value.where == "rotors"


@pytest.mark.parametrize("name", [n for n, known in FORMATS.items() if "attitude" in known.needs])
def test_attitudes_are_asked_for(name, tmp_path):
    with pytest.raises(UserError, match="does not tell") as caught:
        write(tmp_path / "file", name, replace(flight("yaw"), problem=None))
    assert caught.value.where == "attitude"


@pytest.mark.parametrize(
    ("to", "file", "what"),
    [
        ("cvs", "flight.csv", "no such export format"),
        (None, "flight.doc", "format is not clear"),
        (None, "flight.tlog", "format is not clear"),
        (None, "flight", "format is not clear"),
    ],
)
def test_an_unknown_format_is_refused(to, file, what, tmp_path):
    with pytest.raises(UserError, match=what) as caught:
        write(tmp_path / file, to)
    assert ("mavlink-attitude" if file.endswith("tlog") else "csv") in caught.value.expected


@pytest.mark.parametrize("name", FORMATS)
def test_a_frame_that_the_format_does_not_have_is_refused(name, tmp_path):
    with pytest.raises(UserError, match="cannot be written in this frame"):
        write(tmp_path / "file", name, frame="body")


def test_the_ending_tells_the_format(tmp_path):
    assert write(tmp_path / "my.csv", None).format.name == "csv"
    assert FLIGHT.export(tmp_path / "mine.csv", certificate=CERTIFIED).samples == 401


def test_a_full_disk_leaves_the_old_file_and_no_litter(tmp_path, monkeypatch):
    path = tmp_path / "flight.csv"
    write(path, "csv")
    before = path.read_bytes()

    def full(self, content):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(type(path), "write_bytes", full)
    with pytest.raises(UserError, match="cannot be written") as caught:
        write(path, "csv", rate=10)
    assert "No space left" in caught.value.found
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["flight.csv"]


def test_a_missing_library_is_told_with_its_extra():
    with pytest.raises(UserError, match="Writing bags needs a library") as caught:
        base.optional("absent_library.part", "Writing bags")
    assert "pip install 'skyknot[export]'" in caught.value.do
    assert caught.value.where == "absent_library"
