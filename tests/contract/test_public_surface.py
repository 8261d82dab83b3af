"""Claim: every public name is documented and typed, and the surface stays small."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from importlib.metadata import version
from pathlib import Path

import pytest

import skyknot as sk

NAMES = sorted(name for name in sk.__all__ if name != "__version__")
ROOMS = [
    module.name
    for module in pkgutil.walk_packages(sk.__path__, "skyknot.")
    if "_native" not in module.name and "._cpu" not in module.name
]


def public_members(thing):
    """Return the public functions of a class, itself if it is a function."""
    if inspect.isfunction(thing):
        return [thing]
    return [
        getattr(member, "fget", None) or getattr(member, "__func__", member)
        for name, member in vars(thing).items()
        if not name.startswith("_") and (inspect.isfunction(member) or isinstance(member, property))
    ]


def public_things(module):
    return [
        thing
        for name, thing in vars(module).items()
        if not name.startswith("_")
        and getattr(thing, "__module__", None) == module.__name__
        and (inspect.isclass(thing) or inspect.isfunction(thing))
    ]


def test_all_lists_what_there_is_once_and_in_order():
    assert len(set(sk.__all__)) == len(sk.__all__)
    assert list(sk.__all__) == sorted(sk.__all__)
    assert all(hasattr(sk, name) for name in sk.__all__)


def test_the_surface_stays_about_forty_names():
    assert 25 <= len(sk.__all__) <= 50


@pytest.mark.parametrize("name", NAMES)
def test_every_exported_name_is_documented(name):
    assert len((getattr(sk, name).__doc__ or "").strip()) > 20


@pytest.mark.parametrize("room", ROOMS)
def test_every_public_thing_of_a_module_is_documented_and_typed(room):
    module = importlib.import_module(room)
    assert module.__doc__, room
    for thing in public_things(module):
        assert thing.__doc__, f"{room}.{thing.__name__} has no docstring"
        for member in public_members(thing):
            annotations = dict(member.__annotations__)
            if "return" not in annotations:
                pytest.fail(f"{room}.{member.__qualname__} has no return type")
            for parameter in inspect.signature(member).parameters.values():
                if parameter.name not in ("self", "cls") and parameter.name not in annotations:
                    pytest.fail(f"{room}.{member.__qualname__}: {parameter.name} has no type")


def test_the_version_is_that_of_the_project():
    assert sk.__version__ == version("skyknot")


def test_the_package_says_it_is_typed():
    assert Path(sk.__file__).with_name("py.typed").is_file()
