"""Write docs/schemes.md and its figure: orders, stability and spectral decay, all measured anew.

Run: python docs/make_schemes_page.py
"""

from __future__ import annotations

from math import factorial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from skyknot.bench import smooth_problems
from skyknot.bench.observed_orders import QUANTITIES, Case, cases, decay, observed
from skyknot.report.stability_picture import write_figure
from skyknot.report.style import BLUE, GREEN, INK, MUTED, VERMILLION, styled

PAGE = Path(__file__).with_name("schemes.md")
PICTURE = Path(__file__).with_name("pictures") / "spectral_decay.png"

LINEAR, CURVED, MAYER = (
    smooth_problems.linear(),
    smooth_problems.curved(),
    smooth_problems.mayer(),
)
POINTS = tuple(range(5, 38, 2))
TOLD = (5, 9, 13, 17, 21, 25, 31, 37)
FAMILIES = {"lobatto": BLUE, "radau": GREEN, "chebyshev": VERMILLION}

INTRODUCTION = """\
# Schemes: orders, stability, spectral decay

*Made by `docs/make_schemes_page.py`, which measures all of it anew; change it there.*

[choosing.md](choosing.md) says when to take which. `skyknot schemes` lists them, and
`skyknot schemes radau --points 3 --plot radau.png` draws a stability region.

A segment of `lobatto` and `chebyshev` has points at both of its nodes, one of `radau` at its end
only. All collocate in integral form: the state is the integral of the polynomial through the rates
at the points. One segment with some tens of points is the global pseudospectral method, several
segments make the hp method.

## Orders

The error falls like the number of segments to the power of minus the order. Claimed are the orders
of states and costates at the nodes and of the controls at the scheme's own points, on smooth optima
with no bound active. Measured are the slopes over three meshes for states x, controls u and
costates p: on ½∫(u² + 2x²), ẋ = x/2 + u (Hager, Numer. Math. 87, 2000), and on the same problem
curved by x = sinh y, u = sinh v, both with closed forms; "–" where double precision leaves no room
for three meshes. `tests/orders/test_claimed_orders.py` holds them to ± 0.15.
"""

ON_ORDERS = """\
What the table shows:

- Controls carry the error of the costates *inside* the segments, which is of lower order than that
  at the nodes: points − 1 with Lobatto, points with Radau.
- `polynomial` controls of Lobatto are continuous at the nodes. One value then serves two segments,
  which lowers states and costates to points (or one more where odd); with `discontinuous` controls
  the order is 2 · points − 2. (On linear dynamics the costates do not feel it.) With one segment
  both are the same.
- Clenshaw and Curtis's weights do not pair with Chebyshev's points as Gauss's do: the discrete
  adjoint is exact for constants where the number of points is odd, and for nothing where it is
  even. Where the optimal control depends on the costate the order is 4 or 2, however many points.
- Held and linear controls limit the order to 2 and 4 whatever the points.
- With a control of its own at every stage the claimed orders are those of the order conditions: all
  two-coloured rooted trees of the scheme and its discrete adjoint, counted through up to eight
  vertices in `tests/transcription/test_optimality_trees.py`.
"""

ON_STABILITY = """\
## Stability

R(z) = x₁/x₀ of one segment on ẋ = λx, z = hλ, from the scheme's own table. A-stable: |R| ≤ 1 in
the left half plane, by the imaginary axis and the poles; L-stable: R(∞) = 0 besides, so that stiff
modes die at once instead of ringing on. `sk.stability(scheme)` is this table's source.
"""

ON_DECAY = """\
## Spectral decay

One segment, N points. Largest errors of states and controls over the whole horizon, and of
costates at the points (covector mapping), against equation (29) of the source report,
E_N ≤ C Mᴺ/N!.

![Errors of one long segment against equation (29)](pictures/spectral_decay.png)

- Left, the linear problem over T = 3: e^(±3t/2) is entire, and the errors follow (29) with
  M = ωT/4 = 1.125, ω = 3/2; for the states C < 1.
- Right, Garg's problem, whose optimum has a pole beside the horizon: no C and M make (29) hold;
  the decay is geometric, ρ⁻ᴺ with ρ = 3.81 of the ellipse through the pole (Trefethen,
  Approximation Theory and Approximation Practice, theorem 8.2). Its control does not depend on the
  costate, and there Chebyshev's states and controls decay like Lobatto's.
- Where the control does depend on the costate (left), Chebyshev's errors decay algebraically only:
  use Lobatto or Radau.
"""


def main() -> None:
    """Measure, draw and write."""
    write_figure(figure(), PICTURE)
    PAGE.write_text(page(), encoding="utf-8")


