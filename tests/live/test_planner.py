"""Claim: a mission stays solved while it changes, by numbers alone, and says when it cannot."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import skyknot as sk
from skyknot import missions
from skyknot.kernel import rows
from skyknot.live import Planner, adjustable
from skyknot.live.quick_check import QUICK
from skyknot.missions.formulation import problem_of
from skyknot.problem.problem import Parameters


def restated(mission, move, shifts, limits):
    """Return the problem of the mission file with ends, obstacles and limits written anew."""
    file = mission.file
    goal = file.goal.model_copy(
        update={"position": list(np.add(file.goal.ned, move)), "altitude": None}
    )
    obstacles = [
        each.model_copy(
            update={"center": list(np.add(each.center, shifts[each.name][: len(each.center)]))}
        )
        if each.name in shifts
        else each
        for each in file.airspace.obstacles
    ]
    airspace = file.airspace.model_copy(update={"obstacles": obstacles})
    changed = file.limits.model_copy(update=limits)
    start = file.start.model_copy(
        update={"position": list(np.subtract(file.start.ned, move)), "altitude": None}
    )
    update = {"start": start, "goal": goal, "airspace": airspace, "limits": changed}
    return problem_of(mission.name, file.model_copy(update=update), mission.vehicle)


def values_at(problem, x, u):
    """Return running cost, terminal cost, and room to the bounds of every path constraint."""
    p = Parameters(problem.parameter_values())
    path = np.array(ca.evalf(ca.SX(problem.constraints_of(ca.SX(x), ca.SX(u), p, 0.0)))).ravel()
    lower = [-np.inf if g.lower is None else g.lower for g in problem.constraints]
    upper = [np.inf if g.upper is None else g.upper for g in problem.constraints]
    costs = [
        float(ca.evalf(ca.SX(problem.running_cost_of(ca.SX(x), ca.SX(u), p, 0.0)))),
        float(ca.evalf(ca.SX(problem.terminal_cost_of(ca.SX(x), p, 7.0)))),
    ]
    return np.concatenate([costs, path - lower, upper - path])


@pytest.mark.parametrize("name", missions.names())
def test_the_numbers_say_what_the_mission_file_would(name):
    mission = missions.load(name)
    live = adjustable(mission)
    move = (1.5, -2.0, -0.5)
    shifts = {
        each.name: (0.5 * i, 1.0 - i, 0.0)
        for i, each in enumerate(mission.file.airspace.obstacles)
        if each.name in live.wish.obstacles
    }
    limits = {
        limit.name: 0.9 * limit.value
        for limit in live.limits
        if limit.name in ("speed", "climb", "descent")
    }
    stated = {name: value for name, value in limits.items() if getattr(mission.file.limits, name)}
    wish = live.changed(
        live.wish,
        start=np.subtract(live.wish.start, move),
        goal=np.add(live.wish.goal, move),
        obstacles=shifts,
        limits=stated,
    )
    moved, wanted = live.at(wish), restated(mission, move, shifts, stated)
    generator = np.random.default_rng(5)
    for _ in range(3):
        x = generator.uniform(-1, 1, wanted.nx) + np.r_[30, 20, -5, np.zeros(wanted.nx - 3)]
        u = generator.uniform(0.1, 1, wanted.nu)
        np.testing.assert_allclose(
            values_at(moved, x, u),
            values_at(wanted, x, u),
            rtol=1e-5,  # the speed is rounded off by a thousandth of the mission's own limit
            atol=1e-4,
        )
    for field in ("state", "control", "initial", "final"):
        for side in ("lower", "upper"):
            here, there = (getattr(each, f"{field}_{side}") for each in (moved, wanted))
            np.testing.assert_allclose(here, there, atol=1e-12, err_msg=f"{field} {side}")


@pytest.fixture(scope="module")
def planner():
    """Return a planner of the city mission, settled."""
    return Planner(missions.load("city_hop"))


@pytest.fixture(autouse=True)
def at_home(request):
    """Take the shared planner back to the mission's own numbers after a test."""
    yield
    if "planner" in request.fixturenames:
        own = request.getfixturevalue("planner")
        home = own.adjustable.wish
        own.replan(home.start, home.goal, home.obstacles, home.limits)


def test_it_begins_with_a_certified_plan(planner):
    assert planner.certified.certified
    assert planner.certified.wish == planner.adjustable.wish
    assert planner.certified.sentence.startswith("Certified: all")


def test_a_replan_is_the_optimum_that_a_fresh_solve_finds(planner):
    goal = np.add(planner.adjustable.wish.goal, (-1.0, 0.8, -0.6))
    start = np.subtract(planner.adjustable.wish.start, (-1.0, 0.8, -0.6))
    plan = planner.replan(start, goal, {"market hall": (0.5, 0.2, 0.0)})
    mission = planner.adjustable.mission
    problem = restated(mission, (-1.0, 0.8, -0.6), {"market hall": (0.5, 0.2, 0.0)}, {})
    times = plan.trajectory.times
    fresh = sk.solve(problem, sk.HermiteSimpson(mesh=times / times[-1]), guess=plan.trajectory)
    assert fresh.success
    assert plan.objective == pytest.approx(fresh.objective, rel=1e-6)
    np.testing.assert_allclose(plan.trajectory.states[-1, :3], goal, atol=1e-9)


