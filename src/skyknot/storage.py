"""One NPZ file for a solution, and CSV for everyone else. Files are data, never executed."""

from __future__ import annotations

import json
import zipfile
import zlib
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.errors import UserError
from skyknot.solution import MeshRound, Record, Solution
from skyknot.status import Status
from skyknot.trajectory import SegmentData, Trajectory
from skyknot.whole_file import replace_file
from skyknot.witness import Witness

Array = NDArray[np.float64]

FORMAT = "skyknot solution 1"
# What reading a damaged file raises, down to its zip archive (encryption is a RuntimeError there).
_DAMAGE = (
    OSError,
    EOFError,
    ValueError,
    LookupError,
    TypeError,
    AttributeError,
    RuntimeError,
    zipfile.BadZipFile,
    zlib.error,
)
_SEGMENTS = tuple(SegmentData.__dataclass_fields__)
_MULTIPLIERS = ("defects", "path", "rates", "bounds")
# Costates and gains are the solution's own; the witness gets them when it is called.
_WITNESS = tuple(n for n in Witness.__dataclass_fields__ if n not in ("costates", "gains"))


def save(solution: Solution, path: Path) -> Path:
    """Write ``solution`` to ``path`` (.npz is added); an interrupted write leaves the old file."""
    path = path if path.suffix == ".npz" else path.with_name(path.name + ".npz")
    arrays: dict[str, Any] = {
        "metadata": np.array(json.dumps(_metadata(solution))),
        "times": solution.times,
        "states": solution.states,
        "controls": solution.controls,
        "costates": solution.costates,
        "history": solution.history,
        "decision": solution.decision,
        **{f"multiplier_{name}": solution.multipliers[name] for name in _MULTIPLIERS},
    }
    if solution.trajectory.segments is not None:
        arrays |= {f"segment_{n}": getattr(solution.trajectory.segments, n) for n in _SEGMENTS}
    if solution.witness is not None:
        arrays |= {f"witness_{name}": getattr(solution.witness, name) for name in _WITNESS}
    if solution.gains is not None:
        arrays["gains"] = solution.gains
    replace_file(path, lambda part: _write_npz(part, arrays))
    return path


def load(path: str | Path) -> Solution:
    """Read a solution written by ``Solution.save``.

    Raises
    ------
    UserError
        When the file is missing, damaged, or not a skyknot solution.
    """
    path = Path(path)
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        metadata = json.loads(str(arrays["metadata"]))
        if metadata.get("format") != FORMAT:
            raise _unreadable(path, f"format '{metadata.get('format')}'")
        return _solution(arrays, metadata)
    except FileNotFoundError as error:
        raise _unreadable(path, "no such file") from error
    except _DAMAGE as error:
        raise _unreadable(path, f"{type(error).__name__}: {error}") from error


def write_csv(solution: Solution, path: str | Path) -> Path:
    """Write node times, states and controls as CSV; units and frame stand in the header.

    Segments of more than three points write their interior points too.
    """
    trajectory, record = solution.trajectory, solution.record
    names = ("t", *trajectory.state_names, *trajectory.control_names)
    units = ("s", *record.state_units, *record.control_units)
    header = "\n".join(
        [
            f"# skyknot trajectory: {record.problem}",
            f"# frame: {record.frame}; angles: ZYX Euler; {solution.status.value}",
            "# " + ", ".join(f"{n} [{u or '-'}]" for n, u in zip(names, units, strict=True)),
            ",".join(names),
        ]
    )
    table = _rows(trajectory)
    target = Path(path)
    replace_file(
        target,
        lambda part: np.savetxt(
            part, table, delimiter=",", header=header, comments="", fmt="%.17g"
        ),
    )
    return target


def _rows(trajectory: Trajectory) -> Array:
    """Return the rows of the table: nodes, and what long segments hold between them."""
    nodes = np.column_stack([trajectory.times, trajectory.states, trajectory.controls])
    inside = trajectory.segments
    if inside is None or len(inside.interior_points) < 2:
        return nodes
    lengths = np.diff(trajectory.times)[:, None]
    t = (trajectory.times[:-1, None] + lengths * inside.interior_points).ravel()
    between = np.column_stack(
        [t, inside.interior_states.reshape(len(t), -1), trajectory.control(t)]
    )
    rows: Array = np.concatenate([nodes, between])
    return rows[np.argsort(rows[:, 0])]


def _write_npz(part: Path, arrays: dict[str, Any]) -> None:
    with part.open("wb") as stream:
        np.savez_compressed(stream, **arrays)


def _metadata(solution: Solution) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "status": solution.status.value,
        "objective": solution.objective,
        "iterations": solution.iterations,
        "solve_time": solution.solve_time,
        "kkt_residual": solution.kkt_residual,
        "max_defect": solution.max_defect,
        "state_names": solution.trajectory.state_names,
        "control_names": solution.trajectory.control_names,
        "record": asdict(solution.record),
    }


def _solution(arrays: dict[str, Any], metadata: dict[str, Any]) -> Solution:
    record = metadata["record"]
    for name in ("state_units", "control_units"):
        record[name] = tuple(record[name])
    record["rounds"] = tuple(MeshRound(**entry) for entry in record.get("rounds", ()))
    segments = None
    if any(name.startswith("segment_") for name in arrays):
        segments = SegmentData(**{name: arrays[f"segment_{name}"] for name in _SEGMENTS})
    witness = None
    if any(name.startswith("witness_") for name in arrays):
        read = {name: arrays[f"witness_{name}"] for name in _WITNESS}
        witness = Witness(**read | {"shared": bool(read["shared"])})
    return Solution(
        status=Status(metadata["status"]),
        objective=float(metadata["objective"]),
        iterations=int(metadata["iterations"]),
        solve_time=float(metadata["solve_time"]),
        history=arrays["history"],
        trajectory=Trajectory(
            arrays["times"],
            arrays["states"],
            arrays["controls"],
            segments,
            tuple(metadata["state_names"]),
            tuple(metadata["control_names"]),
        ),
        costates=arrays["costates"],
        kkt_residual=float(metadata["kkt_residual"]),
        max_defect=float(metadata["max_defect"]),
        multipliers={name: arrays[f"multiplier_{name}"] for name in _MULTIPLIERS},
        decision=arrays["decision"],
        record=Record(**record),
        gains=arrays.get("gains"),
        witness=witness,
    )


def _unreadable(path: Path, found: str) -> UserError:
    return UserError(
        "This is not a readable skyknot solution.",
        where=str(path),
        found=found,
        expected="a .npz file written by solution.save",
        do="Check the path; solve again if the file is damaged.",
    )
