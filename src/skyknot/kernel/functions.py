"""A program's two functions, known again by how CasADi writes them out."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from typing import Any

import casadi as ca


@dataclass(frozen=True)
class Functions:
    """The functions of a program; equal, and of one hash, where they are written alike.

    What is made of them can thus be kept for whoever states the same problem again, while nobody
    gets expressions that another thread may be at work on.

    Attributes
    ----------
    digest : SHA-256 of both
    point : (x, u, q, τ, p) → (L, F, g)
    terminal : (x, q, p) → M
    read : the object of hashlib that has read both; to be copied
    """

    digest: bytes
    point: ca.Function = field(compare=False)
    terminal: ca.Function = field(compare=False)
    read: Any = field(compare=False)

    @classmethod
    def of(cls, point: ca.Function, terminal: ca.Function) -> Functions:
        """Return two functions, which CasADi writes out for it."""
        read = hashlib.sha256()
        for function in (point, terminal):
            read.update(str(function.serialize()).encode())
        return cls(read.digest(), point, terminal, read)
