"""The controls flown through the equations by another integrator than the scheme's own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853

from skyknot.trajectory import Trajectory
from skyknot.verification.equations import Equations

Array = NDArray[np.float64]

TOLERANCE = 1e-9
"""Relative and absolute tolerance of the integrator: far below any limit judged with it."""

MOST_STEPS = 20_000
"""Steps after which a flight is given up as diverging."""


def fly(equations: Equations, trajectory: Trajectory, C: Array) -> Array:
    """Return the flown states (N+1, nx); NaN from where the integrator gave up.

    Dormand–Prince of order 8 (SciPy's DOP853), restarted at every node because controls may have
    kinks or jumps there.

    Parameters
    ----------
    equations : of the problem
    trajectory : where to start, and the nodes (N+1,)
    C : (N, m, nu) Chebyshev coefficients of the controls
    """
    times = trajectory.times
    right_side, coefficients, segment = equations.flight(C.shape[1])
    flown = np.full_like(trajectory.states, np.nan)
    flown[0] = trajectory.states[0]
    steps = 0
    for k, h in enumerate(np.diff(times)):
        coefficients[:], segment[:] = C[k], (times[k], h)
        with np.errstate(all="ignore"):  # a diverging flight is a verdict, not a warning
            solver = DOP853(
                right_side,
                times[k],
                flown[k],
                times[k + 1],
                first_step=h,
                rtol=TOLERANCE,
                atol=TOLERANCE,
            )
            while solver.status == "running" and steps < MOST_STEPS:
                solver.step()
                steps += 1
        if solver.status != "finished" or not np.all(np.isfinite(solver.y)):
            break
        flown[k + 1] = solver.y
    return flown
