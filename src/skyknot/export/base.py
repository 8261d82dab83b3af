"""What every export format owes.

Duties of whoever adds a format:
1. Write ``encode(request) -> Encoded`` in a file of its own named by what it writes. The same
   flight gives the same bytes every time; nothing is read from a clock.
2. Take numbers from ``request.flight`` (SI, NED, FRD) and turn them through ``frames`` and
   ``geodesy`` only; no sign is changed anywhere else.
3. Say inside the file, where people who read such files look: the mission, the frame, the units
   where the format does not fix them, and ``request.verdict``, which begins with UNCERTIFIED when
   no certificate passed.
4. Return what a reader may rely on as a sentence, ``Encoded.accuracy``; a test reads the file back
   with a reader that shares no code with the writer and holds it to that.
5. Say in ``Format`` what the flight must have. Import an optional library inside ``encode``, by
   ``optional``, which names the extra to install when it is missing.
6. Add the format to ``FORMATS`` in ``formats.py``, its row to ``docs/exports.md``, and a reader of
   it to ``tests/export/readers.py``.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.export.geodesy import Origin
from skyknot.export.samples import Flight
from skyknot.solution import Solution

EXTRA = "export"

EPOCH = datetime(2000, 1, 1, tzinfo=UTC)
"""When a flight begins, in formats whose times are dates: midnight, 1 January 2000, UTC."""


@dataclass(frozen=True)
class Request:
    """What is to be written.

    Attributes
    ----------
    solution : what the numbers come from
    times : (M,) sample times, s, on the trajectory's clock
    flight : the solution sampled; only formats that ``samples_anything`` may do without
    frame : "ned" or "enu"
    rate : Hz, as the user asked; None is the format's own
    verdict : one sentence; begins with UNCERTIFIED when no certificate passed
    origin : place on Earth of x = y = z = 0; given where a format needs it
    """

    solution: Solution
    times: NDArray[np.float64]
    flight: Flight | None
    frame: str
    rate: float | None
    verdict: str
    origin: Origin | None = None

    @property
    def title(self) -> str:
        """What was flown: the name of the problem."""
        return self.solution.record.problem

    @property
    def sampled(self) -> Flight:
        """The flight, for formats that only write flights."""
        assert self.flight is not None
        return self.flight

    @property
    def place(self) -> Origin:
        """The origin, for formats that need one."""
        assert self.origin is not None
        return self.origin


@dataclass(frozen=True)
class Encoded:
    """A file's bytes, and what a reader may rely on.

    Attributes
    ----------
    content : the whole file
    accuracy : a sentence's worth of words: how closely the file tells the trajectory
    points : number of points written, where they are fewer than the samples; ``accuracy`` then
        tells what lies between them too
    """

    content: bytes
    accuracy: str
    points: int | None = None


@dataclass(frozen=True)
class Format:
    """One export format.

    Attributes
    ----------
    name : what users ask for
    title : one line for people
    file_name : of the file in a run's folder
    encode : writes it
    frames : frames it can be written in, the default first; empty when it has no choice
    rate : default samples per second; None is at the nodes
    tick : times are multiples of it, s; 0 is any time
    needs : any of "attitude", "thrust", "rotors", "origin"
    samples_anything : whether it can do with states that are no flight
    """

    name: str
    title: str
    file_name: str
    encode: Callable[[Request], Encoded]
    frames: tuple[str, ...] = ()
    rate: float | None = None
    tick: float = 0.0
    needs: tuple[str, ...] = ()
    samples_anything: bool = False

    @property
    def suffix(self) -> str:
        """Ending of the file's name, with its dot."""
        return Path(self.file_name).suffix


def optional(module: str, purpose: str) -> Any:
    """Return a module of the extra ``export``.

    Raises
    ------
    UserError
        When it is not installed; names the extra.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise UserError(
            f"{purpose} needs a library that is not installed.",
            where=module.split(".")[0],
            found=str(error),
            expected=f"the extra '{EXTRA}' of skyknot",
            do=f"Install it: pip install 'skyknot[{EXTRA}]'.",
        ) from error
