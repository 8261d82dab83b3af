"""NetCDF for archives: every state and control under its own name, with units.

Classic format with 64-bit offsets (NetCDF-3), so that no library but SciPy is needed to write it
and every NetCDF library reads it. Attributes follow the CF Conventions 1.8 (units as UDUNITS
writes them); what skyknot adds, certificate and provenance, stands in global attributes. Axes are
those of the problem: nothing is turned.
"""

from __future__ import annotations

import io
import json
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import netcdf_file

from skyknot.export.base import Encoded, Format, Request
from skyknot.export.samples import state_names
from skyknot.version import __version__

Array = NDArray[np.float64]

LARGE_FILES = 2
POWERS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")


def encode(request: Request) -> Encoded:
    """Return the archive; at the nodes it has the costates too."""
    stream = io.BytesIO()
    file = netcdf_file(stream, "w", version=LARGE_FILES)
    for name, text in _provenance(request).items():
        setattr(file, name, text.encode("utf-8"))
    file.createDimension("time", len(request.times))
    start = request.solution.trajectory.times[0]
    _add(file, "time", request.times - start, "s", "time from the start of the flight")
    _add_states(file, request)
    _add_flight(file, request)
    file.flush()
    content = stream.getvalue()
    file.close()
    return Encoded(content, "numbers to their last bit")


def _add_states(file: Any, request: Request) -> None:
    solution, trajectory = request.solution, request.solution.trajectory
    states, controls = trajectory.state(request.times), trajectory.control(request.times)
    names = state_names(solution) or _numbered("state", states)
    for name, unit, column in zip(
        names, _padded(solution.record.state_units, names), states.T, strict=True
    ):
        _add(file, name, column, unit, f"state {name}")
    names_u = trajectory.control_names or _numbered("control", controls)
    for name, unit, column in zip(
        names_u, _padded(solution.record.control_units, names_u), controls.T, strict=True
    ):
        _add(file, name, column, unit, f"control {name}")
    if np.array_equal(request.times, solution.times):
        for name, column in zip(names, solution.costates.T, strict=True):
            _add(file, f"costate_{name}", column, None, f"costate of {name}")


def _add_flight(file: Any, request: Request) -> None:
    flight = request.flight
    if flight is None:
        return
    if flight.attitude is not None:
        for axis, column in zip("wxyz", flight.attitude.quaternions.T, strict=True):
            _add(file, f"q_{axis}", column, "1", f"attitude quaternion, body to world, {axis}")
    if flight.rotor_thrusts is not None:
        for i, column in enumerate(flight.rotor_thrusts.T, start=1):
            _add(file, f"rotor_thrust_{i}", column, "N", f"thrust of rotor {i}")


def _add(file: Any, name: str, values: Array, unit: str | None, meaning: str) -> None:
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)
    while plain in file.variables:
        plain += "_"
    variable = file.createVariable(plain, "d", ("time",))
    variable[:] = values
    variable.long_name = meaning.encode("utf-8")
    if unit is not None:
        variable.units = udunits(unit).encode("utf-8")


def udunits(unit: str) -> str:
    """Return a unit as UDUNITS writes it: "m/s²" is "m s-2", none is "1"."""
    if not unit:
        return "1"
    above, *below = unit.translate(POWERS).replace("^", "").replace("·", " ").split("/")
    inverse = [re.sub(r"^(\D+)(\d*)$", r"\1-\2", part) for rest in below for part in rest.split()]
    inverse = [part if part[-1].isdigit() else part + "1" for part in inverse]
    return " ".join([*above.split(), *inverse]) if above.strip() != "1" else " ".join(inverse)


def _provenance(request: Request) -> dict[str, str]:
    record = request.solution.record
    return {
        "Conventions": "CF-1.8",
        "title": request.title,
        "source": f"skyknot {__version__}",
        "certificate": request.verdict,
        "frame": f"{record.frame}: x north, y east, z down; body x forward, y right, z down; "
        "angles ZYX Euler; q takes body to world"
        if request.flight is not None
        else record.frame,
        "status": request.solution.status.value,
        "objective": repr(request.solution.objective),
        "transcription": f"{record.transcription}, {record.segments} segments",
        "solver": f"{record.solver}, tolerance {record.tolerance:g}",
        "versions": json.dumps(record.versions),
        "inputs_hash": record.inputs_hash or "unknown",
    }


def _numbered(kind: str, values: Array) -> tuple[str, ...]:
    return tuple(f"{kind}_{i + 1}" for i in range(values.shape[1]))


def _padded(units: tuple[str, ...], names: tuple[str, ...]) -> tuple[str, ...]:
    return units if len(units) == len(names) else ("",) * len(names)


NETCDF = Format(
    name="netcdf",
    title="NetCDF with every state, control and costate",
    file_name="flight.nc",
    encode=encode,
    samples_anything=True,
)
