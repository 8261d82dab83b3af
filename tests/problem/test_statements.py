"""Claim: a mistake in the statement of a problem is told in five parts before any work is done."""

from __future__ import annotations

import math

import numpy as np
import pytest

import skyknot as sk


def stated(**changes):
    asked = {
        "name": "cart",
        "states": [sk.State("x", "m"), sk.State("v", "m/s")],
        "controls": [sk.Control("a", "m/s²")],
        "dynamics": lambda x, u: [x[1], u[0]],
        "horizon": 1.0,
        "initial": [0.0, 0.0],
        "final": [1.0, 0.0],
        "running_cost": lambda x, u: u[0] ** 2,
    }
    return sk.Problem(**(asked | changes))


def refused(where, found, **changes):
    """Check that the statement is refused, with five parts, at the named place."""
    with pytest.raises(sk.UserError, match="where:") as caught:
        stated(**changes)
    error = caught.value
    assert all(error.parts().values()), error.parts()
    assert set(error.parts()) == {"what", "where", "found", "expected", "do"}
    assert where in error.where
    assert found in error.found
    return error


# --- names and sizes ------------------------------------------------------------------------------


def test_repeated_states_are_named():
    refused("states", "x", states=["x", "x"])


def test_a_control_may_not_have_the_name_of_a_state():
    refused("states and controls", "v", controls=["v"], dynamics=lambda x, u: [x[1], u[0]])


def test_repeated_constraints_are_named():
    fence = sk.PathConstraint("fence", lambda x, u: x[0], upper=2.0)
    refused("constraints", "fence", path=[fence, fence])


def test_a_point_constraint_may_not_repeat_a_path_constraints_name():
    path = [sk.PathConstraint("gate", lambda x, u: x[0], upper=2.0)]
    points = [sk.PointConstraint("gate", lambda x, u: x[0], at=0.5, upper=2.0)]
    refused("constraints", "gate", path=path, points=points)


@pytest.mark.parametrize("field", ["states", "controls"])
def test_no_names_at_all_is_refused(field):
    refused(field, "[]", **{field: []})


def test_an_empty_name_is_refused():
    refused("states", "''", states=["", "v"])


@pytest.mark.parametrize("field", ["initial", "final"])
def test_ends_need_one_entry_per_state(field):
    error = refused(field, "3 entries", **{field: [0.0, 0.0, 0.0]})
    assert "x, v" in error.expected


# --- horizon --------------------------------------------------------------------------------------


@pytest.mark.parametrize("horizon", [0.0, -1.0, math.inf, math.nan])
def test_a_horizon_that_is_no_positive_time_is_refused(horizon):
    refused("horizon", f"{horizon:g} s", horizon=horizon)


def test_a_free_horizon_must_start_above_zero():
    refused("horizon", "0 s", horizon=sk.Free(0.0, 2.0))


@pytest.mark.parametrize(
    "free", [(2.0, 1.0), (1.0, 1.0), (1.0, math.inf), (math.nan, 1.0), (1.0, 2.0, 3.0)]
)
def test_a_free_quantity_needs_ordered_finite_bounds(free):
    with pytest.raises(sk.UserError, match="do not enclose its guess"):
        sk.Free(*free)


def test_a_free_quantity_starts_at_its_guess_or_in_the_middle():
    assert sk.Free(1.0, 4.0).start == 2.0
    assert sk.Free(-1.0, 3.0).start == 1.0
    assert sk.Free(1.0, 4.0, 3.0).start == 3.0


# --- bounds ---------------------------------------------------------------------------------------


def test_crossed_bounds_name_the_state_and_its_unit():
    error = refused("x", "lower 2, upper 1 m", state_bounds=([2.0, None], [1.0, None]))
    assert "leave no room" in error.what


def test_crossed_bounds_of_a_control_are_named():
    refused("a", "lower 1, upper -1", control_bounds=(1.0, -1.0))


