"""Claim: certified answers, spoilt in one place by more than a limit, are caught by name.

Three certified answers, with everything that a certificate looks at between them, and some fifty
ways to spoil them: states, controls, multipliers, mesh, constraints, dynamics and costs. Places and
signs are drawn with a seed.
"""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from drone_on_rail import bumped, problem, with_segments

import skyknot as sk
from skyknot.problem.airspace import cylinder
from skyknot.problem.constraints import PathConstraint, PointConstraint

SEEDS = (1, 2)
INFORMATION = {"saturation"}


def beam(upper=1.06):
    return PathConstraint("beam", lambda x, u: x[0] + 0.4 * x[1], upper=upper, unit="m")


def gate(at=0.5, lower=0.548):
    return PointConstraint("gate", lambda x, u: x[0], at=at, lower=lower, unit="m")


def rail(**changes):
    """Return a problem whose speed limit, beam and gate all bind and whose last speed is free."""
    choices = {
        "rates": None,
        "final": [1, None],
        "terminal_cost": lambda x, tf: 2 * (x[1] - 0.1) ** 2,
        "state_bounds": ([-1, None], [2, 0.62]),
        "path": [beam()],
        "points": [gate()],
    }
    return problem(**(choices | changes))


def rated(**changes):
    """Return a problem in a hurry, whose control may not change as fast as it would."""
    choices = {
        "rates": [3.0],
        "points": [],
        "running_cost": lambda x, u: u[0] ** 2 + 50 * (1 - x[0]) ** 2,
    }
    return problem(**(choices | changes))


def pendulum(**changes):
    """Return a pendulum to be swung up with two torques, one of them dear, in free time."""
    choices = {
        "name": "pendulum",
        "states": ["angle", "spin"],
        "controls": ["torque", "brake"],
        "dynamics": lambda x, u: [x[1], -ca.sin(x[0]) + u[0] - 0.3 * u[1]],
        "horizon": sk.Free(0.5, 6.0, 2.0),
        "initial": [0, 0],
        "final": [1.5, 0],
        "running_cost": lambda x, u: 0.3 + u[0] ** 2 + 2 * u[1] ** 2,
        "control_bounds": (-1.2, 1.2),
    }
    return sk.Problem(**(choices | changes))


BASES = {"rail": rail, "rated": rated, "pendulum": pendulum}


@pytest.fixture(scope="module")
def certified():
    """Return the three answers, each with a certificate that passes."""
    answers = {name: sk.solve(make(), sk.HermiteSimpson(40)) for name, make in BASES.items()}
    for name, answer in answers.items():
        certificate = answer.verify()
        assert certificate.passed, f"{name}\n{certificate.table()}"
    return answers


def state(by, column=1):
    def spoil(answer, place, sign):
        states = bumped(answer.states, (place, column), sign * by)
        return replace(answer, trajectory=replace(answer.trajectory, states=states))

    return spoil


def segment(field, by, column=0):
    def spoil(answer, place, sign):
        values = getattr(answer.trajectory.segments, field)
        middle = values.shape[1] // 2
        changed = bumped(values, (place, middle, column), sign * by)
        return replace(answer, trajectory=with_segments(answer.trajectory, **{field: changed}))

    return spoil


def node_control(answer, place, sign):
    controls = bumped(answer.controls, (place, 0), sign * 0.01)
    return replace(answer, trajectory=replace(answer.trajectory, controls=controls))


def times(change):
    def spoil(answer, place, sign):
        moved = change(answer.times.copy(), place, sign)
        return replace(answer, trajectory=replace(answer.trajectory, times=moved))

    return spoil


def one_node(t, place, sign):
    t[place] += sign * 0.2 * (t[place] - t[place - 1])
    return t


def multiplier(field, change):
    """Change a multiplier array at the entry that pulls hardest, or where ``change`` says."""

    def spoil(answer, place, sign):
        values = getattr(answer.witness, field).copy()
        change(values, place, sign)
        return replace(answer, witness=replace(answer.witness, **{field: values}))

    return spoil


def hardest(values):
    return np.unravel_index(np.argmax(np.abs(values)), values.shape)


def flipped(values, _place, _sign):
    values[hardest(values)] *= -1


def dropped(values, _place, _sign):
    values[hardest(values)] = 0


def scaled(values, _place, sign):
    values *= 1 + sign * 0.01


def added(values, place, sign):
    values[(place, *[0] * (values.ndim - 1))] += sign * 0.01


def claimed(field, change):
    def spoil(answer, place, sign):
        values = getattr(answer, field).copy()
        change(values, place, sign)
        return replace(answer, **{field: values})

    return spoil


def last_costate(values, _place, sign):
    values[-1] += sign * 0.1


