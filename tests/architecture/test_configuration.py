"""Claim: the configuration means something: every path and name in it exists."""

from __future__ import annotations

import importlib
import re
import tomllib
from importlib.metadata import version

import pytest

from architecture.source_tree import ROOT

CONFIGURATION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
TOOL = CONFIGURATION["tool"]


@pytest.mark.parametrize(
    "path",
    [
        CONFIGURATION["project"]["readme"],
        *TOOL["ruff"]["src"],
        *TOOL["mypy"]["files"],
        *TOOL["pytest"]["ini_options"]["testpaths"],
        *TOOL["scikit-build"]["wheel"]["packages"],
    ],
)
def test_every_path_exists(path):
    assert (ROOT / path).exists()


@pytest.mark.parametrize("pattern", TOOL["ruff"]["lint"]["per-file-ignores"])
def test_every_lint_exception_matches_a_file(pattern):
    assert any(ROOT.glob(pattern + "/*" if pattern.endswith("**") else pattern))


@pytest.mark.parametrize("pattern", TOOL["scikit-build"]["wheel"]["exclude"])
def test_every_wheel_exclusion_matches_a_file(pattern):
    assert any((ROOT / "src").glob(pattern + "/*" if pattern.endswith("**") else pattern))


@pytest.mark.parametrize("target", CONFIGURATION["project"]["scripts"].values())
def test_every_script_points_to_a_callable(target):
    module, name = target.split(":")
    assert callable(getattr(importlib.import_module(module), name))


@pytest.mark.parametrize(
    "requirement",
    [
        *CONFIGURATION["project"]["dependencies"],
        *CONFIGURATION["project"]["optional-dependencies"]["dev"],
    ],
)
def test_every_requirement_is_installed_at_its_lowest_version_or_later(requirement):
    name, lowest = re.fullmatch(r"([A-Za-z0-9-]+)>=([0-9.]+)", requirement).groups()
    installed = [int(part) for part in re.findall(r"\d+", version(name))[:3]]
    assert installed >= [int(part) for part in lowest.split(".")]


def test_the_license_is_there():
    assert (ROOT / "LICENSE").read_text(encoding="utf-8").lstrip().startswith("Apache License")
