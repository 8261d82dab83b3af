"""Claim: the documents tell every key, status, scheme and solver; what they show flies."""

from __future__ import annotations

import re
import runpy
import tomllib
from pathlib import Path

import pytest

import skyknot as sk
from agreement.variants import PROBLEMS
from architecture.source_tree import module_name, python_files, room_of
from architecture.test_arrows import ARROWS
from skyknot.bench.observed_orders import QUANTITIES, cases
from skyknot.examination import examine
from skyknot.export import FORMATS
from skyknot.solvers import SOLVERS
from skyknot.transcription import DOORS
from skyknot.verification import certify

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
LARGEST_PICTURE = 300_000


def missions_shown():
    pages = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]
    blocks = [
        block
        for page in pages
        for block in re.findall(r"^```toml\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)
    ]
    return [block for block in blocks if "title" in tomllib.loads(block)]


def test_the_mission_reference_is_what_the_schema_makes():
    make = runpy.run_path(str(DOCS / "make_mission_reference.py"))["reference"]
    written = (DOCS / "mission-file.md").read_text(encoding="utf-8")
    assert written == make(), "run: python docs/make_mission_reference.py"


@pytest.mark.parametrize("text", missions_shown(), ids=lambda text: tomllib.loads(text)["title"])
def test_every_mission_shown_is_solved_and_certified(text):
    mission = sk.missions.parse(text)
    solution = sk.solve(mission.problem, **mission.settings())
    assert solution.success, solution.message
    certificate = certify(mission.problem, solution.trajectory)
    assert certificate.passed, certificate.sentence


def test_the_problem_of_the_front_page_is_solved_and_certified():
    (code,) = re.findall(r"^```python\n(.*?)^```$", (ROOT / "README.md").read_text(), re.M | re.S)
    shown: dict[str, sk.Solution] = {}
    exec(compile(code, "README.md", "exec"), shown)
    assert shown["solution"].success
    certificate = shown["solution"].verify()
    assert certificate.passed, certificate.sentence


@pytest.mark.parametrize("status", sk.Status)
def test_every_status_has_its_advice(status):
    page = (DOCS / "my-problem-does-not-solve.md").read_text(encoding="utf-8")
    headings = [line for line in page.splitlines() if line.startswith("## ")]
    assert any(f"`{status.value}`" in heading for heading in headings)


def test_the_orders_of_the_schemes_page_are_claimed_and_measured():
    """The page is made by measuring; tests/orders measures again. Here: it tells today's tables."""
    page = (DOCS / "schemes.md").read_text(encoding="utf-8")
    rows = {}
    for line in page.splitlines():
        words = [word.strip() for word in line.strip("|").split("|")]
        if len(words) == 6 and words[0].strip("`") in DOORS and "/" in words[3]:
            rows[tuple(words[:3])] = [column.split(" / ") for column in words[3:]]
    assert len(rows) == len(cases())
    for case in cases():
        claimed, *measured = rows[f"`{case.scheme}`", str(case.points or "–"), case.controls]
        orders = [str(getattr(case.claimed, name)) for name in QUANTITIES]
        assert claimed == orders
        for column in measured:
            for found, order in zip(column, orders, strict=True):
                assert found == "–" or float(found) > float(order) - 0.15


def test_the_stability_table_is_what_the_tables_say():
    make = runpy.run_path(str(DOCS / "make_schemes_page.py"))["stability"]
    assert make() in (DOCS / "schemes.md").read_text(encoding="utf-8"), (
        "run: python docs/make_schemes_page.py"
    )


@pytest.mark.parametrize("name", [*DOORS, *SOLVERS])
def test_every_scheme_and_solver_has_its_line(name):
    page = (DOCS / "choosing.md").read_text(encoding="utf-8")
    assert f"\n| `{name}` |" in page


@pytest.mark.parametrize("name", FORMATS)
def test_every_export_format_has_its_row(name):
    page = (DOCS / "exports.md").read_text(encoding="utf-8")
    assert f"\n| `{name}` |" in page


def test_every_check_has_its_row():
    """Two problems have between them everything that a certificate looks at."""
    plain, rich = (sk.solve(PROBLEMS[n], sk.HermiteSimpson(8)) for n in ("plain", "everything"))
    names = {*examine(plain).checks, *rich.verify().checks}
    page = (DOCS / "certificate.md").read_text(encoding="utf-8")
    rows = "\n".join(re.findall(r"^\| (`.*?) \|", page, re.MULTILINE))
    assert names == set(re.findall(r"`([^`]+)`", rows))


def test_the_architecture_draws_the_arrows_that_are_enforced():
    page = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    drawn = {
        room: set(targets.split(", ")) - {"nothing"}
        for room, targets in re.findall(r"^(\w+) +→ ([\w, ]+)$", page, re.MULTILINE)
    }
    rooms = {room_of(module_name(path)) for path in python_files()}
    assert drawn.pop("cli") == {"everything"}
    assert drawn == {room: ARROWS[room] for room in rooms & set(ARROWS) | set(drawn)}


def test_pictures_are_shown_and_small():
    pages = [ROOT / "README.md", *DOCS.glob("*.md")]
    texts = [page.read_text(encoding="utf-8") for page in pages]
    shown = {name for text in texts for name in re.findall(r"pictures/(\w+\.png)", text)}
    pictures = {path.name: path for path in (DOCS / "pictures").glob("*.png")}
    assert shown == set(pictures)
    assert all(path.stat().st_size < LARGEST_PICTURE for path in pictures.values())