def all_costates(values, _place, sign):
    values *= 1 + sign * 0.8


def asked(make, **changes):
    def spoil(answer, _place, _sign):
        return replace(answer, problem=make(**changes))

    return spoil


def whirl(x, u, p, t):
    """A gust that vanishes at all points of the scheme: at every 1/80 of the horizon."""
    return [x[1], u[0] - p.drag * x[1] + 0.4 * ca.sin(np.pi * t / 0.025)]


def gust(x, u, p, t):
    """Turbulence of zero mean over each segment, but not at its points."""
    return [x[1], u[0] - p.drag * x[1] + 0.01 * ca.cos(2 * np.pi * t / 0.05)]


def answer_of(make, segments, **changes):
    """Put the honest answer of another problem in place of the answer."""

    def spoil(answer, _place, _sign):
        other = sk.solve(make(**changes), sk.HermiteSimpson(segments))
        return replace(other, problem=answer.problem)

    return spoil


def coarse(make, scheme):
    def spoil(_answer, _place, _sign):
        return sk.solve(make(), scheme)

    return spoil


def reversed_gains(values, _place, _sign):
    values *= -1


def wild_gains(values, _place, _sign):
    values *= -300


MUTATIONS = {
    # states
    "a node's speed": ("rail", state(1e-4), "defects"),
    "a node's place": ("rail", state(1e-4, 0), "defects"),
    "an angle": ("pendulum", state(1e-4, 0), "defects"),
    "a speed beyond its bound": ("rail", lambda a, p, _: state(0.7)(a, p, 1), "state bounds"),
    "an interior state": ("rail", segment("interior_states", 1e-4, 1), "defects"),
    "the first state": ("rail", lambda a, _, s: state(1e-3)(a, 0, s), "ends"),
    "the last state": ("rail", lambda a, _, s: state(1e-3, 0)(a, 40, s), "ends"),
    # controls
    "a control value": ("rail", segment("control_values", 1e-2), "defects"),
    "a torque": ("pendulum", segment("control_values", 1e-2, 1), "defects"),
    "a control far beyond": ("rail", segment("control_values", 7.0), "control bounds"),
    "a control at a node only": ("rail", node_control, "interpolant"),
    "a stored rate": ("rail", segment("rates", 1e-2), "interpolant"),
    "a control that spikes": ("rated", segment("control_values", 0.3), "rates"),
    "controls of other weights": (
        "rail",
        answer_of(rail, 40, running_cost=lambda x, u: u[0] ** 2 + 3 * x[1] ** 2),
        "stationarity",
    ),
    # mesh
    "a node's time": ("rail", times(one_node), "defects"),
    "a node of the pendulum": ("pendulum", times(one_node), "defects"),
    "all times": ("rail", times(lambda t, _, s: t * (1 + s * 1e-3)), "horizon"),
    "all free times": ("pendulum", times(lambda t, _, s: t * (1 + s * 1e-3)), "defects"),
    "a coarse mesh": ("rail", coarse(rail, sk.Euler(12)), "arrival"),
    "a coarse mesh flown": ("pendulum", coarse(pendulum, sk.Euler(8)), "open-loop flight"),
    "a mesh too coarse for costates": (
        "pendulum",
        coarse(lambda: pendulum(final=[3.0, 0]), sk.Euler(3)),
        "costate equation",
    ),
    # multipliers
    "a defect's multiplier": ("rail", multiplier("defects", added), "stationarity"),
    "all multipliers of defects": ("pendulum", multiplier("defects", scaled), "stationarity"),
    "no multiplier of the speed": ("rail", multiplier("state_bounds", dropped), "stationarity"),
    "a multiplier of the beam, turned": ("rail", multiplier("path", flipped), "multiplier signs"),
    "a multiplier where the beam is far": ("rail", multiplier("path", added), "complementarity"),
    "a bound's multiplier, turned": (
        "rail",
        multiplier("state_bounds", lambda v, p, s: v.__setitem__((p, 1, 1), -0.01)),
        "multiplier signs",
    ),
    "a control's multiplier": ("pendulum", multiplier("control_bounds", added), "complementarity"),
    "a rate's multiplier": ("rated", multiplier("rates", scaled), "stationarity"),
    "the duration's multiplier": (
        "pendulum",
        multiplier("global_bounds", lambda v, p, s: v.__iadd__(0.01 * s)),
        "complementarity",
    ),
    "a costate": ("rail", claimed("costates", added), "costates"),
    "the last costate": ("rail", claimed("costates", last_costate), "transversality"),
    "all costates": ("rail", claimed("costates", all_costates), "costates"),
    "costates of another size": (
        "pendulum",
        claimed("costates", all_costates),
        "minimum principle",
    ),
    "a costate and its equation": (
        "rail",
        claimed("costates", lambda v, p, s: v.__setitem__(p, 3 * v[p])),
        "costate equation",
    ),
    "gains of the wrong sign": (
        "rail",
        claimed("gains", reversed_gains),
        "closed-loop, perturbed",
    ),
    "gains that run wild": ("pendulum", claimed("gains", wild_gains), "closed-loop flight"),
    # constraints
    "a lower speed limit": ("rail", asked(rail, state_bounds=(None, [None, 0.5])), "state bounds"),
    "a weaker motor": ("rail", asked(rail, control_bounds=(-1, 1)), "control bounds"),
    "a slower motor": ("rated", asked(rated, rates=[1.0]), "rates"),
    "a lower beam": ("rail", asked(rail, path=[beam(1.0)]), "path"),
    "a farther gate": ("rail", asked(rail, points=[gate(lower=0.62)]), "points"),
    "an earlier gate": ("rail", asked(rail, points=[gate(at=0.4)]), "points"),
    "another goal": ("rail", asked(rail, final=[1.01, None]), "ends"),
    "a gate of no effect": ("rail", asked(rail, points=[gate(lower=0.4)]), "complementarity"),
    "no speed limit": ("rail", asked(rail, state_bounds=None), "multiplier signs"),
    "a horizon that may be longer": (
        "rail",
        asked(rail, horizon=2.01),
        "horizon",
    ),
    # dynamics and costs
    "another drag": ("rail", asked(rail, parameters={"drag": 0.21}), "defects"),
    "a heavier bob": (
        "pendulum",
        asked(pendulum, dynamics=lambda x, u: [x[1], -1.001 * ca.sin(x[0]) + u[0] - 0.3 * u[1]]),
        "defects",
    ),
    "a gust between the points": ("rail", asked(rail, dynamics=whirl), "dynamics between nodes"),
    "turbulence": ("rail", asked(rail, dynamics=gust), "defects"),
    "another running cost": (
        "rail",
        asked(rail, running_cost=lambda x, u: 1.01 * u[0] ** 2),
        "stationarity",
    ),
    "another end cost": (
        "rail",
        asked(rail, terminal_cost=lambda x, tf: 2 * (x[1] - 0.11) ** 2),
        "transversality",
    ),
    "time at another price": (
        "pendulum",
        asked(pendulum, running_cost=lambda x, u: 0.5 + u[0] ** 2 + 2 * u[1] ** 2),
        "Hamiltonian",
    ),
    "a reward for braking": (
        "pendulum",
        asked(pendulum, running_cost=lambda x, u: 0.3 + u[0] ** 2 - 2 * u[1] ** 2),
        "second order",
    ),
}


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", MUTATIONS)
def test_a_mutation_is_caught_by_the_check_it_is_for(certified, name, seed):
    base, spoil, expected = MUTATIONS[name]
    random = np.random.default_rng([seed, *name.encode()])
    place, sign = int(random.integers(3, 37)), float(random.choice([-1, 1]))
    certificate = spoil(certified[base], place, sign).verify()
    assert expected in {check.name for check in certificate.failures}, certificate.table()