def test_bounds_carried_by_a_state_are_used_and_replaced_by_explicit_ones():
    states = [sk.State("x", "m", lower=-1.0, upper=3.0), sk.State("v", "m/s")]
    carried = stated(states=states)
    np.testing.assert_array_equal(carried.state_lower, [-1.0, -np.inf])
    np.testing.assert_array_equal(carried.state_upper, [3.0, np.inf])
    replaced = stated(states=states, state_bounds=([-9.0, None], None))
    np.testing.assert_array_equal(replaced.state_lower, [-9.0, -np.inf])
    np.testing.assert_array_equal(replaced.state_upper, [np.inf, np.inf])


def test_bounds_of_the_wrong_size_are_refused():
    refused("state_bounds[0]", "3 entries", state_bounds=([0.0, 0.0, 0.0], None))


def test_bounds_that_are_not_numbers_are_refused():
    refused("control_bounds[1]", "nan", control_bounds=(None, math.nan))


@pytest.mark.parametrize("end", ["initial", "final"])
def test_an_end_outside_the_bounds_names_state_and_unit(end):
    error = refused(f"{end}, x", "5 to 5 m", **{end: [5.0, 0.0]}, state_bounds=(-2.0, 2.0))
    assert "-2 to 2" in error.expected


def test_an_end_given_as_a_crossed_pair_is_refused():
    refused("final, x", "2 to 1", final=[(2.0, 1.0), None])


def test_an_end_given_as_a_pair_is_a_range():
    problem = stated(final=[(0.5, 1.5), (None, 0.0)])
    np.testing.assert_array_equal(problem.final_lower, [0.5, -np.inf])
    np.testing.assert_array_equal(problem.final_upper, [1.5, 0.0])


def test_rates_of_the_wrong_size_are_refused():
    refused("rates", "2 entries", rates=[1.0, 2.0])


def test_one_list_of_rates_is_symmetric_and_a_pair_is_not():
    np.testing.assert_array_equal(stated(rates=[2.0]).rate_lower, [-2.0])
    problem = stated(rates=([-1.0], [3.0]))
    np.testing.assert_array_equal([problem.rate_lower[0], problem.rate_upper[0]], [-1.0, 3.0])
    assert np.isinf(stated().rate_upper[0])


def test_crossed_rates_are_refused():
    refused("rates", "lower 3, upper 1", rates=([3.0], [1.0]))


def test_negative_symmetric_rates_are_refused():
    refused("rates", "-1", rates=[-1.0])


def test_a_target_of_the_wrong_size_is_refused():
    refused("target", "1 entries", target=[1.0])


# --- callables ------------------------------------------------------------------------------------


def test_too_few_rates_are_counted():
    error = refused("dynamics", "1 rates", dynamics=lambda x, u: [x[1]])
    assert "x, v" in error.expected


def test_math_functions_on_symbols_are_explained():
    error = refused("dynamics", "Error", dynamics=lambda x, u: [x[1], math.sin(x[0])])
    assert "casadi.sin" in error.do


def test_an_index_beyond_the_states_is_explained():
    refused("dynamics", "", dynamics=lambda x, u: [x[1], u[7]])


def test_a_cost_of_two_numbers_is_refused():
    refused("running_cost", "one number was expected", running_cost=lambda x, u: [u[0], x[0]])


def test_a_terminal_cost_of_two_numbers_is_refused():
    refused("terminal_cost", "one number was expected", terminal_cost=lambda x, tf: x)


def test_a_constraint_that_fails_is_named_by_its_own_name():
    broken = sk.PathConstraint("tower", lambda x, u: x[0] + u[9], upper=1.0)
    refused("tower", "", path=[broken])


def test_a_parameter_that_does_not_exist_is_named_with_those_that_do():
    refused(
        "dynamics",
        "no parameter 'mass'; there are: drag",
        dynamics=lambda x, u, p: [x[1], u[0] / p.mass],
        parameters={"drag": 1.0},
    )


def test_dynamics_with_too_few_arguments_are_explained():
    refused("dynamics", "TypeError", dynamics=lambda x: [x[1], 0])


