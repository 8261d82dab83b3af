"""IS IT TRUE: an independent certificate. Imports no solver, no transcription, no kernel."""

from skyknot.verification.base import Check
from skyknot.verification.certificate import Certificate
from skyknot.verification.certify import certify
from skyknot.verification.tolerances import Limits

__all__ = ["Certificate", "Check", "Limits", "certify"]