def test_every_check_that_can_fail_has_a_mutation(certified):
    """Checks between the nodes have theirs in test_mutations_are_caught and test_guarantee."""
    between = {
        *("state bounds between nodes", "control bounds between nodes", "path between nodes"),
        "path guaranteed",
    }
    known = {name for answer in certified.values() for name in answer.verify().checks}
    assert known - between - INFORMATION == {expected for _, _, expected in MUTATIONS.values()}


def test_a_thin_pole_across_the_way_is_caught_by_the_proof(certified):
    """A pole of 12 mm, in a part of the way where samples lie more than twice that apart."""
    answer = certified["rail"]
    fast = replace(
        answer,
        trajectory=replace(
            answer.trajectory,
            states=60 * answer.states,
            segments=replace(
                answer.trajectory.segments,
                rates=60 * answer.trajectory.segments.rates,
                interior_states=60 * answer.trajectory.segments.interior_states,
            ),
        ),
    )
    places = fast.state((np.arange(12) + 0.5) / 12 * 0.05 + 1.0)[:, 0]
    pole = cylinder("pole", (float(places[4] + places[5]) / 2, 0.0), 0.012)
    flat = PathConstraint("pole", lambda x, u: pole.function([x[0], 0.0], u), lower=0.0, unit="m")
    checks = replace(fast, problem=rail(path=[flat])).verify().checks
    assert checks["path between nodes"].passed
    assert not checks["path guaranteed"].passed


def test_there_are_enough_of_them():
    assert len(MUTATIONS) * len(SEEDS) >= 30
