"""Pictures: figures and the one-page HTML report. Nobody imports this room but the command line."""

from skyknot.report.enclosure import Enclosure
from skyknot.report.figures import KINDS, draw, kinds_of, save_figures
from skyknot.report.page import write_report

__all__ = ["KINDS", "Enclosure", "draw", "kinds_of", "save_figures", "write_report"]
