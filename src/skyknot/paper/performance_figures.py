"""Order, convergence, growth and spread, from what the experiments measured."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.ticker import FixedFormatter, FixedLocator, NullFormatter

from skyknot.paper.base import Finding, slope
from skyknot.paper.gradient import DEFECT, OPTIMALITY
from skyknot.report import style
from skyknot.report.progress import power_of_ten

SMALLEST = 1e-16
"""Zero on a logarithmic axis."""

FORMS = {
    "structured": (style.BLUE, "-", 1.9),
    "multipliers": (style.GREEN, "-", 0.7),
    "printed": (style.VERMILLION, (0, (1, 1.2)), 1.7),
}
"""Forms of the projected gradient: colour, line and width."""


def draw_order(figure: Any, findings: dict[str, Finding]) -> str:
    """Draw figure 10: errors over the length of a segment, with the slopes said and measured."""
    axes = figure.subplots()
    lines = (("global_order", "nodes of a flight", style.BLUE, 3, 4),
             ("local_order", "one segment", style.GREEN, 4, 5))  # fmt: skip
    for name, label, color, said, found in lines:
        data = findings[name].data
        h, errors = np.array(data["h"]), np.array(data["errors"])
        axes.plot(h, errors, "o", color=color, label=f"{label}, measured")
        for order, dashes in ((said, (0, (1, 1.5))), (found, "-")):
            label_ = f"slope {order}" + (", as said" if order == said else "")
            axes.plot(h, errors[0] * (h / h[0]) ** order, linestyle=dashes, color=color,
                      linewidth=1.2, label=label_)  # fmt: skip
    logarithmic(axes, x=True)
    ticks = sorted({float(h) for name, *_ in lines for h in findings[name].data["h"]})
    plain_ticks(axes, ticks)
    axes.set_xlabel("length h of a segment [s]")
    axes.set_ylabel("largest error of a state [SI units]")
    axes.legend(loc="lower right")
    return (
        "Error of the 12-state craft at the nodes of a smooth transfer, and at the end of one"
        " segment. Dots are measured, dotted lines have the slopes that the source report names,"
        " solid lines one more."
    )


def draw_convergence(figure: Any, findings: dict[str, Finding]) -> str:
    """Draw figure 11: both errors over the iterations, form by form."""
    histories = findings["iterations_and_time"].data
    panels = figure.subplots(1, 2, sharex=True)
    titles = {"defect": "defect (19) and bounds", "optimality": "optimality (20)"}
    for axes, (name, title) in zip(panels, titles.items(), strict=True):
        for form, (color, dashes, width) in FORMS.items():
            values = np.maximum(histories[form][name], SMALLEST)
            axes.plot(np.arange(len(values)) + 1, values, color=color, linestyle=dashes,
                      linewidth=width, label=form)  # fmt: skip
            axes.plot(len(values), values[-1], "o", color=color, markersize=4.5)
        axes.axhline(
            DEFECT if name == "defect" else OPTIMALITY,
            color=style.MUTED,
            linewidth=0.9,
            linestyle=(0, (5, 3)),
        )
        axes.set_title(title)
        axes.set_xlabel("iteration + 1")
        logarithmic(axes, x=True)
    panels[0].set_ylabel("largest entry [SI units]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper left", ncols=3)
    return (
        "Errors of the projected gradient on the report's transfer, Barzilai–Borwein steps; dashed"
        " lines: tolerances, dots: where a run ended. As printed the gradient of J vanishes where"
        " the given start is forgotten: the violation stays at metres. With multipliers it is"
        " slow. Projected on the linearised defects it converges."
    )


def draw_growth(figure: Any, findings: dict[str, Finding]) -> str:
    """Draw the time per iteration over N, for the figure that the report cites and lacks."""
    ours, growth = findings["linear_in_segments"].data, findings["interior_point_growth"].data
    axes = figure.subplots()
    for label, meshes, times, color, mark in (
        ("Ipopt", growth["meshes"], growth["ipopt"], style.VERMILLION, "s"),
        ("gradient, factorisations included", ours["meshes"], ours["whole"], style.SKY, "^"),
        ("gradient step, metric factored", ours["meshes"], ours["steps"], style.BLUE, "o"),
        ("interior point", ours["meshes"], ours["own"], style.GREEN, "D"),
    ):
        axes.plot(meshes, 1e3 * np.array(times), f"{mark}-", color=color, markersize=4.5,
                  label=label)  # fmt: skip
    N, first = np.array(ours["meshes"], dtype=float), 1e3 * ours["steps"][-1]
    axes.plot(N, first * N / N[-1], color=style.MUTED, linewidth=0.9, linestyle=(0, (1, 1.5)),
              label="slope 1")  # fmt: skip
    logarithmic(axes, x=True)
    plain_ticks(axes, ours["meshes"])
    axes.set_xlabel("segments N [-]")
    axes.set_ylabel("processor time per iteration [ms]")
    axes.legend(loc="upper left")
    return (
        "Time per iteration over the number of segments, report's transfer, one core. Fitted"
        f" exponents of N: gradient step {slope(ours['meshes'], ours['steps']):.2f}, with"
        f" factorisations {slope(ours['meshes'], ours['whole']):.2f}, interior point"
        f" {slope(ours['meshes'], ours['own']):.2f}, Ipopt"
        f" {slope(growth['meshes'], growth['ipopt']):.2f}."
    )


def draw_spread(figure: Any, findings: dict[str, Finding]) -> str:
    """Draw what the seeded transfers gave: one dot a transfer, the median as a bar."""
    steps = findings["barzilai_borwein_saving"].data["saved"]
    reduced = findings["reduced_order"].data
    left, right = figure.subplots(1, 2, width_ratios=(len(steps), 2))
    dots(left, {f"α = {step}": share for step, share in steps.items()}, said=32.0)
    left.set_title("saved by Barzilai–Borwein")
    left.set_ylabel("share [%]")
    dots(right, {"time\nsaved": reduced["saving"], "loss\nof J": reduced["loss"]}, said=None)
    for place, value in ((0, 67.0), (1, 4.0)):
        right.plot([place - 0.35, place + 0.35], [value, value], color=style.VERMILLION,
                   linestyle=(0, (5, 2)))  # fmt: skip
    right.set_title("reduced order")
    return (
        f"{len(reduced['saving'])} transfers to seeded goals, one dot each; black bars are medians,"
        " dashed lines what the source report says. Left: iterations, against fixed steps α. Right:"
        " iteration time saved by the reduced model, and loss of J along its lift."
    )


def dots(axes: Any, groups: dict[str, list[float]], said: float | None) -> None:
    """Draw groups of shares side by side, in per cent."""
    for place, share in enumerate(groups.values()):
        values = 100 * np.array(share)
        shift = 0.5 * (np.arange(len(values)) / max(1, len(values) - 1) - 0.5)
        axes.plot(place + shift, values, "o", color=style.BLUE, markersize=3.5, alpha=0.7)
        middle = float(np.median(values))
        axes.plot([place - 0.35, place + 0.35], [middle, middle], color=style.INK, linewidth=2)
    if said is not None:
        axes.axhline(said, color=style.VERMILLION, linestyle=(0, (5, 2)))
    axes.set_xticks(range(len(groups)), list(groups))
    axes.set_xlim(-0.6, len(groups) - 0.4)
    axes.grid(visible=False, axis="x")


def logarithmic(axes: Any, x: bool = False) -> None:
    """Set logarithmic axes with powers of ten in plain characters."""
    axes.set_yscale("log")
    for axis in (axes.yaxis, axes.xaxis) if x else (axes.yaxis,):
        if axis is axes.xaxis:
            axes.set_xscale("log")
        axis.set_major_formatter(power_of_ten)
        axis.set_minor_formatter(NullFormatter())


def plain_ticks(axes: Any, places: list[float]) -> None:
    """Put the numbers themselves under a logarithmic axis."""
    axes.xaxis.set_major_locator(FixedLocator(places))
    axes.xaxis.set_major_formatter(FixedFormatter([f"{place:g}" for place in places]))
    axes.xaxis.set_minor_locator(FixedLocator([]))
