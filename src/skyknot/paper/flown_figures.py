"""What the mesh cannot see: positions optimised and flown, and torques over the first moments."""

from __future__ import annotations

from typing import Any

import numpy as np

from skyknot.paper.base import Finding
from skyknot.report import style

MESHES = {"equal": style.VERMILLION, "graded": style.GREEN, "refined": style.PURPLE}
"""Meshes and the colours of their flights."""


def draw_flown(figure: Any, findings: dict[str, Finding]) -> str:
    """Draw figure 9: the optimised position, and the flights of the control."""
    finding = findings["forward_simulation"]
    paths, rows = finding.data["paths"], meshes_of(finding)
    panels = figure.subplots(3, 1, sharex=True)
    names = ("x north [m]", "y east [m]", "z down [m]")
    for i, (axes, name) in enumerate(zip(panels, names, strict=True)):
        best = paths["refined"]
        axes.plot(best["times"], column(best["optimised"], i), color=style.BLUE, linewidth=3.2,
                  alpha=0.45, label="optimised")  # fmt: skip
        for mesh, color in MESHES.items():
            axes.plot(paths[mesh]["times"], column(paths[mesh]["flown"], i), color=color,
                      linestyle=(0, (5, 2)) if mesh == "graded" else "-", linewidth=1.3,
                      label=f"flown, {mesh}, N = {rows[mesh]['segments']}")  # fmt: skip
        axes.set_ylabel(name)
    panels[-1].set_xlabel("time [s]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper left", ncols=2)
    miss = {mesh: row["miss"] for mesh, row in rows.items()}
    return (
        "The optimised position and what its control does when flown open loop from x(0). On"
        f" {rows['equal']['segments']} equal segments the flight ends {miss['equal']:.1f} m off;"
        f" on as many graded ones {100 * miss['graded']:.1f} cm; on the mesh that refined itself"
        f" {1e3 * miss['refined']:.1f} mm."
    )


def draw_start(figure: Any, findings: dict[str, Finding]) -> str:
    """Draw the torques over the first moments, mesh by mesh, with the nodes."""
    data = findings["forward_simulation"].data
    starts, rows = data["starts"], meshes_of(findings["forward_simulation"])
    panels = figure.subplots(len(MESHES), 2, sharex=True, sharey=True)
    fine = starts["fine"]
    for (mesh, color), pair in zip(MESHES.items(), panels, strict=True):
        start = starts[mesh]
        for i, axes in enumerate(pair):
            axes.plot(fine["times"], column(fine["torques"], i), color=style.FAINT, linewidth=3.0)
            axes.plot(start["times"], column(start["torques"], i), color=color, linewidth=1.3)
            axes.plot(start["nodes"], column(start["node torques"], i), "o", color=color,
                      markersize=3.0)  # fmt: skip
        pair[0].set_ylabel(f"{mesh}, N = {rows[mesh]['segments']}\ntorque [N m]")
    panels[0, 0].set_title("roll torque τx")
    panels[0, 1].set_title("pitch torque τy")
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    return (
        f"Torques over the first {fine['times'][-1]:g} s, nodes as dots; grey: {data['fine']} equal"
        " segments. The optimum throws the torque from one bound to the other within"
        " tenths of a second. Equal segments put a quadratic through values at their ends and"
        " middles; what the craft does between those is not in their equations."
    )


def meshes_of(finding: Finding) -> dict[str, dict[str, Any]]:
    """Return the rows of the meshes drawn, by name; of equal ones that of the report's N."""
    rows = finding.data["rows"]
    report = next(row["segments"] for row in rows if row["mesh"] == "graded")
    return {row["mesh"]: row for row in rows if row["mesh"] != "equal" or row["segments"] == report}


def column(values: list[list[float]], i: int) -> Any:
    """Return one column of rows."""
    return np.array(values)[:, i]
