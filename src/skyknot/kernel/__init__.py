"""The native room: compiled mathematics that knows nothing of flight.

``native`` is the build picked for this processor; see :mod:`skyknot.kernel.isa`.
"""

from __future__ import annotations

import os

from skyknot.kernel import isa

_level = isa.choose(os.environ.get(isa.VARIABLE), isa.supported())
native = isa.load(_level)
"""The native module in use."""


def isa_name() -> str:
    """Return the instruction set in use: v2, v3 or v4 on x86-64, base elsewhere."""
    return _level


__all__ = ["isa_name", "native"]
