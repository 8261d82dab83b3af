"""Whatever is wrong with a mission file is told in five parts, at its line."""

from __future__ import annotations

from pathlib import Path

import pytest
from broken_missions import BROKEN, SOUND, Broken
from hypothesis import given
from hypothesis import strategies as st

from skyknot import missions
from skyknot.errors import UserError


def told(text: str) -> UserError:
    with pytest.raises(UserError, match="where:") as caught:
        missions.parse(text, label="broken.toml")
    return caught.value


def fault_of(text: str) -> UserError | None:
    try:
        missions.parse(text)
    except UserError as error:
        return error
    return None


def test_the_sound_mission_is_sound() -> None:
    mission = missions.parse(SOUND)
    assert mission.problem.nx == 12
    assert [entry.name for entry in mission.problem.path] == [
        "mast",
        "altitude band",
        "speed limit",
        "tilt limit",
    ]


def test_there_are_more_than_twenty_kinds_of_fault() -> None:
    assert len({broken.name for broken in BROKEN}) == len(BROKEN) > 40


@pytest.mark.parametrize("broken", BROKEN, ids=lambda broken: broken.name)
def test_a_broken_mission_is_told_in_five_parts(broken: Broken) -> None:
    error = told(broken.text)
    for part in ("what", "where", "found", "expected", "do"):
        assert getattr(broken, part) in getattr(error, part), f"{part}: {getattr(error, part)}"
        assert getattr(error, part).strip(), f"the part '{part}' is empty"
    assert error.what.endswith("."), error.what


@pytest.mark.parametrize("name", ["no_such_mission.toml", "folder/other.toml"])
def test_a_missing_file_is_told(name: str, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read") as caught:
        missions.load(tmp_path / name)
    assert caught.value.found == "No such file or directory"


def test_a_name_that_is_nearly_a_mission_gets_the_nearest_one() -> None:
    with pytest.raises(UserError, match='no mission named "city_hopp"') as caught:
        missions.load("city_hopp")
    assert caught.value.do == 'Did you mean "city_hop"?'


def test_a_file_that_is_not_text_is_told(tmp_path: Path) -> None:
    path = tmp_path / "picture.toml"
    path.write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(UserError, match="cannot be read") as caught:
        missions.load(path)
    assert "not UTF-8" in caught.value.found


def test_the_number_of_further_faults_is_told() -> None:
    error = told(SOUND.replace("speed = 6.0", "speed = -1").replace("radius = 2.0", "radius = 0"))
    assert "1 more to mend" in error.do


@given(st.integers(0, len(SOUND)), st.integers(0, 12), st.text(max_size=6))
def test_no_damage_to_the_text_ends_in_anything_but_a_user_error(
    at: int, length: int, instead: str
) -> None:
    text = SOUND[:at] + instead + SOUND[at + length :]
    fault = fault_of(text)
    assert fault is None or all(part.strip() for part in fault.parts().values())
