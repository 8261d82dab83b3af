"""Section 5.2: the stability region of the scheme, and the step-size test (15).

Legend: z = λ h, R(z) = x₁/x₀ of one segment on ẋ = λx, H Hessian ∇²J, α step size.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from skyknot.paper.base import Claim, Finding, Measure, Scale, judged
from skyknot.paper.transfers import DURATION, FINAL_SHARE, GOAL, SEGMENTS, Q, R, scheme, state_at
from skyknot.solve import resolve_transcription

Array = NDArray[np.float64]
Complex = NDArray[Any]


def stability_function(z: Complex) -> Complex:
    """Return R(z), of any shape, from the rows of the scheme's own table."""
    return resolve_transcription(scheme(1)).table.stability(z)


def pade(z: Complex) -> Complex:
    """Return the (2, 2) Padé approximant of exp(z), the closed form of R(z)."""
    return np.asarray((1 + z / 2 + z**2 / 12) / (1 - z / 2 + z**2 / 12))


def stability_region(scale: Scale) -> Finding:
    """Judge "a substantial portion of the left half plane, the entire imaginary axis"."""
    count = scale.pick(41, 161)
    real, imaginary = np.linspace(-8, 8, count), np.linspace(-8, 8, count)
    z = real[None, :] + 1j * imaginary[:, None]
    size = np.abs(stability_function(z))
    left, right = size[:, real < 0], size[:, real > 0]
    axis = np.abs(stability_function(1j * np.logspace(-3, 4, 50)))
    stiff = abs(stability_function(np.array([-1e6 + 0j]))[0])
    poles = resolve_transcription(scheme(1)).table.stability.poles
    agreement = float(np.abs(stability_function(z) - pade(z)).max() / np.abs(pade(z)).max())
    stable, on_axis = float(np.mean(left <= 1)), float(np.abs(axis - 1).max())
    claim = Claim(
        claim="Stability region",
        section="5.2",
        said=(
            "The region includes a substantial portion of the left half plane and the entire"
            " imaginary axis; suited to stiff equations."
        ),
        measured=(
            Measure("stable share of the left half plane", stable),
            Measure("stable share of the right half plane", float(np.mean(right <= 1))),
            Measure("largest | |R(iy)| − 1 |", on_axis),
            Measure("|R(−10⁶)|", stiff),
            Measure("smallest real part of a pole", float(np.min(poles.real))),
            Measure("table against Padé (2, 2), relative", agreement),
        ),
        how=(
            f"R(z) computed from the rows of the scheme's table on {count} × {count} points of"
            " |Re z|, |Im z| ≤ 8, and along the imaginary axis to 10⁴."
        ),
        verdict=judged(stable > 0.5 and on_axis < 1e-9),
        why=(
            "R(z) = (1 + z/2 + z²/12)/(1 − z/2 + z²/12): the region is exactly the closed left half"
            f" plane. On the axis nothing is damped, and |R| tends to {stiff:.3g} for stiff"
            " modes, so they do not die out: A-stable, not L-stable."
        ),
    )
    data = {"real": real.tolist(), "imaginary": imaginary.tolist(), "size": size.tolist()}
    return Finding(claim, data)


def step_size_test(scale: Scale) -> Finding:
    """Judge (15): ‖I − α∇²J‖ < 1 keeps the iteration stable."""
    H, target = cost_hessian(scale.pick(20, SEGMENTS))
    least, largest = float(H.min()), float(H.max())
    bound = 2 / largest
    z0, steps = np.zeros_like(target), 50
    growth = {}
    for share in (0.95, 1.05):
        alpha = share * bound
        z = z0
        for _ in range(steps):
            z = z - alpha * H * (z - target)
        growth[share] = float(np.linalg.norm(z - target) / np.linalg.norm(z0 - target))
    rate = (largest - least) / (largest + least)
    needed = float(np.ceil(np.log(1e-6) / np.log(rate)))
    gap = float(np.linalg.norm(state_at(GOAL)))
    claim = Claim(
        claim="Step-size test",
        section="5.2, equation (15)",
        said="Choosing α with ‖I − α∇²J(z)‖ < 1 keeps the algorithm stable.",
        measured=(
            Measure("largest stable α, 2/λmax", bound),
            Measure("condition λmax/λmin of ∇²J", largest / least),
            Measure(f"distance left after {steps} steps at 0.95 of it", growth[0.95]),
            Measure(f"distance left after {steps} steps at 1.05 of it", growth[1.05]),
            Measure("steps to 1e-6 at the best constant α", needed),
            Measure("jump from x(0) that the minimiser of J alone asks for", gap, "SI"),
        ),
        how=(
            "∇²J of (10) by Simpson quadrature is diagonal here; gradient descent on J without"
            " constraints, steps just below and just above 2/λmax."
        ),
        verdict=judged(False, growth[0.95] < 1 < growth[1.05]),
        why=(
            "The test is right for descent on J alone. But J alone is least at x = x_f, u = u_h"
            " for all times, which is no flight from x(0): the test must be put to the Hessian"
            " within the linearised dynamics, not to ∇²J."
        ),
    )
    return Finding(claim, {"growth": [growth[0.95], growth[1.05]]})


def cost_hessian(segments: int) -> tuple[Array, Array]:
    """Return diagonal of ∇²J, and minimiser of J, over nodes and midpoints (x, u)."""
    h = DURATION / segments
    b = resolve_transcription(scheme(1)).table.b
    weight = np.zeros(2 * segments + 1)
    for j in range(3):
        weight[j : 2 * segments - 1 + j : 2] += h * b[j]
    H = 2 * weight[:, None] * np.concatenate([Q, R])
    H[-1, : len(Q)] += 2 * FINAL_SHARE * Q
    hover = np.zeros(len(R))
    target = np.tile(np.concatenate([state_at(GOAL), hover]), (len(weight), 1))
    return H.ravel(), target.ravel()
