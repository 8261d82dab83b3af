"""From a solution to a file: is it certified, is everything there, write it whole or not at all."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from skyknot.errors import UserError
from skyknot.export.base import Encoded, Format, Request
from skyknot.export.formats import FORMATS
from skyknot.export.geodesy import Origin, parsed_origin
from skyknot.export.samples import Flight, sample_times, sampled, state_names
from skyknot.solution import Solution
from skyknot.whole_file import replace_file

MARK = "UNCERTIFIED"


@dataclass(frozen=True)
class Written:
    """What was written.

    Attributes
    ----------
    path : the file
    format : its format
    samples : number of samples, or of waypoints
    accuracy : what a reader may rely on
    verdict : what the file says about its certificate
    """

    path: Path
    format: Format
    samples: int
    accuracy: str
    verdict: str


def write_export(
    solution: Solution,
    path: str | Path,
    to: str | None = None,
    *,
    rate: float | None = None,
    frame: str | None = None,
    origin: Origin | str | None = None,
    certificate: Any = None,
    uncertified: bool = False,
) -> Written:
    """Write a solution in a format that other programs read.

    Parameters
    ----------
    solution : solved, and certified unless ``uncertified``
    path : file to write, through a temporary file; what was there before is replaced
    to : name of a format; told from the file's ending when None
    rate : samples per second; the format's own when None
    frame : "ned" or "enu", for formats that leave a choice
    origin : place on Earth of x = y = z = 0, for formats that need one; Origin or "LAT,LON,ALT"
    certificate : of this solution; made when None
    uncertified : write an uncertified solution too, and mark the file

    Raises
    ------
    UserError
        When there is no such format, the certificate fails, the format needs what is not there,
        or the file cannot be written.
    """
    target = Path(path)
    wanted = format_named(to, target)
    failing = uncertified_because(solution, certificate)
    if failing and not uncertified:
        raise UserError(
            "This flight is not certified, so it is not exported.",
            where=solution.record.problem,
            found=failing,
            expected="a solution whose certificate passes",
            do="Mend it (a finer mesh, often), or export it marked, with uncertified=True.",
        )
    place = parsed_origin(origin) if isinstance(origin, str) else origin
    verdict = f"{MARK}: {failing}" if failing else "certified"
    axes = _frame(wanted, frame)
    chosen_rate = wanted.rate if rate is None else rate
    times = sample_times(solution.trajectory, chosen_rate, wanted.tick)
    flight = None if _is_other(solution, wanted) else sampled(solution, times)
    _check_needs(wanted, flight, place)
    encoded = wanted.encode(Request(solution, times, flight, axes, rate, verdict, place))
    replace_file(target, lambda part: part.write_bytes(encoded.content))
    points = len(times) if encoded.points is None else encoded.points
    return Written(target, wanted, points, _accuracy(encoded, flight), verdict)


def uncertified_because(solution: Solution, certificate: Any = None) -> str:
    """Return why a solution is not certified, in one line; empty when it is."""
    if not solution.success:
        return f"not solved, {solution.status.value}"
    if certificate is None and solution.problem is None:
        return "not verified, as its problem is not at hand"
    certificate = certificate or solution.verify()
    if certificate.passed:
        return ""
    return " ".join(certificate.sentence.split()).removeprefix("Not certified: ").rstrip(".")


def format_named(to: str | None, target: Path | None = None) -> Format:
    """Return a format by its name, or by the ending of the file it is for.

    Raises
    ------
    UserError
        When there is no such format, or the ending fits none or several.
    """
    suffix = "" if target is None else target.suffix
    fitting = [name for name, known in FORMATS.items() if known.suffix == suffix]
    if to is None and len(fitting) == 1:
        return FORMATS[fitting[0]]
    if to in FORMATS:
        return FORMATS[str(to)]
    raise UserError(
        "There is no such export format." if to else "The export format is not clear.",
        where="to",
        found=repr(to) if to else f"no format, and the ending '{suffix}'",
        expected=", ".join(fitting if to is None and fitting else FORMATS),
        do="Name one of these formats.",
    )


def _frame(wanted: Format, frame: str | None) -> str:
    if frame is None:
        return wanted.frames[0] if wanted.frames else ""
    if frame in wanted.frames:
        return frame
    raise UserError(
        "The format cannot be written in this frame.",
        where=f"frame of {wanted.name}",
        found=repr(frame),
        expected=" or ".join(wanted.frames) or "no frame: the format has its own",
        do="Leave the frame out, or name one of these.",
    )


def _is_other(solution: Solution, wanted: Format) -> bool:
    """Return whether this is no flight, but something that the format takes all the same."""
    flies = {"x", "y", "z"} <= set(state_names(solution)) and solution.record.frame == "NED"
    return wanted.samples_anything and not flies


def _check_needs(wanted: Format, flight: Flight | None, origin: Origin | None) -> None:
    if "origin" in wanted.needs and origin is None:
        raise UserError(
            f"The format {wanted.name} needs a place on Earth, and the flight has none.",
            where="origin",
            found="none",
            expected="latitude, longitude and altitude of x = y = z = 0",
            do="Add --origin LAT,LON,ALT (origin=... in Python), or [origin] to the mission.",
        )
    there: dict[str, object] = {}
    if flight is not None:
        there["attitude"] = flight.attitude
        there["thrust"] = flight.thrust
        there["rotors"] = flight.rotor_thrusts
    for need, present in there.items():
        if need in wanted.needs and present is None:
            raise UserError(
                f"The format {wanted.name} needs what this flight does not tell.",
                where=need,
                found="a model without it, and no vehicle to derive it from",
                expected="the flight of a vehicle, or of a model with attitude and thrust",
                do="Export a run folder, or a solution that carries its problem with a vehicle.",
            )


def _accuracy(encoded: Encoded, flight: Flight | None) -> str:
    if flight is None or encoded.points is not None:
        return encoded.accuracy
    return f"{encoded.accuracy}; straight lines between samples stay within {flight.gap:.2g} m"
