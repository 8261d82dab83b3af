"""The section "How to reproduce": files, commands, versions, hash, effort."""

from __future__ import annotations

from html import escape

from skyknot.report.enclosure import Enclosure
from skyknot.report.markup import card, folded
from skyknot.report.problem_card import seconds
from skyknot.solution import Solution


def reproduction(solution: Solution, enclosed: Enclosure) -> str:
    """Return the section's HTML."""
    record = solution.record
    versions = ", ".join(f"{name} {version}" for name, version in record.versions.items())
    timings = ", ".join(f"{name} {seconds(value)}" for name, value in record.timings.items())
    work = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in record.work.items())
    rows = [
        ("Versions", versions or "not recorded"),
        ("Inputs, SHA-256", record.inputs_hash or "not recorded"),
        ("Time spent", timings or "not recorded"),
        ("Work done", work or "not recorded"),
    ]
    files = [
        folded(f"{name}.toml", text)
        for name, text in (("mission", enclosed.mission), ("vehicle", enclosed.vehicle))
        if text
    ]
    how = _commands() if enclosed.mission else _script(solution)
    return "\n".join([card(rows), f"<pre>{escape(how)}</pre>", *files])


def _commands() -> str:
    """Return the commands that make the run again from the files below."""
    return (
        "# with the files below saved as mission.toml and vehicle.toml, the latter named by the\n"
        '# former (vehicle = "vehicle.toml") unless it is a library vehicle of this version:\n'
        "skyknot solve mission.toml --out again\n"
        "skyknot verify again"
    )


def _script(solution: Solution) -> str:
    record = solution.record
    return (
        "import skyknot as sk\n\n"
        f"# problem: {record.problem!r}; scheme: {record.transcription},"
        f" {record.segments} segments\n"
        f"solution = sk.solve(problem, transcription, solver={record.solver!r},"
        f" tolerance={record.tolerance:g})\n"
        "assert solution.record.inputs_hash == "
        f'"{record.inputs_hash[:16]}…"  # the same finite program\n'
        "print(solution.verify().table())"
    )
