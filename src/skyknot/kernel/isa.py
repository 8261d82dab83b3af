"""Which build of the native kernel runs on this processor.

The same sources are compiled for the x86-64 levels v2 (SSE4.2), v3 (AVX2, FMA) and v4 (AVX-512) of
the System V psABI, and once as ``base`` on any other processor.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from types import ModuleType

from skyknot.errors import UserError
from skyknot.kernel._cpu import supported_levels

VARIABLE = "SKYKNOT_ISA"
"""Environment variable that overrides the choice."""


def supported() -> tuple[str, ...]:
    """Return the builds this processor can run, least first."""
    return tuple(supported_levels())


def choose(requested: str | None, levels: Sequence[str]) -> str:
    """Return the requested build, or the best of ``levels`` (least first) without a request.

    Raises
    ------
    UserError
        If the request is not among ``levels``, or there are none.
    """
    if not levels:
        raise UserError(
            "The kernel needs a processor of level x86-64-v2 or better.",
            where="this processor",
            found="no SSE4.2",
            expected="SSE4.2, SSSE3 and POPCNT",
            do="run skyknot on a newer machine",
        )
    if not requested:
        return levels[-1]
    if requested not in levels:
        raise UserError(
            "The instruction set asked for cannot run here.",
            where=f"environment variable {VARIABLE}",
            found=requested,
            expected=", ".join(levels),
            do=f"unset {VARIABLE} to let skyknot choose, or set one of these",
        )
    return requested


def load(level: str) -> ModuleType:
    """Return the native module built for a level; it must be one of :func:`supported`."""
    return import_module(f"skyknot.kernel._native_{level}")