@pytest.mark.parametrize(
    "dynamics",
    [
        lambda x, u: [x[1], u[0]],
        lambda x, u: (x[1], u[0]),
        lambda x, u: np.array([x[1], u[0]]),
        lambda x, u, p: [x[1], u[0] * p["gain"]],
        lambda x, u, parameters: [x[1], u[0] * parameters.gain],
        lambda x, u, t: [x[1], u[0] + 0 * t],
        lambda x, u, t, p: [x[1], u[0] * p.gain + 0 * t],
    ],
)
def test_dynamics_may_take_parameters_and_time_by_name(dynamics):
    problem = stated(dynamics=dynamics, parameters={"gain": 1.0})
    solution = sk.solve(problem, sk.HermiteSimpson(4), tolerance=1e-10)
    assert solution.objective == pytest.approx(12.0)


def test_time_is_given_in_seconds():
    """∫t dt over 3 s is 4.5."""
    problem = stated(horizon=3.0, running_cost=lambda x, u, t: t + 0 * u[0])
    assert sk.solve(problem, sk.HermiteSimpson(4)).objective == pytest.approx(4.5)


# --- constraints ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("bounds", "found"),
    [
        ((None, None), "lower None, upper None"),
        ((2.0, 1.0), "lower 2.0, upper 1.0"),
        ((math.nan, 1.0), "lower nan"),
    ],
)
def test_a_constraint_that_bounds_nothing_is_refused(bounds, found):
    with pytest.raises(sk.UserError, match="leave no room or do not bound") as caught:
        sk.PathConstraint("fence", lambda x, u: x[0], *bounds)
    assert found in caught.value.found
    assert "fence" in caught.value.what


def test_a_constraint_without_a_name_is_refused():
    with pytest.raises(sk.UserError, match="has no name"):
        sk.PathConstraint("", lambda x, u: x[0], upper=1.0)


@pytest.mark.parametrize("at", [-0.1, 1.1, math.nan])
def test_a_point_outside_the_horizon_is_refused(at):
    with pytest.raises(sk.UserError, match="outside the horizon") as caught:
        sk.PointConstraint("gate", lambda x, u: x[0], at=at, upper=1.0)
    assert caught.value.where == "gate.at"


# --- solve ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "where", "found"),
    [
        ({"transcription": "runge-kutta"}, "scheme", "'runge-kutta'"),
        ({"transcription": {"scheme": "simpson"}}, "scheme", "'simpson'"),
        ({"transcription": {"scheme": "trapezoid", "segments": 0}}, "segments", "0"),
        ({"transcription": {"scheme": "trapezoid", "pieces": 9}}, "transcription", "pieces"),
        ({"transcription": 7}, "transcription", "int"),
        ({"solver": "snopt"}, "solver", "'snopt'"),
        ({"solver": 3}, "solver", "int"),
        ({"tolerance": 0.0}, "tolerance", "0.0"),
        ({"tolerance": -1e-6}, "tolerance", "-1e-06"),
        ({"tolerance": math.nan}, "tolerance", "nan"),
        ({"tolerance": "small"}, "tolerance", "small"),
        ({"guess": [1, 2, 3]}, "guess", "list"),
        ({"guess": sk.Trajectory([0, 1], [[0.0]] * 2, [[0.0]] * 2)}, "guess", "1 states"),
    ],
)
def test_solve_refuses_a_wrong_argument_by_name(arguments, where, found):
    with pytest.raises(sk.UserError, match="where:") as caught:
        sk.solve(stated(), **arguments)
    assert where in caught.value.where
    assert found in caught.value.found
    assert all(caught.value.parts().values())


def test_solve_refuses_what_is_not_a_problem():
    with pytest.raises(sk.UserError, match="not a Problem") as caught:
        sk.solve({"name": "cart"})
    assert caught.value.found == "dict"


@pytest.mark.parametrize(
    "transcription",
    ["hermite-simpson", {"scheme": "trapezoid", "segments": 20}, {"segments": 20}, sk.Euler(30)],
)
def test_solve_takes_a_name_a_mapping_or_an_object(transcription):
    solution = sk.solve(stated(), transcription)
    assert solution.success
    # ∫u² of the fixed-end double integrator is 12
    assert solution.objective == pytest.approx(12.0, rel=0.01)


def test_the_message_prints_its_five_parts_in_order():
    with pytest.raises(sk.UserError, match="where:") as caught:
        stated(horizon=-1.0)
    lines = str(caught.value).splitlines()
    labels = [line.split(":")[0].strip() for line in lines[1:]]
    assert labels == ["where", "found", "expected", "do"]