def page() -> str:
    """Return the text of the page."""
    parts = [INTRODUCTION, orders(), ON_ORDERS, ON_STABILITY, stability(), ON_DECAY, errors()]
    return "\n".join(parts)


def orders() -> str:
    """Return the table of orders."""
    head = ("scheme", "points", "control", "claimed x / u / p", "linear x / u / p",
            "curved x / u / p")  # fmt: skip
    rows = []
    for case in cases():
        claimed = " / ".join(str(getattr(case.claimed, name)) for name in QUANTITIES)
        found = [slopes(observed(case, smooth)) for smooth in (LINEAR, CURVED)]
        rows.append((f"`{case.scheme}`", str(case.points or "–"), case.controls, claimed, *found))
    return table(head, rows)


def slopes(found: dict[str, float]) -> str:
    """Return observed orders as words."""
    return " / ".join(f"{found[n]:.2f}" if n in found else "–" for n in QUANTITIES)


def stability() -> str:
    """Return the table of stability."""
    head = ("scheme", "points", "A-stable", "L-stable", "R(∞)", "least real part of a pole")
    rows = []
    for case in dict.fromkeys(Case(each.scheme, each.points, "hold") for each in cases()):
        found = case.on(1).table.stability
        poles = f"{found.poles.real.min():.2f}" if len(found.poles) else "none"
        limit = "∞" if np.isinf(found.at_infinity) else f"{found.at_infinity:.0f}"
        verdicts = ("yes" if each else "no" for each in (found.a_stable, found.l_stable))
        rows.append((f"`{case.scheme}`", str(case.points or "–"), *verdicts, limit, poles))
    return table(head, rows)


def errors() -> str:
    """Return the tables of errors of one segment."""
    parts = []
    for title, smooth in (("Linear problem", LINEAR), ("Garg's problem", MAYER)):
        found = {family: decay(family, smooth, TOLD) for family in FAMILIES}
        head = ("N", *(f"{family} x / u / p" for family in FAMILIES))
        rows = [
            (str(N), *(" / ".join(f"{v:.0e}" for v in found[family][i]) for family in FAMILIES))
            for i, N in enumerate(TOLD)
        ]
        parts.append(f"{title}:\n\n{table(head, rows)}")
    return "\n".join(parts)


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """Return a Markdown table."""
    lines = [head, tuple("---" for _ in head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def bound() -> NDArray[np.float64]:
    """Return Mᴺ/N! of equation (29) for the linear problem, M = ωT/4."""
    M = 1.5 * LINEAR.problem.duration_guess / 4
    return np.array([M**N / factorial(N) for N in POINTS])


def geometric() -> NDArray[np.float64]:
    """Return ρ^−N of the ellipse through the pole of Garg's optimum."""
    pole = (-np.log(3) + 1j * np.pi) / 2.5 - 1.0
    rho = max(abs(pole + sign * np.sqrt(pole**2 - 1)) for sign in (1, -1))
    return rho ** -np.array(POINTS, dtype=float)


def figure() -> Figure:
    """Return the errors of one long segment on both problems."""
    panels = (
        ("linear problem: entire optimum", LINEAR, 20 * bound(), "(29): 20 · 1.125ᴺ / N!"),
        ("Garg's problem: a pole nearby", MAYER, 3 * geometric(), "3 · 3.81⁻ᴺ"),
    )
    with styled():
        drawn = Figure(figsize=(8.2, 3.7), layout="constrained")
        for axes, (title, smooth, line, label) in zip(
            drawn.subplots(1, 2, sharey=True), panels, strict=True
        ):
            for family, colour in FAMILIES.items():
                found = decay(family, smooth, POINTS)
                axes.semilogy(POINTS, found[:, 0], "o-", color=colour, ms=3, label=f"{family} x")
                axes.semilogy(POINTS, found[:, 1], "--", color=colour, lw=1, label=f"{family} u")
            rule = axes.semilogy(POINTS, line, color=INK, lw=2.4, alpha=0.35, label=label)
            axes.axhline(1e-10, color=MUTED, lw=0.8, ls=":")
            axes.set(title=title, xlabel="points N of one segment [-]", ylim=(1e-16, 3.0))
            axes.yaxis.set_major_formatter(lambda value, _: f"{value:.0e}")
            shown = rule if smooth is LINEAR else axes.get_lines()[:-1]
            place = "center right" if smooth is LINEAR else "upper right"
            axes.legend(handles=shown, fontsize=7, ncols=2, loc=place)
        drawn.axes[0].set_ylabel("largest error over the horizon [-]")
    return drawn


if __name__ == "__main__":
    main()
