"""Claim: the decision vector is node-major in the published order, and nothing is lost in it."""

from __future__ import annotations

import numpy as np
import pytest

import skyknot as sk
from skyknot.kernel.layout import node_major
from skyknot.problem.guess import straight_line

NX, NU, N = 2, 1, 3
PUBLISHED = {
    # scheme: what one segment holds, then what the last node holds
    "euler": (sk.Euler(N), ["x", "u"], ["x"]),
    "trapezoid": (sk.Trapezoid(N), ["x", "u"], ["x", "u"]),
    "trapezoid, hold": (sk.Trapezoid(N, controls="hold"), ["x", "u"], ["x"]),
    "hermite-simpson": (sk.HermiteSimpson(N), ["x", "u", "xc", "uc"], ["x", "u"]),
    "linear": (sk.HermiteSimpson(N, controls="linear"), ["x", "u", "xc"], ["x", "u"]),
    "hold": (sk.HermiteSimpson(N, controls="hold"), ["x", "u", "xc"], ["x"]),
    "lobatto": (sk.Lobatto(N, 4), ["x", "u", "xc", "uc", "xc", "uc"], ["x", "u"]),
    "lobatto, own": (
        sk.Lobatto(N, 3, controls="discontinuous"),
        ["x", "u", "uc", "uc", "xc"],
        ["x"],
    ),
    "radau": (sk.Radau(N, 2), ["x", "u", "uc", "xc"], ["x"]),
    "radau, linear": (sk.Radau(N, 2, controls="linear"), ["x", "u", "xc"], ["x", "u"]),
}


def problem(**extras):
    asked = {
        "name": "double",
        "states": ["x", "v"],
        "controls": ["a"],
        "dynamics": lambda x, u: [x[1], u[0]],
        "horizon": 2.0,
        "initial": [0.0, 0.0],
        "final": [1.0, None],
        "running_cost": lambda x, u: u[0] ** 2,
    }
    return sk.Problem(**(asked | extras))


def program_of(scheme, **extras):
    asked = problem(**extras)
    return scheme.program(asked, straight_line(asked))


@pytest.mark.parametrize("scheme", PUBLISHED)
def test_the_order_of_the_unknowns_is_the_published_one(scheme):
    transcription, segment, last = PUBLISHED[scheme]
    layout = program_of(transcription).layout
    position, order = 0, segment * N + last
    found: dict[str, list[int]] = {name: [] for name in ("x", "u", "xc", "uc")}
    for name in order:
        found[name].append(position)
        position += NX if name.startswith("x") else NU
    assert layout.size == layout.globals == position
    nodes = [*layout.state[:, 0], layout.state[-1, -1]]
    assert nodes == found["x"]
    assert list(layout.control[:, 0]) == found["u"][:N]
    assert list(layout.state[:, 1:-1].ravel()) == found["xc"]
    own = layout.control[:, 1:-1] if last == ["x", "u"] else layout.control[:, 1:]
    assert list(own.ravel()) == found["uc"]
    if last == ["x", "u"]:
        assert list(layout.control[:, -1]) == found["u"][1:]


@pytest.mark.parametrize("scheme", PUBLISHED)
def test_every_position_belongs_to_exactly_one_quantity(scheme):
    layout = program_of(PUBLISHED[scheme][0], horizon=sk.Free(1.0, 3.0)).layout
    owned = np.concatenate(
        [
            np.unique(layout.states_at(layout.state)),
            np.unique(layout.controls_at(layout.control)),
            layout.global_positions,
        ]
    )
    np.testing.assert_array_equal(np.sort(owned), np.arange(layout.size))


def test_globals_come_last_duration_first():
    program = program_of(
        sk.Trapezoid(N),
        horizon=sk.Free(1.0, 3.0, 2.0),
        parameters={"mass": sk.Free(0.5, 2.0, 1.5), "drag": 0.3},
        dynamics=lambda x, u, p: [x[1], u[0] / p["mass"] - p["drag"] * x[1]],
    )
    assert program.global_names == ("horizon", "mass")
    np.testing.assert_array_equal(program.start[-2:], [2.0, 1.5])
    np.testing.assert_array_equal(program.lower[-2:], [1.0, 0.5])
    np.testing.assert_array_equal(program.upper[-2:], [3.0, 2.0])


@pytest.mark.parametrize(
    ("s", "m", "shared"), [(4, 4, True), (5, 5, True), (4, 2, True), (3, 1, False)]
)
def test_longer_segments_alternate_states_and_controls_without_gaps(s, m, shared):
    layout = node_major(N, s, m, shared, NX, NU, 0)
    owned = np.concatenate(
        [
            np.unique(layout.states_at(layout.state)),
            np.unique(layout.controls_at(layout.control)),
        ]
    )
    np.testing.assert_array_equal(np.sort(owned), np.arange(layout.size))
    np.testing.assert_array_equal(layout.state[1:, 0], layout.state[:-1, -1])


@pytest.mark.parametrize("scheme", PUBLISHED)
def test_unknowns_are_named_in_the_users_words(scheme):
    program = program_of(PUBLISHED[scheme][0], horizon=sk.Free(1.0, 3.0))
    layout = program.layout
    assert program.variable_name(int(layout.state[1, 0]) + 1).startswith("v")
    assert program.variable_name(int(layout.control[1, 0])).startswith("a")
    assert program.variable_name(layout.globals) == "horizon"


def test_the_start_reads_the_guess_at_every_point():
    asked = problem()
    t = np.linspace(0, 2, 5)
    guess = sk.Trajectory(t, np.stack([t / 2, t], axis=1), np.cos(t)[:, None])
    program = sk.HermiteSimpson(2).program(asked, guess)
    layout = program.layout
    states = program.start[layout.states_at(layout.state)]
    inner = 2 * np.array([[0, 0.25, 0.5], [0.5, 0.75, 1.0]])
    np.testing.assert_allclose(states[..., 0], inner / 2)
    controls = program.start[layout.controls_at(layout.control)][..., 0]
    np.testing.assert_allclose(controls, np.cos(inner))


def test_the_start_lies_within_the_bounds():
    program = program_of(
        sk.HermiteSimpson(4),
        state_bounds=([0.3, 0.1], [0.7, 0.5]),
        initial=[0.3, 0.2],
        final=[0.7, None],
    )
    assert np.all(program.start >= program.lower)
    assert np.all(program.start <= program.upper)


def test_a_guess_over_another_duration_is_stretched():
    asked = problem()
    guess = sk.Trajectory([5.0, 9.0], [[0.0, 0.0], [1.0, 4.0]], [[0.0], [1.0]])
    program = sk.Trapezoid(4).program(asked, guess)
    states = program.start[program.layout.states_at(program.layout.state[:, 0])]
    np.testing.assert_allclose(states[:, 1], [0, 1, 2, 3])
