"""Reads the package's own source: modules, their imports, their functions. Nothing is imported."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "src" / "skyknot"
NATIVE_SUFFIXES = (".cpp", ".hpp")


@dataclass(frozen=True)
class Import:
    """One import of a module of the package: by whom, of what, and how."""

    importer: str
    target: str
    line: int
    late: bool
    typing_only: bool


def python_files() -> list[Path]:
    """Return the package's Python files."""
    return sorted(PACKAGE.rglob("[!.]*.py"))


def native_files() -> list[Path]:
    """Return the package's C++ files."""
    return sorted(path for path in PACKAGE.rglob("*") if path.suffix in NATIVE_SUFFIXES)


def module_name(path: Path) -> str:
    """Return the dotted name of a file."""
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def room_of(module: str) -> str:
    """Return the room of a module: the part after the package's name, or the package itself."""
    return module.split(".")[1] if "." in module else "skyknot"


@cache
def tree_of(path: Path) -> ast.Module:
    """Return the syntax tree of a file."""
    return ast.parse(path.read_text(encoding="utf-8"), filename=str(path))


@cache
def modules() -> frozenset[str]:
    """Return the dotted names of all modules."""
    return frozenset(module_name(path) for path in python_files())


@cache
def imports_of(path: Path) -> list[Import]:
    """Return the imports of the package's own modules that a file makes."""
    known, found = modules(), []

    def visit(node: ast.AST, late: bool, typing_only: bool) -> None:
        for child in ast.iter_child_nodes(node):
            inside = late or isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
            typing = typing_only or (
                isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test)
            )
            for target in _targets(child, known):
                found.append(Import(module_name(path), target, child.lineno, inside, typing))
            visit(child, inside, typing)

    visit(tree_of(path), False, False)
    return found


def _targets(node: ast.AST, known: frozenset[str]) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names if alias.name.split(".")[0] == "skyknot"]
    if isinstance(node, ast.ImportFrom) and node.level == 0 and node.module is not None:
        if node.module.split(".")[0] != "skyknot":
            return []
        full = [f"{node.module}.{alias.name}" for alias in node.names]
        return [name if name in known else node.module for name in full]
    return []


@cache
def functions_of(path: Path) -> list[tuple[str, int]]:
    """Return name and length in lines, docstring not counted, of every function of a file."""
    return [
        (node.name, _length(node))
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    ]


def _length(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    total = (node.end_lineno or node.lineno) - node.lineno + 1
    first = node.body[0]
    if ast.get_docstring(node) is not None:
        total -= (first.end_lineno or first.lineno) - first.lineno + 1
    return total
