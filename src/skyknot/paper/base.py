"""What every experiment owes.

Duties of whoever adds an experiment:
1. Write ``name(scale) -> Finding`` in the file of its group. ``scale`` says how much work to do:
   every choice of sizes comes from it, and both scales run the same code.
2. Quote what the source report says in ``said``, with the section or equation; judge exactly that.
3. Give every measured number with its name and unit, computed in this run: type no result by hand.
   A number inside ``why`` is formatted from what was measured too.
4. Say in ``how`` what was solved and measured, so that a reader could do it again.
5. Derive the verdict from the numbers by ``judged``, with the thresholds in the code; say in
   ``why`` what is behind it. Times enter verdicts as ratios within one run only.
6. Give in ``data`` plain lists for the figures; a figure reads nothing else of the experiment.
7. Use fixed seeds; fail loudly (``RuntimeError``) when a solve that a number rests on fails.
8. Register the function in ``registry.py``, and let the tests run it at the quick scale.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

HOLDS, CHANGED, FAILS = "holds", "holds with a change", "does not hold"
VERDICTS = (HOLDS, CHANGED, FAILS)
"""The closed list of verdicts."""


@dataclass(frozen=True)
class Scale:
    """How much work the experiments do.

    Attributes
    ----------
    quick : small sizes, for a first look and for tests; same code
    """

    quick: bool = False

    def pick(self, quick: Any, full: Any) -> Any:
        """Return the choice for this scale."""
        return quick if self.quick else full


@dataclass(frozen=True)
class Measure:
    """One measured number.

    Attributes
    ----------
    name, unit : what it is; unit empty when dimensionless
    value : as measured in this run
    spread : where four fifths of many values lie around it; None for a single one
    """

    name: str
    value: float
    unit: str = ""
    spread: tuple[float, float] | None = None

    @classmethod
    def of_many(cls, name: str, values: Sequence[float] | Array, unit: str = "") -> Measure:
        """Return the median of values, with the range from their 10th to their 90th percentile."""
        low, median, high = (float(v) for v in np.percentile(values, (10, 50, 90)))
        return cls(f"{name}, median", median, unit, (low, high))

    @property
    def number(self) -> str:
        """Number, spread and unit, in words for a table."""
        shown = written(self.value)
        if self.spread is not None:
            low, high = (written(value) for value in self.spread)
            shown += f" ({low} to {high})"
        return f"{shown} {self.unit}".rstrip()

    @property
    def text(self) -> str:
        """Name, number, spread and unit."""
        return f"{self.name}: {self.number}"


@dataclass(frozen=True)
class Claim:
    """One claim of the source report, judged.

    Attributes
    ----------
    claim : short title
    section : section or equation of the source report
    said : what the report says, in its words or close to them
    measured : numbers of this run
    how : what was done to measure them
    verdict : one of ``VERDICTS``
    why : what is behind the verdict
    """

    claim: str
    section: str
    said: str
    measured: tuple[Measure, ...]
    how: str
    verdict: str
    why: str


@dataclass(frozen=True)
class Finding:
    """A claim with the data of its figure.

    Attributes
    ----------
    claim : judged
    data : plain lists and numbers by name
    """

    claim: Claim
    data: dict[str, Any] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        return asdict(self)

    @classmethod
    def from_dict(cls, plain: dict[str, Any]) -> Finding:
        """Return the finding that ``as_dict`` told."""
        claim = dict(plain["claim"])
        claim["measured"] = tuple(
            Measure(**measure | {"spread": measure["spread"] and tuple(measure["spread"])})
            for measure in claim["measured"]
        )
        return cls(Claim(**claim), plain["data"])


def written(value: float, digits: int = 4) -> str:
    """Return a number for people, powers of ten without leading zeros."""
    mantissa, _, exponent = f"{value:.{digits}g}".replace("-", "−").partition("e")
    power = exponent.replace("−0", "−").lstrip("+0")
    return f"{mantissa}e{power}" if exponent else mantissa


Experiment = Callable[[Scale], Finding]


def judged(as_said: bool, in_changed_form: bool = False) -> str:
    """Return the verdict: as said, in a changed form, or not at all."""
    return HOLDS if as_said else CHANGED if in_changed_form else FAILS


def listed(sizes: Sequence[float]) -> str:
    """Return numbers in a row, for ``how``."""
    return ", ".join(f"{size:g}" for size in sizes)


def slope(sizes: Sequence[float], values: ArrayLike) -> float:
    """Return the slope of a straight line through log(values) over log(sizes)."""
    return float(np.polyfit(np.log(np.asarray(sizes, dtype=float)), np.log(values), 1)[0])
