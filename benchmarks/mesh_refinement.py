"""Control parametrisations on equal and on refined meshes, over the missions of the library.

    python benchmarks/mesh_refinement.py            prints the tables
    python benchmarks/mesh_refinement.py --write    puts them into docs/accuracy.md

Times are the shortest of three solves with everything that belongs to them, one thread; the last
table takes turns in one process and gives ratios.
"""

from __future__ import annotations

import re
import statistics
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import skyknot as sk
from skyknot import missions
from skyknot.transcription.pointwise import PointFunctions
from skyknot.transcription.segment_error import segment_error

PAGE = Path(__file__).parents[1] / "docs" / "accuracy.md"
EQUAL = 100
"""Equal segments of the first table."""

FORMS: dict[str, Callable[..., sk.Transcription]] = {
    "Hermite–Simpson, quadratic": lambda **mesh: sk.HermiteSimpson(**mesh),
    "Hermite–Simpson, linear": lambda **mesh: sk.HermiteSimpson(controls="linear", **mesh),
    "Hermite–Simpson, hold": lambda **mesh: sk.HermiteSimpson(controls="hold", **mesh),
    "trapezoid, linear": lambda **mesh: sk.Trapezoid(**mesh),
    "trapezoid, hold": lambda **mesh: sk.Trapezoid(controls="hold", **mesh),
}
Row = list[str]


def solved(
    name: str, form: str, accuracy: float | None, segments: int, repetitions: int = 3
) -> tuple[sk.Solution, float]:
    """Return the answer to a mission and the shortest time it took, s."""
    mission = missions.load(name)
    settings: dict[str, Any] = mission.settings() | {"accuracy": accuracy}
    enforce = mission.file.scheme.enforce
    settings["transcription"] = FORMS[form](segments=segments, enforce=enforce)
    times = []
    for _ in range(repetitions):
        began = time.perf_counter()
        solution = sk.solve(mission.problem, **settings)
        times.append(time.perf_counter() - began)
    return solution, min(times)


def judged(solution: sk.Solution) -> Row:
    """Return miss, verdict and objective of an answer."""
    if not solution.success and solution.status != "accuracy not reached":
        return [solution.status.value, "–", "–"]
    certificate = solution.verify()
    miss = f"{certificate.checks['open-loop flight'].value:.1e}"
    word = "passes" if certificate.passed else "fails"
    return [miss, word, f"{solution.objective:.7g}"]


def equal_meshes() -> list[Row]:
    """Return the table of all forms on equal segments."""
    head = ["mission", "control", "miss (26)", "certificate", "objective", "iterations", "time"]
    rows = [head]
    for name in missions.names():
        for form in FORMS:
            solution, spent = solved(name, form, None, EQUAL)
            effort = [str(solution.iterations), f"{1e3 * spent:.0f} ms"]
            rows.append([f"`{name}`", form, *judged(solution), *effort])
            tell(rows[-1])
    return rows


def refined_meshes() -> list[Row]:
    """Return the table of all forms refined to 1e-4."""
    head = ["mission", "control", "segments", "meshes", "error"]
    rows = [[*head, "miss (26)", "certificate", "objective", "time"]]
    for name in missions.names():
        for form in FORMS:
            solution, spent = solved(name, form, 1e-4, 40)
            error = min((each.error for each in solution.rounds), default=float("nan"))
            mesh = [str(solution.record.segments), str(len(solution.rounds)), f"{error:.1e}"]
            rows.append([f"`{name}`", form, *mesh, *judged(solution), f"{1e3 * spent:.0f} ms"])
            tell(rows[-1])
    return rows


def equal_segments_needed() -> list[Row]:
    """Return the table of what equal segments reach on the report's transfer."""
    rows = [["equal segments", "error between nodes", "error flown", "miss (26)", "certificate"]]
    for segments in (100, 200, 300, 350, 400, 600, 800, 850, 900, 1000):
        solution, _ = solved("report_transfer", "Hermite–Simpson, quadratic", None, segments, 1)
        assert solution.problem is not None
        functions = PointFunctions.of(solution.problem)
        error = segment_error(
            solution.problem, solution.trajectory, solution.record.parameters, functions
        )
        errors = [f"{error.dynamics:.1e}", f"{error.flight:.1e}"]
        rows.append([str(segments), *errors, *judged(solution)[:2]])
        tell(rows[-1])
    return rows


def ratio_of_times(turns: int = 15) -> str:
    """Return how long a refined solve of the report's transfer takes, against one equal mesh."""
    form, ratios = "Hermite–Simpson, quadratic", []
    for _ in range(turns):
        _, equal = solved("report_transfer", form, None, EQUAL, 1)
        _, refined = solved("report_transfer", form, 1e-4, 40, 1)
        ratios.append(refined / equal)
    median, least, most = statistics.median(ratios), min(ratios), max(ratios)
    return (
        f"`report_transfer` refined to 1e-4 takes {median:.1f} times as long as one solve on"
        f" {EQUAL} equal segments: median of {turns} turns, {least:.1f} to {most:.1f}."
    )


def tell(row: Iterable[str]) -> None:
    """Print a row as it comes."""
    print("  ".join(row), flush=True)


def markdown(rows: list[Row]) -> str:
    """Return rows as a Markdown table."""
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + " --- |" * len(rows[0]), *lines[1:]])


def main() -> None:
    """Measure everything; write it where asked."""
    found = {
        "equal": markdown(equal_meshes()),
        "refined": markdown(refined_meshes()),
        "needed": markdown(equal_segments_needed()),
        "ratio": ratio_of_times(),
    }
    print(found["ratio"])
    if "--write" in sys.argv[1:]:
        page = PAGE.read_text(encoding="utf-8")
        for name, text in found.items():
            block = re.compile(rf"(<!-- {name} -->\n).*?(\n<!-- end -->)", re.DOTALL)
            page, times = block.subn(lambda match, text=text: match[1] + text + match[2], page)
            assert times == 1, f"docs/accuracy.md has no place for '{name}'"
        PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
