"""The names users call: one front door for each scheme."""

from __future__ import annotations

from collections.abc import Callable

from numpy.typing import ArrayLike

from skyknot.errors import UserError
from skyknot.transcription.base import Array, Transcription
from skyknot.transcription.collocation import chebyshev, lobatto, radau
from skyknot.transcription.mesh import checked, uniform
from skyknot.transcription.schemes import EULER, HERMITE_SIMPSON, SCHEMES, TRAPEZOID
from skyknot.transcription.stability_function import Stability
from skyknot.transcription.table import SchemeTable


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


def Lobatto(
    segments: int = 20,
    points: int = 5,
    *,
    controls: str = "polynomial",
    mesh: ArrayLike | None = None,
    **choices: str,
) -> Transcription:
    """Return Legendre–Gauss–Lobatto collocation, the nodes among its points.

    One segment of some tens of points is the global pseudospectral method; several make the hp
    method. Two points are the trapezoid, three Hermite–Simpson. Its order is 2·points − 2 with
    discontinuous controls; continuity at the nodes lowers it to points, or one more where odd.

    Parameters
    ----------
    segments, mesh, choices : as for Euler
    points : collocation points of a segment, its two nodes included, 2 or more
    controls : "polynomial" through the points, continuous at the nodes; "discontinuous", the same
        with values of its own at both ends of every segment; "linear" or "hold"

    References
    ----------
    Q. Gong, I. M. Ross, W. Kang & F. Fahroo, Comput. Optim. Appl. 41 (2008) 307–335.
    """
    return Transcription(lobatto(points), _nodes(segments, mesh), controls=controls, **choices)


def Radau(
    segments: int = 20,
    points: int = 4,
    *,
    controls: str | None = None,
    mesh: ArrayLike | None = None,
    **choices: str,
) -> Transcription:
    """Return Radau IIA collocation: order 2·points − 1, L-stable; one point is implicit Euler.

    Parameters
    ----------
    segments, mesh, choices : as for Euler
    points : collocation points of a segment, 1 or more; its end is one of them, its start is not
    controls : "polynomial" through the collocation points, which may jump at a node (the default
        from two points on), "linear" or "hold" (the default with one point)

    References
    ----------
    D. Garg et al., Comput. Optim. Appl. 49 (2011) 335–358.
    """
    table = radau(points)
    chosen = table.default_controls if controls is None else controls
    return Transcription(table, _nodes(segments, mesh), controls=chosen, **choices)


def Chebyshev(
    segments: int = 20,
    points: int = 5,
    *,
    controls: str = "polynomial",
    mesh: ArrayLike | None = None,
    **choices: str,
) -> Transcription:
    """Return Chebyshev–Gauss–Lobatto collocation with Clenshaw–Curtis weights, in integral form.

    Parameters
    ----------
    segments, mesh, choices : as for Euler
    points : collocation points of a segment, its two nodes included, 2 or more
    controls : as for Lobatto

    References
    ----------
    F. Fahroo & I. M. Ross, J. Guidance, Control, and Dynamics 25 (2002) 160–166.
    """
    return Transcription(chebyshev(points), _nodes(segments, mesh), controls=controls, **choices)


DOORS: dict[str, Callable[..., Transcription]] = {
    "euler": Euler,
    "trapezoid": Trapezoid,
    "hermite-simpson": HermiteSimpson,
    "lobatto": Lobatto,
    "radau": Radau,
    "chebyshev": Chebyshev,
}


def stability(scheme: Transcription | SchemeTable | str) -> Stability:
    """Return the stability function R(z) of a scheme, with region, A- and L-stability.

    Parameters
    ----------
    scheme : what ``sk.Lobatto(points=4)`` and its siblings return, its table, or a scheme's name

    Raises
    ------
    UserError
        When no scheme has this name.
    """
    if isinstance(scheme, Transcription):
        return scheme.table.stability
    if isinstance(scheme, SchemeTable):
        return scheme.stability
    if scheme not in SCHEMES:
        raise UserError(
            "There is no scheme of this name.",
            where="scheme",
            found=repr(scheme),
            expected=" or ".join(repr(name) for name in SCHEMES),
            do="Choose one of the schemes above, or give the scheme itself.",
        )
    return SCHEMES[scheme].stability


def _nodes(segments: int, mesh: ArrayLike | None) -> Array:
    return uniform(segments) if mesh is None else checked(mesh)
