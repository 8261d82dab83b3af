"""What a reference problem is, and what whoever adds one owes.

1. The problem is defined once, here; tests, command and documents take it from the catalogue.
2. The optimum comes from somewhere else than this program, and ``source`` says from where: author,
   journal or report, year.
3. A "closed form" is evaluated from the formula cited, not pasted.
4. A "computed" optimum was found by multi-phase Radau and Gauss collocation (degrees 4–8, several
   meshes, tolerance 1e-12), with switches and singular arcs as phases; ``digits`` are those on
   which both families agree, or by flying its arcs one after another. ``tests/bank`` finds every
   one again, by another scheme or by shooting.
5. Numbers that others have printed are ``printed``, digit for digit; a print that is known to be
   wrong says why, and is told but not asked for.
6. Where the optimal control jumps and the times are known, ``switches`` has them, in seconds.
7. The recipe may help the solver with a start and a scheme, never with the answer: no mesh with a
   node on a known switch.
8. An optimum that is only local, or holds for a structure kept by hand, says so in ``source``.
9. A factory without required arguments in the file of its family, its first line of documentation
   the problem, and one line in ``catalogue``.

Legend: T horizon, t time, N segments.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.transcription import HermiteSimpson, Transcription
from skyknot.transcription.refinement import Refinement

Array = NDArray[np.float64]
Form = Callable[[Array], Array]

CLOSED, COMPUTED = "closed form", "computed"
KINDS = (CLOSED, COMPUTED)

RELATIVE = 1e-6
"""What a closed form is held to, relative to its size."""

OF_THE_HORIZON = 1e-3
"""What switching times are held to, of the horizon."""


@dataclass(frozen=True)
class Printed:
    """A number as somebody else has printed it.

    Attributes
    ----------
    text : its digits
    by : who
    wrong : why it is not the optimum; empty where it is
    """

    text: str
    by: str
    wrong: str = ""

    def agrees(self, objective: float) -> bool:
        """Whether an objective, rounded like the number, is the number; its sign left out."""
        decimals = len(self.text.partition(".")[2])
        return f"{abs(objective):.{decimals}f}" == self.text


@dataclass(frozen=True)
class Recipe:
    """How the reference is reached.

    Attributes
    ----------
    scheme : scheme and first mesh
    accuracy : as for ``solve``; None solves on the first mesh only
    tolerance : of the optimality conditions
    phases : segments for each arc, and Radau points of a segment: the arcs that the answer shows
        become phases of free length (``arcs``), and that is solved again; None leaves the answer
    """

    scheme: Transcription = field(default_factory=lambda: HermiteSimpson(40))
    accuracy: float | Refinement | None = None
    tolerance: float = 1e-10
    phases: tuple[int, int] | None = None


@dataclass(frozen=True)
class Reference:
    """A problem with its known optimum; the duties are at the top of this file.

    Attributes
    ----------
    problem : what is asked
    optimum : least objective of the continuous problem
    source : where the optimum comes from
    guess : where to start; None for the guess ladder
    state, control, costate : closed forms (t (M,) → (M, n)), where there are any
    kind : one of ``KINDS``
    digits : significant digits of a computed optimum
    printed : what others have printed
    switches : known times at which a control jumps, s, in order
    complete : whether ``switches`` are all there are
    recipe : how the reference is reached
    """

    problem: Problem
    optimum: float
    source: str
    guess: Trajectory | None = None
    state: Form | None = None
    control: Form | None = None
    costate: Form | None = None
    kind: str = CLOSED
    digits: int | None = None
    printed: tuple[Printed, ...] = ()
    switches: tuple[float, ...] = ()
    complete: bool = True
    recipe: Recipe = field(default_factory=Recipe)

    @property
    def limit(self) -> float:
        """Largest error allowed, in its unit: ``RELATIVE``, or one unit of the last digit.

        A computed optimum is held to the coarser of the two; an optimum of zero, absolutely.
        """
        relative = RELATIVE * (abs(self.optimum) or 1.0)
        if self.digits is None:
            return relative
        unit = 10.0 ** (int(np.floor(np.log10(abs(self.optimum)))) + 1 - self.digits)
        return max(relative, unit)


def line(
    T: float,
    first: Sequence[float] | Array,
    last: Sequence[float] | Array,
    first_control: Sequence[float],
    last_control: Sequence[float],
) -> Trajectory:
    """Return the start that runs straight from the first values to the last ones over T seconds."""
    return Trajectory(
        np.array([0.0, T]),
        np.array([first, last], dtype=float),
        np.array([first_control, last_control], dtype=float),
    )
