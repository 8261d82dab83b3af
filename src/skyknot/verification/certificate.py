"""The bound set of verdicts for one trajectory."""

from __future__ import annotations

from dataclasses import dataclass, field

from skyknot.verification.base import Check


@dataclass(frozen=True)
class Certificate:
    """What was checked, what was found, and whether all of it holds.

    Attributes
    ----------
    problem : name of the problem
    checks : check by name, in the order measured
    notes : sentences on what was not checked, and why
    """

    problem: str
    checks: dict[str, Check] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether there are checks and every one holds."""
        return bool(self.checks) and all(check.passed for check in self.checks.values())

    @property
    def failures(self) -> tuple[Check, ...]:
        """The checks that fail, worst first."""
        failed = [check for check in self.checks.values() if not check.passed]
        return tuple(sorted(failed, key=lambda check: -check.load))

    @property
    def sentence(self) -> str:
        """The verdict in one sentence."""
        count = len(self.checks)
        if self.passed:
            judged = [check for check in self.checks.values() if not check.information]
            tightest = max(judged or self.checks.values(), key=lambda check: check.load)
            return (
                f"Certified: all {count} checks hold; the closest to its limit is"
                f" '{tightest.name}', at {100 * tightest.load:.2g} % of it."
            )
        if not self.checks:
            return "Not certified: nothing was checked."
        worst = self.failures[0]
        others = ", ".join(f"'{check.name}'" for check in self.failures[1:])
        also = f"; also {others}" if others else ""
        return (
            f"Not certified: {len(self.failures)} of {count} checks fail. '{worst.name}' is"
            f" {quantity(worst.value, worst.unit)} where {quantity(worst.limit, worst.unit)} is"
            f" allowed ({worst.worst}){also}."
        )

    def table(self) -> str:
        """Return the checks as lines of plain text for a terminal, the verdict last."""
        head = ("", "check", "value", "limit", "worst")
        rows = [
            (
                "info" if check.information else "pass" if check.passed else "FAIL",
                check.name,
                quantity(check.value, check.unit),
                quantity(check.limit, check.unit),
                check.worst,
            )
            for check in self.checks.values()
        ]
        widths = [max(len(row[i]) for row in [head, *rows]) for i in range(len(head))]
        lines = [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in [head, *rows]
        ]
        return "\n".join([*lines, *self.notes, self.sentence])

    def as_dict(self) -> dict[str, object]:
        """Return plain data for JSON."""
        return {
            "problem": self.problem,
            "passed": self.passed,
            "sentence": self.sentence,
            "checks": {name: check.as_dict() for name, check in self.checks.items()},
            "notes": list(self.notes),
        }


def quantity(value: float, unit: str) -> str:
    """Return a number with its unit, three digits."""
    return f"{value:.3g} {unit}".rstrip()
