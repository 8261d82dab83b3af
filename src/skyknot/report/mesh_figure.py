"""Figure "mesh": how fine the segments are, how wrong each is, and how the mesh came to be.

Legend: N segments, nx states; the error of segment k is max_i ∫ |dx̃_i/dt − f_i(x̃, ũ)| dt / w_i with
w_i = 1 + max |x̃_i|: Betts, Practical Methods for Optimal Control, 2nd ed., section 4.7.3.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.ticker import FuncFormatter, NullFormatter
from numpy.typing import NDArray

from skyknot.report import style
from skyknot.report.base import Kind
from skyknot.report.progress import power_of_ten
from skyknot.report.reading import Reading
from skyknot.report.reflight import equations

Array = NDArray[np.float64]

QUADRATURE = np.polynomial.legendre.leggauss(5)
"""Places and weights in a segment."""

SMALLEST = 1e-16
"""Zero on a logarithmic axis."""


def segment_errors(reading: Reading) -> Array:
    """Return (N,) relative errors of the segments."""
    trajectory, problem = reading.trajectory, reading.problem
    places, weights = 0.5 * (QUADRATURE[0] + 1), 0.5 * QUADRATURE[1]
    lengths = np.diff(trajectory.times)
    times = (trajectory.times[:-1, None] + lengths[:, None] * places).ravel()
    rates = equations(problem, reading.solution.record.parameters).map(len(times))
    states, controls = trajectory.state(times), trajectory.control(times)
    wrong = np.abs(trajectory.state_rate(times) - rates(states.T, controls.T, times[None]).full().T)
    size = 1 + np.max(np.abs(trajectory.states), axis=0)
    parts = (wrong / size).reshape(len(lengths), len(places), -1)
    result: Array = np.max(lengths[:, None] * np.einsum("q,kqx->kx", weights, parts), axis=1)
    return result


def draw_mesh(figure: Any, reading: Reading) -> str:
    """Draw lengths and errors of the segments over time, and the rounds of a refinement."""
    rounds = reading.solution.record.rounds
    upper, lower, *rest = figure.subplots(3 if rounds else 2, 1)
    times, errors = reading.trajectory.times, segment_errors(reading)
    upper.stairs(np.diff(times), times, color=style.BLUE, linewidth=1.6, baseline=None)
    upper.set_ylim(0, 1.25 * float(np.max(np.diff(times))))
    upper.set_ylabel("segment [s]")
    upper.sharex(lower)
    upper.tick_params(labelbottom=False)
    lower.stairs(
        np.maximum(errors, SMALLEST), times, color=style.VERMILLION, linewidth=1.4, baseline=None
    )
    _logarithmic(lower)
    lower.set_ylabel("error [-]")
    lower.set_xlabel("time [s]")
    if rounds:
        _draw_rounds(rest[0], reading)
    worst = int(np.argmax(errors))
    said = _rounds_in_words(reading) if rounds else ""
    return (
        "Length of every segment, and how far the interpolant is from obeying the equations in it,"
        " integrated, as a share of the states' sizes (Betts). Largest:"
        f" {errors[worst]:.2g} at {times[worst]:.3g} s.{said}"
    )


def _draw_rounds(axes: Any, reading: Reading) -> None:
    """Draw the error of every mesh of a refinement against its segments."""
    rounds, record = reading.solution.record.rounds, reading.solution.record
    counts = np.arange(1, len(rounds) + 1)
    values = [max(entry.error, SMALLEST) for entry in rounds]
    axes.plot(counts, values, "o-", color=style.GREEN, markersize=4)
    for count, value, entry in zip(counts, values, rounds, strict=True):
        axes.annotate(f"{entry.segments}", (count, value), (0, 5), textcoords="offset points",
                      ha="center", fontsize=8, color=style.MUTED)  # fmt: skip
    if record.accuracy is not None:
        axes.axhline(record.accuracy, color=style.MUTED, linewidth=0.9, linestyle=(0, (5, 3)))
    _logarithmic(axes)
    axes.margins(x=0.08, y=0.35)
    axes.set_xticks(counts)
    axes.set_ylabel("error [-]")
    axes.set_xlabel("mesh of the refinement [-]")


def _rounds_in_words(reading: Reading) -> str:
    rounds, accuracy = reading.solution.record.rounds, reading.solution.record.accuracy
    asked = "" if accuracy is None else f"; dashed: the accuracy asked for, {accuracy:.2g}"
    return f" Below: the error of each of the {len(rounds)} meshes, with its segments{asked}."


def _logarithmic(axes: Any) -> None:
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(power_of_ten))
    axes.yaxis.set_minor_formatter(NullFormatter())


MESH_FIGURE = Kind(
    "mesh", "Mesh and error", (5.2, 4.0), lambda reading: reading.problem is not None, draw_mesh
)
