"""Claim: what the README and the documents show runs: code, commands, configuration, examples."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest
from typer.testing import CliRunner

from skyknot.cli.main import app

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
SHELLS = ("sh", "bash", "console")
# Every fence says what it holds, so that nothing is left out unseen; "text" is for output.
LANGUAGES = ("python", "toml", "json", "text", "mermaid", "cpp", "math", *SHELLS)
FENCE = re.compile(r"^( *)(`{3,})([^\n`]*)\n(.*?)^\1\2 *$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Block:
    """A fenced block: where it stands, its language, its text."""

    page: str
    line: int
    language: str
    text: str


def blocks_of(page):
    content = page.read_text(encoding="utf-8")
    return [
        Block(
            str(page.relative_to(ROOT)),
            content[: match.start()].count("\n") + 1,
            match.group(3).strip(),
            "\n".join(line.removeprefix(match.group(1)) for line in match.group(4).splitlines()),
        )
        for match in FENCE.finditer(content)
    ]


BLOCKS = [block for page in PAGES for block in blocks_of(page)]
AGG = {**os.environ, "MPLBACKEND": "Agg"}


def commands(block):
    """Return the commands of a shell block; console blocks mark them with '$ '."""
    joined = block.text.replace("\\\n", " ")
    lines = [line.strip() for line in joined.splitlines()]
    if block.language == "console":
        lines = [line[2:] for line in lines if line.startswith("$ ")]
    parts = [shlex.split(line, comments=True) for line in lines]
    return [words for words in parts if words]


def test_every_fence_names_its_language():
    unknown = [f"{b.page}:{b.line} '{b.language}'" for b in BLOCKS if b.language not in LANGUAGES]
    assert not unknown


def test_every_fence_is_closed():
    for page in PAGES:
        content = page.read_text(encoding="utf-8")
        openings = re.findall(r"^ *`{3,}", content, re.MULTILINE)
        assert len(openings) == 2 * len(blocks_of(page)), page


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_python_block_runs_by_itself(page, tmp_path):
    for block in blocks_of(page):
        if block.language == "python":
            script = tmp_path / f"line_{block.line}.py"
            script.write_text(block.text, encoding="utf-8")
            run(script, tmp_path, f"{block.page}:{block.line}")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_command_shown_is_one_that_exists(page):
    for block in blocks_of(page):
        if block.language in SHELLS:
            for words in commands(block):
                check_command(words, f"{block.page}:{block.line}")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_toml_block_parses(page):
    for block in blocks_of(page):
        if block.language == "toml":
            assert tomllib.loads(block.text), f"{block.page}:{block.line}"


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_runs_and_says_something(example, tmp_path):
    assert run(example, tmp_path, example.name).stdout.strip()


def test_there_are_examples():
    assert len(EXAMPLES) >= 4


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_local_link_leads_somewhere(page):
    links = re.findall(r"\]\(([^)#\s]+)", page.read_text(encoding="utf-8"))
    local = [link for link in links if "://" not in link and not link.startswith("mailto:")]
    assert not [link for link in local if not (page.parent / link).exists()]


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("skyknot sovle city_hop", "No such command"),
        ("skyknot solve city_hop --speed 3", "No such option"),
        ("skyknot solve city_hop --segments", "Error"),
        ("make cake", "no target"),
        ("python examples/absent.py", "does not exist"),
    ],
)
def test_the_check_of_commands_catches_what_is_wrong(line, complaint):
    with pytest.raises(pytest.fail.Exception, match=complaint):
        check_command(line.split(), "here")


def run(script, folder, where):
    finished = subprocess.run(
        [sys.executable, "-W", "error", str(script)],
        cwd=folder,
        env=AGG,
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, f"{where}\n{finished.stderr}"
    return finished


def check_command(words, where):
    """Fail unless a command's program, subcommand, options and files exist."""
    name, rest = words[0], words[1:]
    if name == "skyknot":
        check_skyknot(rest, where)
    elif name == "make":
        targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
        for target in rest:
            if target not in targets:
                pytest.fail(f"{where}: make has no target '{target}'")
    elif name in ("python", "python3") and rest and rest[0].endswith(".py"):
        if not (ROOT / rest[0]).exists():
            pytest.fail(f"{where}: {rest[0]} does not exist")
    elif name not in ("pip", "python", "python3", "git", "cd", "source", "ls", "cat", "open"):
        pytest.fail(f"{where}: unknown program '{name}'")


def check_skyknot(arguments, where):
    """Let the command line's own parser judge: it reads all words before it shows the help."""
    result = CliRunner().invoke(app, [*arguments, "--help"])
    if result.exit_code != 0:
        pytest.fail(f"{where}: {result.output}")
