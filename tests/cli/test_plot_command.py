"""Claim: skyknot plot draws any figure of a run, as vectors, and refuses what it cannot draw."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest
from typer.testing import CliRunner

from skyknot.cli.main import app
from skyknot.report import KINDS, animation

RUNNER = CliRunner()


def plot(*words: object):
    return RUNNER.invoke(app, ["plot", *(str(word) for word in words)])


@pytest.mark.parametrize("kind", ["path", "position", "overview"])
def test_figures_are_drawn_as_vectors(kind: str, run: Path) -> None:
    result = plot(run, "--kind", kind, "--format", "svg")
    assert result.exit_code == 0, result.output
    path = run / "figures" / f"{kind}.svg"
    assert result.stdout.endswith(f"Written to {path}.\n")
    root = ElementTree.fromstring(path.read_bytes())
    assert len([text for text in root.itertext() if text.strip()]) > 5  # text stays text
    pixels = list(root.iter("{http://www.w3.org/2000/svg}image"))
    assert len(pixels) <= (kind in ("path", "overview"))  # the shades of the colour bar


@pytest.mark.parametrize(
    ("ending", "magic"), [("pdf", b"%PDF-"), ("png", b"\x89PNG"), ("svg", b"<?xml")]
)
def test_the_ending_tells_the_format(ending: str, magic: bytes, run: Path, tmp_path: Path) -> None:
    path = tmp_path / "new" / f"mine.{ending}"
    assert plot(run, "--kind", "controls", "--out", path).exit_code == 0
    assert path.read_bytes().startswith(magic)


def test_pdf_is_the_default_and_holds_no_pixels(run: Path) -> None:
    facts = json.loads(plot(run, "--kind", "position", "--json").stdout)
    assert facts["path"] == str(run / "figures" / "position.pdf")
    assert facts["caption"].endswith(".")
    content = Path(facts["path"]).read_bytes()
    assert b"/Subtype /Image" not in content
    assert b"/FontFile2" in content  # fonts are embedded


@pytest.mark.parametrize(
    ("words", "what", "expected"),
    [
        (("--kind", "pie"), "no such figure", "path, position"),
        (("--kind", "rotors"), "no such figure", "path, position"),
        (("--kind", "path", "--format", "bmp"), "not written in this format", "pdf, svg, png"),
        (("--kind", "path", "--format", "gif"), "not written in this format", "pdf, svg, png"),
        (("--kind", "animation", "--format", "pdf"), "Films are not written", "gif, mp4"),
        (("--kind", "path", "--out", "picture.bmp"), "not written in this format", "pdf, svg, png"),
    ],
)
def test_what_cannot_be_drawn_is_refused(
    words: tuple[str, ...], what: str, expected: str, run: Path
) -> None:
    result = plot(run, *words)
    assert result.exit_code == 2
    assert what in result.stderr
    assert expected in result.stderr
    assert not (run / "figures").exists()


def test_a_film_is_a_kind_of_its_own(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(animation, "LONGEST", 0.3)
    result = plot(run, "--kind", "animation", "--format", "gif")
    assert result.exit_code == 0, result.output
    assert (run / "figures" / "animation.gif").read_bytes().startswith(b"GIF89a")
    assert result.stdout.startswith("A film of the flight, ")


def test_what_is_no_run_is_refused(tmp_path: Path) -> None:
    result = plot(tmp_path, "--kind", "path")
    assert result.exit_code == 2
    assert "not the folder of a run" in result.stderr


def test_the_help_lists_every_kind() -> None:
    told = "".join(RUNNER.invoke(app, ["plot", "--help"], env={"COLUMNS": "200"}).stdout.split())
    for name in [*KINDS, "animation"]:
        assert f"{name}:" in told
