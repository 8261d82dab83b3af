"""Claim: files and functions stay short, names stay telling and unique."""

from __future__ import annotations

from collections import Counter
from statistics import median

import pytest

from architecture.source_tree import (
    PACKAGE,
    functions_of,
    module_name,
    native_files,
    python_files,
)

FILE_LIMIT, FILE_MEDIAN = 450, 150
FUNCTION_LIMIT, FUNCTION_MEDIAN, LOOP_LIMIT = 60, 10, 120
# A solver's main loop reads like the paper it comes from, on a screen or two.
MAIN_LOOPS: set[tuple[str, str]] = set()
BANNED = {"util", "utils", "helper", "helpers", "common", "misc", "miscellaneous", "stuff", "tools"}
FILES = python_files()
NAMES = [module_name(path) for path in FILES]


def lines_of(path):
    return len(path.read_text(encoding="utf-8").splitlines())


@pytest.mark.parametrize("path", [*FILES, *native_files()], ids=lambda path: path.name)
def test_no_file_exceeds_the_limit(path):
    assert lines_of(path) <= FILE_LIMIT


def test_the_median_file_fits_a_few_screens():
    assert median(lines_of(path) for path in FILES) <= FILE_MEDIAN


@pytest.mark.parametrize("path", FILES, ids=NAMES)
def test_no_function_exceeds_the_limit(path):
    too_long = [
        f"{name}: {length} lines"
        for name, length in functions_of(path)
        if length > (LOOP_LIMIT if (module_name(path), name) in MAIN_LOOPS else FUNCTION_LIMIT)
    ]
    assert not too_long


def test_the_median_function_is_a_few_lines():
    lengths = [length for path in FILES for _, length in functions_of(path)]
    assert median(lengths) <= FUNCTION_MEDIAN


def test_a_file_name_occurs_once():
    counts = Counter(path.name for path in [*FILES, *native_files()])
    repeated = {name for name, count in counts.items() if count > 1}
    assert repeated <= {"__init__.py", "base.py"}


def test_no_drawer_names():
    names = {part for path in PACKAGE.rglob("*") for part in path.stem.split("_")}
    assert not names & BANNED


def test_a_room_of_several_files_opens_with_its_question():
    for room in sorted(PACKAGE.iterdir()):
        if room.is_dir() and (room / "__init__.py").exists():
            text = (room / "__init__.py").read_text(encoding="utf-8").lstrip()
            assert text.startswith('"""'), room.name
