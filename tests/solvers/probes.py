"""What the tests of several solvers put to them."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from typing import Any

import skyknot as sk


def mover(**extras: Any) -> sk.Problem:
    """Return a push of a mass in one second, changed by ``extras``."""
    asked = {
        "name": "mover",
        "states": ["height", "speed"],
        "controls": ["push"],
        "dynamics": lambda x, u: [x[1], u[0]],
        "horizon": 1.0,
        "initial": [1.0, 0.0],
        "final": [0.2, 0.0],
        "running_cost": lambda x, u: u[0] ** 2,
    }
    return sk.Problem(**(asked | extras))


def status_after_ctrl_c(solver: str) -> str:
    """Return what a solve prints whose callback presses Ctrl-C; ``solver`` is Python for it."""
    script = f"""
        import os, signal, skyknot as sk
        # unbounded below: never ends by itself
        problem = sk.Problem("fall", ["x"], ["u"], lambda x, u: [u[0]], 1.0, [0.0],
                             running_cost=lambda x, u: u[0])
        count = 0
        def press(record):
            global count
            count += 1
            if count == 5:
                os.kill(os.getpid(), signal.SIGINT)
        print(sk.solve(problem, sk.HermiteSimpson(5), {solver}, callback=press).status)
    """
    finished = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)],
        capture_output=True,
        text=True,
        check=False,
        env=dict(os.environ),
    )
    return finished.stdout.strip() or finished.stderr
