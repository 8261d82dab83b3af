"""The schema for editors is current, complete, and agrees with what missions.load accepts."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import jsonschema
import pytest

import skyknot as sk
from skyknot import missions
from skyknot.missions.mission import FOLDER
from skyknot.solvers import SOLVERS
from skyknot.transcription import DOORS

COMMITTED = Path(__file__).parents[2] / "docs" / "mission.schema.json"


def test_the_committed_schema_is_current() -> None:
    fresh = json.dumps(missions.json_schema(), indent=2, ensure_ascii=False) + "\n"
    assert COMMITTED.read_text(encoding="utf-8") == fresh, (
        "run: skyknot schema > docs/mission.schema.json"
    )


def test_the_schema_is_itself_valid() -> None:
    jsonschema.Draft202012Validator.check_schema(missions.json_schema())


@pytest.mark.parametrize("name", missions.names())
def test_the_schema_accepts_every_mission_of_the_library(name: str) -> None:
    data = tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))
    jsonschema.validate(data, missions.json_schema())


def test_the_schema_refuses_unknown_keys_in_every_section() -> None:
    schema = missions.json_schema()
    sections = [schema, *schema["$defs"].values()]
    assert len(sections) > 15
    assert all(section["additionalProperties"] is False for section in sections)


def test_every_field_says_what_it_is() -> None:
    sections = missions.json_schema()["$defs"]
    silent = [
        f"{name}.{field}"
        for name, section in sections.items()
        for field, content in section["properties"].items()
        if "description" not in content and field != "kind"
    ]
    assert silent == []


def test_missions_can_name_every_scheme_and_solver() -> None:
    definitions = missions.json_schema()["$defs"]
    schemes = definitions["Scheme"]["properties"]["name"]["enum"]
    solvers = definitions["SolverChoice"]["properties"]["name"]["anyOf"][0]["enum"]
    assert set(DOORS) == set(schemes)
    assert set(SOLVERS) <= set(solvers)


def test_the_library_is_what_the_package_lists() -> None:
    assert sk.missions.names() == sorted(path.stem for path in FOLDER.glob("*.toml"))
