"""Claim: the best build this processor can run is picked, and another only when asked by name."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

import skyknot.kernel
from skyknot.errors import UserError
from skyknot.kernel import isa


def import_in_a_fresh_process(requested: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", "from skyknot.kernel import isa_name; print(isa_name())"],
        env={**os.environ, isa.VARIABLE: requested},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_best_level_is_chosen_without_a_request():
    assert isa.choose(None, ("v2", "v3")) == "v3"
    assert isa.choose("", ("v2", "v3", "v4")) == "v4"


def test_a_supported_request_is_honoured():
    assert isa.choose("v2", ("v2", "v3")) == "v2"


def test_an_unsupported_request_is_a_user_error():
    with pytest.raises(UserError, match="cannot run here") as caught:
        isa.choose("v4", ("v2", "v3"))
    assert caught.value.found == "v4"
    assert caught.value.expected == "v2, v3"


def test_a_processor_without_any_level_is_told():
    with pytest.raises(UserError, match="x86-64-v2 or better"):
        isa.choose(None, ())


@pytest.mark.parametrize("level", isa.supported())
def test_every_supported_build_loads_under_its_own_name(level):
    assert import_in_a_fresh_process(level).stdout.strip() == level


def test_a_wrong_request_stops_the_import_with_the_variable_named():
    finished = import_in_a_fresh_process("v9")
    assert finished.returncode != 0
    assert "environment variable SKYKNOT_ISA" in finished.stderr


def test_the_builds_use_vectors_of_their_own_width():
    widths = {"v2": 2, "v3": 4, "v4": 8, "base": 2}
    assert [isa.load(level).vector_width for level in isa.supported()] == [
        widths[level] for level in isa.supported()
    ]


def test_the_picked_module_is_the_one_named():
    assert skyknot.kernel.native.__name__.endswith(skyknot.kernel.isa_name())
