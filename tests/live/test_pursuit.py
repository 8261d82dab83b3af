"""Claim: the newest wish is followed, a nonsense one is told, and rest brings the certificate."""

from __future__ import annotations

import queue
import threading

import numpy as np
import pytest

from skyknot import missions
from skyknot.live import Planner
from skyknot.live.pursuit import Pursuit

PATIENCE = 60.0
"""Seconds to wait for a plan on a busy machine."""


@pytest.fixture
def followed():
    """Return a pursuit of a small mission, and the queue of the plans it shows."""
    shown = queue.SimpleQueue()
    pursuit = Pursuit(Planner(missions.load("yaw_point_transfer")), shown.put)
    yield pursuit, shown
    pursuit.close()


def first(shown, holds):
    """Return the first plan shown that holds."""
    while not holds(plan := shown.get(timeout=PATIENCE)):
        pass
    return plan


def test_the_last_of_many_wishes_is_planned_and_then_certified(followed):
    pursuit, shown = followed
    home, steps = np.array(pursuit.planner.wish.goal), 200
    for k in range(1, steps + 1):
        pursuit.ask(goal=home + 0.002 * k)
    wanted = tuple(home + 0.002 * steps)
    quick = first(shown, lambda plan: plan.wish.goal == wanted)
    assert quick.solved, quick.sentence
    assert not quick.thorough
    thorough = first(shown, lambda plan: plan.thorough)
    assert thorough.wish.goal == wanted
    assert thorough.certified, thorough.sentence
    assert pursuit.planner.certified is thorough


def test_wishes_of_different_kinds_are_merged(followed):
    pursuit, shown = followed
    home = np.array(pursuit.planner.wish.goal)
    pursuit.ask(goal=home + 0.1)
    pursuit.ask(start=np.array(pursuit.planner.wish.start) + 0.05)
    plan = first(shown, lambda plan: plan.wish.start[0] != pursuit.planner.adjustable.wish.start[0])
    np.testing.assert_allclose(plan.wish.goal, home + 0.1)


def test_a_wish_that_makes_no_sense_is_shown_as_a_reason(followed):
    pursuit, shown = followed
    pursuit.ask(goal=(np.nan, 0.0, 0.0))
    plan = first(shown, lambda plan: not plan.solved)
    assert plan.sentence == "No plan: 'goal' is not a place. Give one number for each axis."
    pursuit.ask(goal=pursuit.planner.adjustable.wish.goal)
    assert first(shown, lambda plan: not plan.thorough).solved


def test_closing_ends_its_threads(followed):
    pursuit, _ = followed
    pursuit.close()
    assert not [t for t in threading.enumerate() if t.name in ("re-plans", "certificate")]
