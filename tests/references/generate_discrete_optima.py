"""Generate ``discrete_optima.json``: discrete optima by a transcription written by hand.

Nothing of the package's transcription, kernel or solvers is used: every interval is written out
with CasADi's Opti stack and the equations of the scheme, and Ipopt solves it to 1e-12. Run it to
refresh the table:

    python tests/references/generate_discrete_optima.py

State bounds are imposed at the nodes only, control bounds at every control value.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import casadi as ca
import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))

from skyknot import bank as problems
from skyknot.bank import Reference

TABLE = Path(__file__).with_name("discrete_optima.json")
SEGMENTS = (10, 20, 40, 80)
SCHEMES = ("trapezoid", "hermite-simpson", "hermite-simpson averaged")
CASES = {
    "hager": problems.hager,
    "minimum energy": problems.minimum_energy,
    "bryson-denham": problems.bryson_denham,
    "brachistochrone": problems.brachistochrone,
    "steering": problems.steering,
    "cart-pole": problems.cart_pole,
    "van der pol": problems.van_der_pol,
    "quadrotor transfer": problems.quadrotor_transfer,
    "minimum time": problems.minimum_time,
}
# Ten trapezoids are too few for the swing-up: which local optimum is found depends on the start.
LEFT_OUT = {("cart-pole", "trapezoid", 10)}


def discrete_optimum(reference: Reference, scheme: str, N: int) -> float:
    """Return the optimum of the scheme on N equal intervals."""
    problem, opti = reference.problem, ca.Opti()
    free = problem.free_horizon
    T = opti.variable() if free else problem.duration_guess
    X = [opti.variable(problem.nx) for _ in range(N + 1)]
    U = [opti.variable(problem.nu) for _ in range(N + 1)]
    middles = [opti.variable(problem.nu) for _ in range(N)] if scheme == "hermite-simpson" else None
    h = T / N
    f = point(problem, lambda x, u: ca.vertcat(*as_list(problem.dynamics(x, u))))
    cost = point(problem, lambda x, u: ca.SX(running(problem, x, u)))
    total = end_cost(problem, X[-1], T)
    for k in range(N):
        x, y, u, w = X[k], X[k + 1], U[k], U[k + 1]
        if scheme == "trapezoid":
            opti.subject_to(y == x + h / 2 * (f(x, u) + f(y, w)))
            total += h / 2 * (cost(x, u) + cost(y, w))
            continue
        c = middles[k] if middles else (u + w) / 2
        m = (x + y) / 2 + h / 8 * (f(x, u) - f(y, w))
        opti.subject_to(y == x + h / 6 * (f(x, u) + 4 * f(m, c) + f(y, w)))
        total += h / 6 * (cost(x, u) + 4 * cost(m, c) + cost(y, w))
    opti.minimize(total)
    for x in X:
        bound(opti, x, problem.state_lower, problem.state_upper)
    for u in U + (middles or []):
        bound(opti, u, problem.control_lower, problem.control_upper)
    bound(opti, X[0], problem.initial_lower, problem.initial_upper)
    bound(opti, X[-1], problem.final_lower, problem.final_upper)
    if free:
        opti.subject_to(opti.bounded(problem.horizon.lower, T, problem.horizon.upper))
        opti.set_initial(T, problem.duration_guess)
    start(opti, reference, X, U, middles)
    options = {"print_level": 0, "tol": 1e-12, "bound_relax_factor": 0.0, "sb": "yes"}
    opti.solver("ipopt", {"print_time": False}, options)
    return float(opti.solve().value(total))


def point(problem, expression):
    """Return a CasADi function of one state and one control."""
    x, u = ca.SX.sym("x", problem.nx), ca.SX.sym("u", problem.nu)
    return ca.Function("point", [x, u], [expression(x, u)])


def as_list(rates):
    """Return the entries of a list or of a CasADi column."""
    return rates if isinstance(rates, list) else ca.vertsplit(rates)


def running(problem, x, u):
    """Return the running cost, or zero."""
    return 0 if problem.running_cost is None else problem.running_cost(x, u)


def end_cost(problem, x, T):
    """Return the terminal cost, or zero."""
    return 0 if problem.terminal_cost is None else problem.terminal_cost(x, T)


def bound(opti, values, lower, upper):
    """Impose the finite bounds, equalities as such."""
    for i, (low, high) in enumerate(zip(lower, upper, strict=True)):
        if low == high:
            opti.subject_to(values[i] == low)
        elif np.isfinite(low) or np.isfinite(high):
            opti.subject_to(opti.bounded(low, values[i], high))


def start(opti, reference, X, U, middles):
    """Start where the reference says, else straight between the fixed ends with zero control."""
    N = len(X) - 1
    guess = reference.guess
    if guess is None:
        first, last = reference.problem.initial_lower, reference.problem.final_lower
        last = np.where(np.isfinite(last), last, first)
        zero = np.zeros(reference.problem.nu)
        guess = problems.line(1.0, first, last, zero, zero)
    for k in range(N + 1):
        opti.set_initial(X[k], guess.state(guess.times[-1] * k / N))
        opti.set_initial(U[k], guess.control(guess.times[-1] * k / N))
    for k, c in enumerate(middles or []):
        opti.set_initial(c, guess.control(guess.times[-1] * (k + 0.5) / N))


def main() -> None:
    """Write the table."""
    table = {
        name: {
            scheme: {
                str(N): float(f"{discrete_optimum(case(), scheme, N):.12g}")
                for N in SEGMENTS
                if (name, scheme, N) not in LEFT_OUT
            }
            for scheme in SCHEMES
        }
        for name, case in CASES.items()
    }
    TABLE.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
