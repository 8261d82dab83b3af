"""A mission under the mouse: ends, obstacles and limits move, the trajectory follows at once."""

from skyknot.live.adjustable import Adjustable, Limit, Wish, adjustable
from skyknot.live.planner import Plan, Planner

__all__ = ["Adjustable", "Limit", "Plan", "Planner", "Wish", "adjustable"]
