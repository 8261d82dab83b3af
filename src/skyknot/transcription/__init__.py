"""HOW continuous becomes finite: mesh, schemes as tables, packing, recovery."""

from skyknot.transcription.base import Transcription
from skyknot.transcription.doors import DOORS, Euler, HermiteSimpson, Trapezoid

__all__ = ["DOORS", "Euler", "HermiteSimpson", "Transcription", "Trapezoid"]