def test_replans_write_no_tapes_and_take_few_iterations(planner):
    written = rows._tapes.cache_info().misses
    goal, iterations = np.array(planner.adjustable.wish.goal), []
    for k in range(1, 9):
        plan = planner.replan(goal=np.add(goal, (-0.1 * k, 0.15 * k, 0.0)))
        assert plan.solved, plan.sentence
        iterations.append(plan.iterations)
    assert rows._tapes.cache_info().misses == written
    cold = planner.certified.solution.rounds[0].iterations
    assert np.median(iterations) <= cold / 3


def test_the_quick_check_is_part_of_the_full_certificate(planner):
    plan = planner.certified
    quick = planner._check(plan.problem, plan.trajectory, planner._limits)
    assert len(quick.checks) >= len(QUICK) - 1  # the mission has no waypoints
    for name, check in quick.checks.items():
        full = plan.certificate.checks[name]
        assert check.value == pytest.approx(full.value, rel=1e-6, abs=1e-9), name
        assert check.limit == full.limit


def test_moving_an_obstacle_into_the_path_bends_it(planner):
    before = planner.replan()
    after = planner.replan(obstacles={"market hall": (0.0, 0.0, -3.0)})  # down is negative: higher
    assert after.solved, after.sentence
    assert after.objective > before.objective + 1e-3


@pytest.mark.parametrize("name", ["speed", "climb", "tilt", "thrust"])
def test_a_tighter_limit_is_kept(planner, name):
    own = next(limit for limit in planner.adjustable.limits if limit.name == name)
    share = 0.55 if name == "thrust" else 0.9
    plan = planner.replan(limits={name: share * own.value})
    assert plan.solved, plan.sentence
    reached = {
        "speed": np.max(np.linalg.norm(plan.trajectory.states[:, 3:6], axis=1)),
        "climb": np.max(-plan.trajectory.states[:, 5]),
        "tilt": np.degrees(
            np.max(np.arccos(np.prod(np.cos(plan.trajectory.states[:, 6:8]), axis=1)))
        ),
        "thrust": np.max(plan.trajectory.controls[:, 0]),
    }[name]
    assert reached <= share * own.value * (1 + 1e-6)


def test_a_goal_that_jumps_takes_the_way_along(planner):
    goal = np.add(planner.adjustable.wish.goal, (-4.0, 3.0, -1.0))
    plan = planner.replan(goal=goal)
    assert plan.solved, plan.sentence
    assert plan.iterations < planner.certified.solution.rounds[0].iterations


def test_a_goal_inside_a_building_is_refused_in_words(planner):
    kept = planner.certified
    plan = planner.replan(goal=(93.0, 77.0, -4.0))
    assert not plan.solved
    assert plan.sentence.startswith("No plan: the goal lies inside 'twin tower',")
    assert "on the wrong side" in plan.sentence
    assert planner.certified is kept


def test_a_failing_solve_says_why_and_the_next_one_works(planner):
    kept = planner.certified
    plan = planner.replan(goal=(1160.0, 61.5, -4.0))  # a kilometre in a minute, at 8 m/s
    assert not plan.solved
    assert plan.status is not None
    assert not plan.status.success
    assert plan.sentence.startswith("No plan: ")
    assert "The largest violation is" in plan.sentence
    assert planner.certified is kept
    again = planner.replan(goal=planner.adjustable.wish.goal)
    assert again.solved, again.sentence


def test_a_thorough_plan_of_an_old_wish_does_not_replace_the_new_one(planner):
    old = planner.certified
    plan = planner.replan(goal=np.add(planner.adjustable.wish.goal, (-0.5, 0.0, 0.0)))
    planner.adopt(old)
    assert planner.latest is plan
    assert planner.certified is old


def test_settling_certifies_what_is_wanted_now(planner):
    goal = np.add(planner.adjustable.wish.goal, (-0.6, 0.4, 0.0))
    planner.replan(goal=goal)
    plan = planner.settle()
    assert plan.certified, plan.sentence
    assert planner.certified is plan
    np.testing.assert_allclose(plan.trajectory.states[-1, :3], goal, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"goal": (1.0, 2.0)}, "'goal' is not a place."),
        ({"start": (1.0, np.nan, 0.0)}, "'start' is not a place."),
        ({"obstacles": {"castle": (0, 0, 0)}}, "There is no obstacle of this name to move."),
        ({"limits": {"jerk": 1.0}}, "There is no limit of this name to move."),
        ({"limits": {"speed": 0.1}}, "The limit 'speed' leaves its range."),
    ],
)
def test_a_wish_that_makes_no_sense_is_told(planner, change, words):
    with pytest.raises(sk.UserError, match=words) as caught:
        planner.replan(**change)
    assert all(caught.value.parts().values())
