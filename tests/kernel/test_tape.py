"""Claim: a tape computes what CasADi computes, whatever the lane and the instruction set."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import erfinv
from tape_operations import BINARY, EDGES, OWN, UNARY, all_pairs, by_casadi, function_of

from skyknot.errors import UserError
from skyknot.kernel import isa, tape
from skyknot.kernel.tape import Tape
from skyknot.models import Allocation, Vehicle

LEVELS = isa.supported()
PAIRS = all_pairs(EDGES)


def evaluate(function, columns, level=None):
    module = isa.load(level or LEVELS[-1])
    return Tape(function, module).evaluate(columns)


def quadrotor_derivatives():
    """Return (x, u, ν) → f, ∂f, lower triangle of the Hessian of νᵀf of the 12-state model."""
    vehicle = Vehicle(
        name="sample",
        title="Craft of the tests",
        kind="small",
        mass=1.3,
        inertia=(0.011, 0.014, 0.021),
        gravity=9.81,
        allocation=Allocation.x_levers(0.12, 0.17, 0.02),
        thrust_min=0.1,
        thrust_max=8.0,
    )
    x, u, nu = ca.SX.sym("x", 12), ca.SX.sym("u", 4), ca.SX.sym("ν", 12)
    f = ca.vertcat(*vehicle.dynamics(ca.vertsplit(x), ca.vertsplit(u)))
    y = ca.vertcat(x, u)
    hessian, _ = ca.hessian(ca.dot(nu, f), y)
    return ca.Function("model", [x, u, nu], ca.cse([f, ca.jacobian(f, y), ca.tril(hessian)]))


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("name", UNARY)
def test_unary_operations_agree_to_the_bit(name, level):
    function, codes = function_of(UNARY[name], 1)
    assert getattr(ca, name) in codes
    columns = [np.concatenate([EDGES, np.linspace(-3, 3, 61)])[:, None]]
    np.testing.assert_array_equal(evaluate(function, columns, level), by_casadi(function, columns))


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("name", BINARY)
def test_binary_operations_agree_to_the_bit(name, level):
    function, codes = function_of(BINARY[name], 2)
    assert getattr(ca, name) in codes
    np.testing.assert_array_equal(evaluate(function, PAIRS, level), by_casadi(function, PAIRS))


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("name", OWN)
def test_own_functions_stay_within_their_ulp(name, level):
    reference, allowed = OWN[name]
    function, _ = function_of(getattr(ca, name.removeprefix("OP_").lower()), 1)
    random = np.random.default_rng(3)
    multiples = (random.integers(1, 600_000, 4000) * (np.pi / 2)).astype(float)
    values = np.concatenate(
        [
            *(random.uniform(-r, r, 4000) for r in (1, 10, 745, 1e6, 1e9)),
            10.0 ** random.uniform(-300, 300, 4000),
            1 + 10.0 ** random.uniform(-16, 0, 4000),
            *(np.nextafter(multiples, side) for side in (-np.inf, np.inf)),
            EDGES,
        ]
    )
    with np.errstate(all="ignore"):
        exact = reference(values.astype(np.longdouble))
        rounded = exact.astype(float)
        (found,) = evaluate(function, [values[:, None]], level)
        error = np.abs(found[:, 0] - exact) / np.spacing(np.abs(rounded))
    ordinary = np.isfinite(rounded)
    np.testing.assert_array_equal(found[~ordinary, 0], rounded[~ordinary])
    assert np.max(error[ordinary]) <= allowed


def test_inverse_error_function_agrees_with_scipy():
    function, codes = function_of(ca.erfinv, 1)
    assert ca.OP_ERFINV in codes
    values = np.concatenate([np.linspace(-1, 1, 401), 1 - 10.0 ** -np.arange(1, 17), EDGES])
    with np.errstate(invalid="ignore"):
        expected = erfinv(values)
    (found,) = evaluate(function, [values[:, None]])
    np.testing.assert_allclose(found[:, 0], expected, rtol=1e-14, atol=0)


def test_the_sign_of_zero_survives():
    x = ca.SX.sym("x")
    function = ca.Function("zeros", [x], [1 / ca.sin(x), 1 / ca.tan(x), 1 / ca.tanh(x), 0 * x])
    results = evaluate(function, [np.array([[-0.0]])])
    assert [float(value[0, 0]) for value in results[:3]] == [-np.inf] * 3


def test_hints_and_prints_pass_their_value_on():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    function = ca.Function("printed", [x, y], [2 * x.printme(y)])
    (found,) = evaluate(function, [np.array([[3.0]]), np.array([[1.0]])])
    assert found == [[6.0]]


def test_every_operation_of_the_tape_is_tried_here():
    tried = {getattr(ca, name) for name in (*UNARY, *BINARY, *OWN)}
    tried |= {ca.OP_ERFINV, ca.OP_PRINTME, ca.OP_LIFT, ca.OP_ASSIGN, ca.OP_INPUT, ca.OP_OUTPUT}
    assert set(tape.OPERATIONS) == tried


EXACT_UNARY = [UNARY[f"OP_{n}"] for n in ("NEG", "SQ", "TWICE", "FABS", "FLOOR", "SIGN", "ATAN")]
EXACT_BINARY = [BINARY[f"OP_{n}"] for n in ("ADD", "SUB", "MUL", "DIV", "FMAX", "LT", "ATAN2")]


@given(
    steps=st.lists(
        st.tuples(st.integers(0, 13), st.integers(0, 10**6), st.integers(0, 10**6)), min_size=1
    ),
    values=st.lists(st.floats(width=64), min_size=3, max_size=3),
)
def test_random_graphs_agree_to_the_bit(steps, values):
    """Sines and cosines enter at the leaves, as the tape itself gives them."""
    symbols = [ca.SX.sym(name) for name in "xyz"]
    trigonometric = [g(s) for s in symbols for g in (ca.sin, ca.cos)]
    stand_ins = ca.SX.sym("t", 6)

    def build(leaves):
        nodes = list(leaves)
        for operation, i, j in steps:
            a, b = nodes[i % len(nodes)], nodes[j % len(nodes)]
            binary = operation >= len(EXACT_UNARY)
            nodes.append(
                EXACT_BINARY[operation - len(EXACT_UNARY)](a, b)
                if binary
                else EXACT_UNARY[operation](a)
            )
        return ca.vertcat(*nodes[-4:])

    whole = ca.Function("whole", symbols, [build([*symbols, *trigonometric])])
    split = ca.Function("split", [*symbols, stand_ins], [build([*symbols, *stand_ins.nz])])
    leaves = ca.Function("leaves", symbols, [ca.vertcat(*trigonometric)])
    columns = [np.array([[value]]) for value in values]
    expected = by_casadi(split, [*columns, *evaluate(leaves, columns)])
    np.testing.assert_array_equal(evaluate(whole, columns), expected)


@pytest.mark.parametrize("level", LEVELS)
def test_quadrotor_derivatives_agree_at_208_points(level):
    function = quadrotor_derivatives()
    random = np.random.default_rng(5)
    columns = [random.normal(size=(208, size)) for size in (12, 4, 12)]
    found = evaluate(function, columns, level)
    for ours, theirs in zip(found, by_casadi(function, columns), strict=True):
        # Differences cancel, so an entry is measured against the largest of its kind.
        scale = np.max(np.abs(theirs), axis=0)
        assert np.max(np.abs(ours - theirs) / scale) < 1e-13


def test_instruction_sets_agree():
    function = quadrotor_derivatives()
    random = np.random.default_rng(6)
    columns = [random.normal(size=(40, size)) for size in (12, 4, 12)]
    first, *others = [np.hstack(evaluate(function, columns, level)) for level in LEVELS]
    scale = np.max(np.abs(first), axis=0)
    for other in others:
        assert np.max(np.abs(other - first) / scale) < 1e-14


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("lanes", [8, 16])
def test_a_point_has_one_result_in_every_lane_and_company(level, lanes):
    """Huge angles beside ordinary ones send only their own lanes to the C library."""
    function = quadrotor_derivatives()
    compiled = Tape(function, isa.load(level)).native
    random = np.random.default_rng(7)
    points = random.normal(size=(lanes, compiled.inputs))
    points[1, 6], points[2, 7], points[3, 8] = 1e9, np.inf, np.nan
    blocks = np.stack([np.roll(points, shift, axis=0).T for shift in range(lanes)])
    results = np.empty((lanes, compiled.outputs, lanes))
    compiled.evaluate_blocks(np.ascontiguousarray(blocks), results)
    for shift in range(lanes):
        np.testing.assert_array_equal(np.roll(results[shift], -shift, axis=1), results[0])


def test_a_short_block_is_evaluated_like_a_full_one():
    function = quadrotor_derivatives()
    random = np.random.default_rng(8)
    columns = [random.normal(size=(19, size)) for size in (12, 4, 12)]
    together = np.hstack(evaluate(function, columns))
    for p in range(19):
        alone = np.hstack(evaluate(function, [column[p : p + 1] for column in columns]))
        np.testing.assert_array_equal(alone[0], together[p])


def test_no_points_give_no_results():
    function = quadrotor_derivatives()
    results = evaluate(function, [np.empty((0, size)) for size in (12, 4, 12)])
    assert [result.shape for result in results] == [(0, function.nnz_out(k)) for k in range(3)]


def test_outputs_may_be_inputs_constants_and_repeated():
    x = ca.SX.sym("x", 2)
    function = ca.Function("plain", [x], [ca.vertcat(x[1], x[1], 4.5, x[0], ca.sin(x[0]))])
    (found,) = evaluate(function, [np.array([[0.0, 7.0]])])
    np.testing.assert_array_equal(found, [[7.0, 7.0, 4.5, 0.0, 0.0]])


def test_only_nonzeros_are_read_and_written():
    x = ca.SX.sym("x", ca.Sparsity.diag(3))
    function = ca.Function("sparse", [x], [2 * x])
    (found,) = evaluate(function, [np.array([[1.0, 2.0, 3.0]])])
    np.testing.assert_array_equal(found, [[2.0, 4.0, 6.0]])


def test_products_join_sums_and_sines_join_cosines():
    x = ca.SX.sym("x", 3)
    function = ca.Function(
        "joined", [x], [x[0] * x[1] + x[2], x[0] - x[1] * x[2], ca.cos(x[0]) / ca.sin(x[0])]
    )
    names = Tape(function).native.instruction_names()
    assert sorted(names) == ["div", "mul_add", "sin_cos", "sub_mul"]


def test_instructions_stand_in_runs_of_one_operation():
    """An interpreter pays at every jump, so there must be few."""
    compiled = Tape(quadrotor_derivatives()).native
    assert compiled.runs < len(compiled.instruction_names()) / 5


def test_a_joined_product_is_rounded_before_the_sum():
    x = ca.SX.sym("x", 2)
    function = ca.Function("cancel", [x], [x[0] * x[0] - x[1]])
    value = 1 + 2.0**-30
    for level in LEVELS:
        assert evaluate(function, [np.array([[value, value * value]])], level)[0] == [[0.0]]


def test_an_operation_missing_from_the_table_is_refused_by_name(monkeypatch):
    monkeypatch.delitem(tape.OPERATIONS, ca.OP_SIN)
    function, _ = function_of(ca.sin, 1)
    with pytest.raises(UserError, match="cannot do one of the function's operations") as caught:
        Tape(function)
    assert caught.value.found == "OP_SIN"
    assert caught.value.where == "function sample"


def test_a_call_that_was_not_inlined_is_refused_by_name():
    x = ca.SX.sym("x")
    inner = ca.Function("inner", [x], [x + 1], {"never_inline": True})
    with pytest.raises(UserError, match="cannot do one of the function's operations") as caught:
        Tape(ca.Function("outer", [x], [inner(2 * x)]))
    assert caught.value.found == "OP_CALL"


def test_a_function_of_matrix_expressions_is_refused():
    x = ca.MX.sym("x")
    with pytest.raises(UserError, match="functions of SX expressions only") as caught:
        Tape(ca.Function("matrix", [x], [x + 1]))
    assert caught.value.found == "MXFunction"


def test_inputs_of_the_wrong_shape_are_refused():
    with pytest.raises(ValueError, match=r"inputs of shapes \(P, \[12, 4, 12\]\) expected"):
        Tape(quadrotor_derivatives()).evaluate([np.zeros((5, 12)), np.zeros((5, 3))])
