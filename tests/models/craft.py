"""Crafts the tests of this room fly; numbers are arbitrary but plausible."""

from __future__ import annotations

import numpy as np

from skyknot.models import Allocation, Vehicle

GRAVITY = 9.81


def sample_vehicle(**changes):
    """Return an unsymmetric small craft without drag."""
    numbers = {
        "name": "sample",
        "title": "Craft of the tests",
        "kind": "small",
        "mass": 1.3,
        "inertia": (0.011, 0.014, 0.021),
        "gravity": GRAVITY,
        "allocation": Allocation.x_levers(0.12, 0.17, 0.02),
        "thrust_min": 0.1,
        "thrust_max": 8.0,
    }
    return Vehicle(**(numbers | changes))


def random_state(random, tilt=1.2):
    """Return 12 states away from the Euler singularity."""
    x = random.normal(size=12) * 3.0
    x[6:8] = random.uniform(-tilt, tilt, 2)
    return x


def random_wrench(random):
    """Return a wrench of the size of the sample craft's."""
    return np.array([12.0, 0.3, -0.2, 0.1]) * random.uniform(0.5, 1.5, 4)
