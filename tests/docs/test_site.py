"""Claim: the site has every page, and every name and path it tells exists."""

from __future__ import annotations

import importlib
import re
import runpy
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
CONFIGURATION = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
HOOKS = runpy.run_path(str(DOCS / "site_links.py"))
NAMES = re.findall(r"^::: (\S+)$", (DOCS / "api.md").read_text(encoding="utf-8"), re.MULTILINE)


def test_the_navigation_has_every_page_once():
    shown = re.findall(r"^ +- .+: (\S+\.md)$", CONFIGURATION, re.MULTILINE)
    assert sorted(shown) == sorted(path.name for path in DOCS.glob("*.md"))


def test_the_site_fetches_nothing_from_other_hosts():
    assert "font: false" in CONFIGURATION
    assert "://" not in CONFIGURATION
    assert "- offline" not in CONFIGURATION  # the plugin fetches a script from a public host


@pytest.mark.parametrize("name", NAMES)
def test_every_name_of_the_reference_exists(name):
    assert resolved(name).__doc__


def resolved(name):
    """Return the module, or the thing in a module, of a dotted name."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        module, _, thing = name.rpartition(".")
        return getattr(importlib.import_module(module), thing)


def test_the_reference_has_every_public_class_and_function():
    import skyknot as sk

    told = {resolved(name) for name in NAMES}
    modules = {thing.__name__ for thing in told if hasattr(thing, "__path__") or _is_module(thing)}
    public = [getattr(sk, name) for name in sk.__all__ if name != "__version__"]
    missing = [
        thing.__name__
        for thing in public
        if callable(thing) and thing not in told and thing.__module__ not in modules
    ]
    assert not missing, "each needs a line '::: module.name' in docs/api.md"


def _is_module(thing):
    return type(thing).__name__ == "module"


@pytest.mark.parametrize("page", ["evidence.md", "extending.md"])
def test_every_path_told_exists(page):
    paths = re.findall(r"`((?:tests|src|docs)/[\w/.]+)`", (DOCS / page).read_text(encoding="utf-8"))
    assert paths
    assert not [path for path in paths if not (ROOT / path).exists()]


def test_the_evidence_lists_the_claims_of_the_tests():
    page = HOOKS["on_page_markdown"](f"before\n{HOOKS['MARK']}\nafter")
    assert "The site has every page, and every name and path it tells exists." in page
    assert len(re.findall(r"^- .*\(`test_\w+\.py`\)$", page, re.MULTILINE)) > 60


def test_words_after_a_name_become_its_description(monkeypatch):
    """The extension needs griffe only as a base class, which the tests do without."""
    monkeypatch.setitem(sys.modules, "griffe", SimpleNamespace(Extension=object, Object=object))
    described = runpy.run_path(str(DOCS / "site_docstrings.py"))["described"]
    ours = "Do.\n\nParameters\n----------\na, b : lengths, m\n    and more\nc : None is free"
    assert described(ours).endswith("a, b\n    lengths, m\n    and more\nc\n    None is free")
    theirs = "Do.\n\nParameters\n----------\nmass : float\n    Mass, kg."
    assert described(theirs) == theirs
    assert described("Note : not a section.") == "Note : not a section."


def test_links_out_of_the_documents_become_words():
    turned = HOOKS["on_page_markdown"]
    assert turned("see [frames.py](../src/a/frames.py).") == "see `src/a/frames.py`."
    assert turned("[the examples](../examples)") == "the examples (`examples`)"
    assert turned("[Start](start.md) ![p](../x.png)") == "[Start](start.md) ![p](../x.png)"
