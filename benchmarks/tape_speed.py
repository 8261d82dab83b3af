"""Time of the tape against CasADi's own machine: 208 points of the 12-state quadrotor.

Value, Jacobian and lower triangle of the Hessian of νᵀf at every point, best of many repetitions,
one thread. Blocks: inputs and outputs stand lane by lane, as the solver keeps them; points: one
point after the other, as NumPy does.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import casadi as ca
import numpy as np

from skyknot.kernel import isa
from skyknot.kernel.tape import Tape
from skyknot.missions import vehicles

POINTS = 208


def derivatives() -> ca.Function:
    """Return (x, u, ν) → f, ∂f, lower triangle of the Hessian of νᵀf."""
    x, u, nu = ca.SX.sym("x", 12), ca.SX.sym("u", 4), ca.SX.sym("ν", 12)
    f = ca.vertcat(*vehicles.load("hummingbird").dynamics(ca.vertsplit(x), ca.vertsplit(u)))
    y = ca.vertcat(x, u)
    hessian, _ = ca.hessian(ca.dot(nu, f), y)
    return ca.Function("model", [x, u, nu], ca.cse([f, ca.jacobian(f, y), ca.tril(hessian)]))


def best(action: Callable[[], object], repetitions: int = 2000) -> float:
    """Return the shortest time of one action, µs."""
    shortest = np.inf
    for _ in range(repetitions):
        start = time.perf_counter()
        action()
        shortest = min(shortest, time.perf_counter() - start)
    return 1e6 * shortest


def casadi_map(function: ca.Function, inputs: list[np.ndarray]) -> Callable[[], None]:
    """Return an evaluation of all points by CasADi's mapped function, without copies."""
    mapped = function.map(POINTS)
    buffer, trigger = mapped.buffer()
    results = [np.empty((POINTS, function.nnz_out(k))) for k in range(function.n_out())]
    for k, array in enumerate(inputs):
        buffer.set_arg(k, memoryview(array))
    for k, result in enumerate(results):
        buffer.set_res(k, memoryview(result))

    def run() -> None:
        trigger()

    run.buffers = (buffer, inputs, results)  # type: ignore[attr-defined]  # keeps them alive
    return run


def main() -> None:
    """Print one line for every build of the kernel and one for CasADi."""
    function = derivatives()
    random = np.random.default_rng(0)
    inputs = [random.normal(size=(POINTS, size)) for size in (12, 4, 12)]
    packed = np.hstack(inputs)
    reference = best(casadi_map(function, inputs), 300)
    start = time.perf_counter()
    compiled = Tape(function).native
    construction = time.perf_counter() - start
    print(
        f"{function.n_instructions()} CasADi instructions, {len(compiled.instruction_names())} on "
        f"the tape in {compiled.runs} runs, {compiled.slots} slots, "
        f"built in {1e3 * construction:.1f} ms"
    )
    print(f"{'casadi map':>20} {reference:8.1f} us")
    for level in isa.supported():
        compiled = Tape(function, isa.load(level)).native
        outputs = np.empty((POINTS, compiled.outputs))
        times = {"points": best(lambda c=compiled, o=outputs: c.evaluate_points(packed, o))}
        for lanes in (8, 16):
            blocks = packed.reshape(-1, lanes, compiled.inputs).transpose(0, 2, 1).copy()
            results = np.empty((len(blocks), compiled.outputs, lanes))
            times[f"{lanes} lanes"] = best(
                lambda c=compiled, b=blocks, r=results: c.evaluate_blocks(b, r)
            )
        for name, shortest in times.items():
            print(f"{level + ', ' + name:>20} {shortest:8.1f} us {reference / shortest:6.1f} times")


if __name__ == "__main__":
    main()
