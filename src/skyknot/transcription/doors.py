"""The names users call: one front door for each scheme."""

from __future__ import annotations

from numpy.typing import ArrayLike

from skyknot.transcription.base import Array, Transcription
from skyknot.transcription.mesh import checked, uniform
from skyknot.transcription.schemes import EULER, HERMITE_SIMPSON, TRAPEZOID


def Euler(segments: int = 100, *, mesh: ArrayLike | None = None, **choices: str) -> Transcription:
    """Return the explicit Euler scheme: order 1, held control.

    Parameters
    ----------
    segments : number of equal segments
    mesh : (N+1,) nodes as fractions of the horizon, instead of ``segments``
    choices : ``enforce`` and ``objective`` of Transcription
    """
    return Transcription(EULER, _nodes(segments, mesh), controls="hold", **choices)


def Trapezoid(
    segments: int = 100, *, controls: str = "linear", mesh: ArrayLike | None = None, **choices: str
) -> Transcription:
    """Return the trapezoid scheme: order 2, linear (or held) control.

    Parameters
    ----------
    segments, mesh, choices : as for Euler
    controls : "linear" or "hold"
    """
    return Transcription(TRAPEZOID, _nodes(segments, mesh), controls=controls, **choices)


def HermiteSimpson(
    segments: int = 100,
    *,
    controls: str = "quadratic",
    form: str = "separated",
    mesh: ArrayLike | None = None,
    **choices: str,
) -> Transcription:
    """Return the Hermite–Simpson scheme, equations (11)–(12) of the source report: order 4.

    Parameters
    ----------
    segments, mesh, choices : as for Euler
    controls : "quadratic" (free midpoint control), "linear" (its average), or "hold"
    form : "separated" or "compressed"; same optimum, see Transcription
    """
    return Transcription(
        HERMITE_SIMPSON, _nodes(segments, mesh), controls=controls, form=form, **choices
    )


DOORS = {"euler": Euler, "trapezoid": Trapezoid, "hermite-simpson": HermiteSimpson}


def _nodes(segments: int, mesh: ArrayLike | None) -> Array:
    return uniform(segments) if mesh is None else checked(mesh)
