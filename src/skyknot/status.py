"""The closed list of outcomes, each with its sentence and the next thing to try."""

from __future__ import annotations

from enum import StrEnum


class Status(StrEnum):
    """How a solve ended; compares equal to its own text, e.g. ``status == "solved"``."""

    SOLVED = "solved"
    ACCEPTABLE = "solved to acceptable"
    INFEASIBLE = "locally infeasible"
    ITERATION_LIMIT = "iteration limit"
    TIME_LIMIT = "time limit"
    EVALUATION_ERROR = "evaluation error"
    STALLED = "stalled"
    UNBOUNDED = "unbounded"
    INTERRUPTED = "interrupted"
    INACCURATE = "accuracy not reached"

    @property
    def success(self) -> bool:
        """Whether the answer meets the tolerances asked for."""
        return self in (Status.SOLVED, Status.ACCEPTABLE)

    @property
    def sentence(self) -> str:
        """What the outcome means, in one sentence."""
        return _SENTENCES[self][0]

    @property
    def advice(self) -> str:
        """The next thing to try; empty when there is nothing to mend."""
        return _SENTENCES[self][1]


_SENTENCES = {
    Status.SOLVED: ("The optimality conditions hold to the tolerance.", ""),
    Status.ACCEPTABLE: (
        "The optimality conditions hold to the relaxed tolerance, not to the one asked for.",
        "Scale the problem, or ask for a looser tolerance.",
    ),
    Status.INFEASIBLE: (
        "No nearby trajectory meets all constraints at once.",
        "Relax the constraint named above, give more time, or start from another guess.",
    ),
    Status.ITERATION_LIMIT: (
        "The iteration limit was reached before the tolerance.",
        "Raise the iteration limit, or start from a better guess.",
    ),
    Status.TIME_LIMIT: (
        "The time limit was reached before the tolerance.",
        "Raise the time limit, use fewer segments, or start from a better guess.",
    ),
    Status.EVALUATION_ERROR: (
        "The model returned a value that is not a number.",
        "Bound the state named above away from where the model is undefined.",
    ),
    Status.STALLED: (
        "The steps became too small to make progress.",
        "Start from another guess, scale the problem, or loosen the tolerance.",
    ),
    Status.UNBOUNDED: (
        "The objective falls without end: nothing in the problem holds it from below.",
        "Bound the controls, the states or the horizon, or look for a sign error in the cost.",
    ),
    Status.INTERRUPTED: (
        "The solve was interrupted; the best iterate so far is returned.",
        "Solve again with this solution as the guess.",
    ),
    Status.INACCURATE: (
        "The optimality conditions hold on the best mesh found, but not the accuracy asked for.",
        "Ask for less, allow more segments, or price and bound what jumps.",
    ),
}
