"""Claim: rooms import one another only along the arrows, without cycles, at the top of files."""

from __future__ import annotations

import ast

import pytest

from architecture.source_tree import (
    PACKAGE,
    imports_of,
    module_name,
    modules,
    python_files,
    room_of,
    tree_of,
)

# Leaves: anyone may import them, they import nothing but one another.
LEAVES = {"deferral", "errors", "status", "trajectory", "version", "whole_file", "witness"}
# X → Y: X may import Y; anything else is a fault.
ARROWS = {
    "models": set(),
    "problem": {"models"},
    "kernel": set(),
    "transcription": {"problem", "kernel"},
    "solvers": {"kernel"},
    "verification": {"problem", "models"},
    "solution": {"problem"},
    "storage": {"solution"},
    # the front door takes a problem, so it sees the room where problems are stated
    # and the finite program passes through its hands, from mesh to mesh
    "solve": {
        *("problem", "transcription", "solvers", "verification", "solution", "rounds", "kernel"),
    },
    "rounds": {"problem", "transcription", "solution", "kernel"},
    "solve_many": {"solve", "problem", "transcription", "solvers", "solution"},
    # solves again what a certificate alone cannot judge
    "examination": {"solve", "verification", "solution", "problem", "transcription"},
    "missions": {"problem", "models"},
    "report": {"solution"},
    "export": {"solution", "storage", "models"},  # models: the lift of a point's motion
    "paper": {"solve", "verification", "report", "problem", "models", "solution"},
    "bank": {"solve", "problem", "models", "transcription", "solution"},
    # measures solvers against one another on many missions
    "bench": {
        *("missions", "solve", "solvers", "verification", "solution", "problem", "models"),
        *("transcription", "kernel"),  # builds once what solve builds every time
    },
    # keeps a mission solved while it changes: the front door's parts, held ready
    "live": {
        *("missions", "solve", "solvers", "verification", "solution", "problem", "models"),
        *("transcription", "kernel", "report"),  # report: the geometry of what is drawn
    },
    "mpc": {"solve", "problem", "models", "solution"},
    "robust": {"solve", "problem", "models", "solution"},
    "fleet": {"solve", "problem", "models", "solution"},
    "learning": {"solve", "problem", "models", "solution"},
}
EVERYTHING = {"cli", "skyknot"}
# Rooms entered on request, with the reason: a solution offers them as methods, and importing them
# with it would load scipy.integrate and matplotlib at every start (report, verification) or close a
# circle (storage and export read solutions).
LATE = {
    ("skyknot.solution", "verification"),
    ("skyknot.solution", "report"),
    ("skyknot.solution", "storage"),
    ("skyknot.solution", "export"),
}
FILES = python_files()
NAMES = [module_name(path) for path in FILES]


def test_every_room_has_its_arrows_written_down():
    rooms = {room_of(name) for name in NAMES}
    assert rooms <= set(ARROWS) | LEAVES | EVERYTHING


@pytest.mark.parametrize("path", FILES, ids=NAMES)
def test_a_module_imports_along_the_arrows_only(path):
    room = room_of(module_name(path))
    faults = [
        f"line {found.line}: {found.target}"
        for found in imports_of(path)
        if not allowed(room, room_of(found.target))
        and (found.importer, room_of(found.target)) not in LATE
    ]
    assert not faults


def allowed(room, target):
    if room in EVERYTHING or target in LEAVES or target == room:
        return True
    return target in ARROWS.get(room, set())


@pytest.mark.parametrize("path", FILES, ids=NAMES)
def test_imports_stand_at_the_top_except_where_listed(path):
    late = [
        f"line {found.line}: {found.target}"
        for found in imports_of(path)
        if found.late and (found.importer, room_of(found.target)) not in LATE
    ]
    assert not late


def test_the_list_of_late_imports_names_only_what_exists():
    made = {
        (found.importer, room_of(found.target))
        for path in FILES
        for found in imports_of(path)
        if found.late
    }
    assert made == LATE


def test_there_are_no_import_cycles():
    graph = {name: set() for name in NAMES}
    for path in FILES:
        for found in imports_of(path):
            runs = not found.late and not found.typing_only
            if runs and found.target in graph and found.target != found.importer:
                graph[found.importer].add(found.target)
    done: set[str] = set()

    def visit(name, trail):
        assert name not in trail, " → ".join([*trail[trail.index(name) :], name])
        if name not in done:
            for target in sorted(graph[name]):
                visit(target, [*trail, name])
            done.add(name)

    for name in graph:
        visit(name, [])


def test_solvers_and_kernel_know_no_flight_and_no_scheme_names():
    words = ("quadrotor", "hermite", "simpson", "rotor", "thrust", "flight")
    for room in ("solvers", "kernel"):
        for path in sorted((PACKAGE / room).glob("*.py")):
            code = strip_words(path)
            assert not [word for word in words if word in code], path.name


def strip_words(path):
    """Return the names used in a file's code, docstrings and comments left out."""
    tree = tree_of(path)
    names = [node.id for node in ast.walk(tree) if isinstance(node, ast.Name)]
    names += [node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)]
    names += [node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    return " ".join(names).lower()


def test_relative_imports_are_not_used():
    for path in FILES:
        tree = tree_of(path)
        relative = [
            node.lineno
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and node.level > 0
        ]
        assert not relative, path
    assert "skyknot.solve" in modules()
