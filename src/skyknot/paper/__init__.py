"""IS THE SOURCE REPORT RIGHT: every claim of it, run and judged."""

from skyknot.paper.base import VERDICTS, Claim, Finding, Measure, Scale
from skyknot.paper.registry import EXPERIMENTS
from skyknot.paper.run import run_claims

__all__ = ["EXPERIMENTS", "VERDICTS", "Claim", "Finding", "Measure", "Scale", "run_claims"]
