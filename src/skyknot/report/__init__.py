"""Pictures: figures and the one-page HTML report. Nobody imports this room but the command line."""

from skyknot.report.figures import KINDS, draw, kinds_of, save_figures
from skyknot.report.page import write_report

__all__ = ["KINDS", "draw", "kinds_of", "save_figures", "write_report"]
