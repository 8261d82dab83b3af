"""HOW continuous becomes finite: mesh, schemes as tables, packing, recovery."""

from skyknot.transcription.base import Transcription
from skyknot.transcription.doors import (
    DOORS,
    Chebyshev,
    Euler,
    HermiteSimpson,
    Lobatto,
    Radau,
    Trapezoid,
    stability,
)
from skyknot.transcription.stability_function import iteration_matrix_norm

__all__ = [
    "DOORS",
    "Chebyshev",
    "Euler",
    "HermiteSimpson",
    "Lobatto",
    "Radau",
    "Transcription",
    "Trapezoid",
    "iteration_matrix_norm",
    "stability",
]
