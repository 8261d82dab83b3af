"""What the claims amount to, in paragraphs whose every number comes from the findings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from skyknot.paper.base import Finding, written
from skyknot.paper.flown_figures import meshes_of


@dataclass(frozen=True)
class Story:
    """A chapter of the page.

    Attributes
    ----------
    title : heading
    paragraphs : plain text
    table : rows of cells, the heading first; empty for none
    figures : numbers of the figures that belong here
    """

    title: str
    paragraphs: tuple[str, ...]
    table: tuple[tuple[str, ...], ...]
    figures: tuple[int, ...]


def stories(findings: dict[str, Finding]) -> tuple[Story, ...]:
    """Return the chapters that come before the claims."""
    return blind_mesh(findings), algorithm(findings)


def blind_mesh(findings: dict[str, Finding]) -> Story:
    """Tell why a solution with tiny defects does not fly, and which mesh does."""
    finding = findings["forward_simulation"]
    rows, meshes = finding.data["rows"], meshes_of(finding)
    equal, graded, refined = (meshes[name] for name in ("equal", "graded", "refined"))
    head = ("mesh", "N", "shortest segment", "largest defect (19)", "J", "e_RMS (26)",
            "miss at the end", "certificate")  # fmt: skip
    lines = tuple(
        (
            row["mesh"],
            f"{row['segments']}",
            f"{1e3 * row['shortest']:.3g} ms",
            written(row["defect"], 2),
            f"{row['objective']:.4f}",
            written(row["rms"], 2),
            length(row["miss"]),
            "passes" if row["certified"] else "fails",
        )
        for row in rows
    )
    return Story(
        title="What the report's mesh cannot see",
        paragraphs=(
            f"At the report's size, N = {equal['segments']} equal segments, every solver tried here"
            f" meets its tolerance: the largest defect (19) is {written(equal['defect'], 2)}. And"
            f" yet the control, flown open loop, ends {length(equal['miss'])} from where the"
            f" solution says. The certificate fails it: e_RMS (26) is {equal['rms']:.2g}, where the"
            " report claims less than 0.02.",
            "The reason is in figure 13. Nothing in the cost (10) restrains the first torques much,"
            " so the optimum is bang-bang there: full torque one way, then the other, within a few"
            f" tenths of a second. Segments of {1e3 * equal['shortest']:.0f} ms put a quadratic"
            " through three values each; the scheme compares rates at these three places only, and"
            " finds them right. Between them the craft turns by a slightly different angle, and ten"
            " seconds of flight make metres of it. A defect measures how well the discrete"
            " equations are solved, not how well they describe the flight.",
            "The remedy is not more segments but the right ones. As many of them,"
            f" {graded['segments']}, laid dense at the start keep (26) with e_RMS ="
            f" {graded['rms']:.2g} and end {length(graded['miss'])} off. A mesh that refines"
            f" itself, from a quarter as many, has {refined['segments']}, the shortest of"
            f" {1e3 * refined['shortest']:.2g} ms, and ends {length(refined['miss'])} off.",
        ),
        table=(head, *lines),
        figures=(9, 13),
    )


def algorithm(findings: dict[str, Finding]) -> Story:
    """Tell what Algorithm 1 does as printed, and what makes it work."""
    ran, optimality = findings["iterations_and_time"], findings["optimality_after_iterations"]
    saving, growth = findings["barzilai_borwein_saving"], findings["linear_in_segments"]
    number = {m.name: m.value for f in (ran, optimality, growth) for m in f.claim.measured}
    text = {m.name: m.number for m in saving.claim.measured}
    saved = saving.data["saved"].items()
    return Story(
        title="Algorithm 1, as printed and as it works",
        paragraphs=(
            "Lines 4 and 5 of Algorithm 1 descend J; the defects appear only in the test of line 8."
            " J alone is least when the craft hovers at the goal from the first instant to the"
            f" last, and that is where it goes: after {number['iterations, as printed']:.0f}"
            f" iterations J = {written(number['J as printed'], 2)}, and x(0) is"
            f" {length(number['x(0) as printed, off the one given'])} off the start given. A hover"
            " has no defects, so line 8 stops, satisfied. The solver here does not call that"
            " success.",
            "Equation (17) puts the multipliers of the defects into the gradient. Taken at its word"
            " it is the method of multipliers, and converges to the right thing, slowly: after"
            f" {number['iterations, with multipliers']:.0f} iterations the optimality error is"
            f" {written(number['optimality error (20), with multipliers'], 2)}; after"
            f" {number['iterations, with multipliers, long run']:.0f} the largest defect is"
            f" {written(number['defect (19) then, long run'], 2)} and J is"
            f" {written(number['J then off the optimum, long run'], 2)} % off.",
            "What meets the report's figures is the same loop in another metric. Each gradient step"
            " is projected on the linearised defects and the bounds, in a Gauss–Newton matrix that"
            " a Riccati sweep factors once and later steps reuse; the multipliers come from the"
            f" same solve. It takes {number['iterations, structured']:.0f} iterations to a defect"
            f" of {written(number['largest defect (19), structured'], 2)} and an optimality of"
            f" {written(number['optimality error (20), structured'], 2)}, and agrees with Ipopt's"
            f" objective to {written(number['objective off that of Ipopt, relative'], 2)}. The"
            " time of a step grows with the power"
            f" {number['exponent of N, gradient steps']:.2f} of N.",
            "Barzilai–Borwein step lengths (18) take"
            f" {text['iterations, Barzilai–Borwein, median']} iterations over the seeded transfers"
            " (median, and the range of four fifths of them). Against fixed steps the median"
            " saving is "
            + ", ".join(
                f"{100 * float(np.median(shares)):.0f} % for α = {step}" for step, shares in saved
            )
            + ".",
        ),
        table=(),
        figures=(3, 11, 7, 14, 15),
    )


def length(metres: float) -> str:
    """Return a length in the unit that suits it."""
    for factor, unit in ((1.0, "m"), (1e2, "cm"), (1e3, "mm")):
        if metres * factor >= 1.0:
            return f"{metres * factor:.2g} {unit}"
    return f"{1e3 * metres:.2g} mm"
