"""skyknot bench: own solver against its peers, on this machine, in this run."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from skyknot.bench import tables
from skyknot.bench.growth_figure import write_growth_figure
from skyknot.bench.measurement import Contest
from skyknot.bench.robustness import Case, study, summary
from skyknot.bench.suite import Results, measured, plan
from skyknot.cli.exits import Exit, command, finite, print_json
from skyknot.cli.solving import JsonOption
from skyknot.report.figures import write_bytes


@command
def bench(
    quick: Annotated[
        bool, typer.Option("--quick", help="Fewer missions, sizes and rounds: under a minute.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write tables, figure and numbers here.")
    ] = None,
    rounds: Annotated[int, typer.Option(min=1, help="Solves of each contestant.")] = 10,
    budget: Annotated[
        float, typer.Option(min=0.1, help="Seconds after which a slow contestant retires.")
    ] = 60.0,
    compiled: Annotated[
        bool, typer.Option("--compiled", help="Peers as compiled C code too; needs a compiler.")
    ] = False,
    robustness: Annotated[
        bool, typer.Option("--robustness", help="Count cold starts that end well, instead.")
    ] = False,
    cases: Annotated[
        int, typer.Option(min=1, help="Random missions of the robustness study.")
    ] = 300,
    as_json: JsonOption = False,
) -> Exit:
    """Measure skyknot's solver against Ipopt and Fatrop on this machine.

    Everyone gets the same missions, starts and tolerances, turn by turn in one process, so that
    ratios mean something even where the machine is busy. Needs nothing but what is installed.

    Examples
    --------
      skyknot bench --quick

      skyknot bench --out runs/bench

      skyknot bench --robustness --cases 50
    """
    console = Console(highlight=False, quiet=as_json)
    if not console.is_terminal:
        console = Console(highlight=False, quiet=as_json, width=120)
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    if robustness:
        facts = _robustness(console, 10 if quick else cases, out)
    else:
        results = measured(
            plan(quick=quick, compiled=compiled, rounds=rounds, budget=budget),
            lambda contest: _tell(console, contest),
        )
        _show(console, results)
        facts = finite(results.as_dict())
        if out is not None:
            _write(results, facts, out)
    if as_json:
        print_json(facts)
    console.out(facts["headline"])
    return Exit.GOOD


def _tell(console: Console, contest: Contest) -> None:
    ratios = [
        f"{name} {tables.number(contest.ratio(name))}" for name in contest.timings if name != "own"
    ]
    own = tables.number(1e3 * contest.timings["own"].median)
    console.out(
        f"{contest.mission}, {contest.segments} segments: own {own} ms; ratios: {', '.join(ratios)}"
    )


def _sections(results: Results) -> list[tuple[str, list[str], tables.Rows]]:
    sections = [("Missions", *tables.mission_rows(results.contests))]
    if results.growth:
        sections.append(("Growth with the number of segments", *tables.growth_rows(results)))
    if results.cold:
        sections.append(("Cold start", *tables.cold_rows(results)))
    return sections


def _show(console: Console, results: Results) -> None:
    for title, head, rows in _sections(results):
        console.print(tables.on_terminal(title, head, rows))
        console.print()


def _write(results: Results, facts: dict[str, Any], out: Path) -> None:
    machine = results.machine
    parts = [
        "# Bench",
        "",
        results.headline(),
        "",
        f"{machine['processor']}, {machine['processors']} processors, instruction set"
        f" {machine['instruction_set']}, load {machine['load_average'][0]} before and"
        f" {machine['load_at_end'][0]} after; {machine['time']}.",
        "",
        tables.CAPTION,
        "",
        *(tables.in_markdown(*section) for section in _sections(results)),
    ]
    write_bytes(out / "bench.md", "\n".join(parts).encode())
    write_bytes(out / "bench.json", json.dumps(facts, indent=1).encode())
    if results.growth:
        write_growth_figure(results, out / "growth.png")


def _robustness(console: Console, cases: int, out: Path | None) -> dict[str, Any]:
    found = study(range(cases), folder=out, report=lambda case: _tell_case(console, case))
    facts: dict[str, Any] = finite(summary(found))
    solved = facts["solved"]
    facts["headline"] = (
        f"Own solves {solved['interior-point']} of {cases} random missions from a cold start, Ipopt"
        f" {solved['ipopt']}; only Ipopt {len(facts['only_peer_solves'])}, only own"
        f" {len(facts['only_we_solve'])}; wrong successes {len(facts['wrong']['interior-point'])}"
        f" and {len(facts['wrong']['ipopt'])}."
    )
    if out is not None:
        facts["cases"] = [finite(dataclasses.asdict(case)) for case in found]
        write_bytes(out / "robustness.json", json.dumps(facts, indent=1).encode())
    return facts


def _tell_case(console: Console, case: Case) -> None:
    endings = [
        f"{name}: {each.status}, {each.iterations} it., {each.seconds:.2f} s"
        for name, each in case.attempts.items()
    ]
    console.out(f"seed {case.seed} ({case.title}): {'; '.join(endings)}")
