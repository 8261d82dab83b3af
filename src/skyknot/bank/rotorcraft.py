"""Quadrotors: the 12-state craft "q", its kin kept upright, and the planar one.

Legend: m mass, g gravity, J inertia, κ torque per thrust of a rotor, l lever, d distance, ψ yaw,
T horizon, f thrust of a rotor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from skyknot.bank.base import COMPUTED, Recipe, Reference, line
from skyknot.bank.integrators import minimum_time
from skyknot.models.allocation import Allocation
from skyknot.models.vehicle import Vehicle
from skyknot.problem.horizon import Free
from skyknot.problem.problem import Problem
from skyknot.trajectory import Trajectory
from skyknot.transcription import Lobatto, Radau

G, LEVER, KAPPA, INERTIA = 9.81, 0.17, 0.016, (0.01, 0.011, 0.02)
HOVER = G / 4


def craft(drag: float = 0.0) -> Vehicle:
    """Return the craft "q": 1 kg, an X of four rotors, drag in N s/m along each axis."""
    hubs = ((LEVER, -LEVER), (LEVER, LEVER), (-LEVER, LEVER), (-LEVER, -LEVER))
    return Vehicle(
        name="q",
        title="12-state craft of the reference problems",
        kind="small",
        mass=1.0,
        inertia=INERTIA,
        gravity=G,
        allocation=Allocation(hubs, (1, -1, 1, -1), KAPPA),
        thrust_min=0.0,
        thrust_max=10.0,
        drag=(drag, drag, drag),
    )


def transfer(
    name: str,
    move: Sequence[float],
    yaw: float,
    optimum: float,
    source: str,
    drag: float = 0.0,
    level: bool = False,
) -> Reference:
    """Return hover to hover in 2 s with least ∫Σ(f_i − mg/4)².

    Parameters
    ----------
    name : of the problem
    move : m north, east, down
    yaw : rad, to the right
    optimum, source : as in Reference
    drag : N s/m
    level : whether roll and pitch are kept at zero
    """
    model = craft(drag).rotor_model()
    first = np.zeros(12)
    last = np.array([*move, 0, 0, 0, 0, 0, yaw, 0, 0, 0], dtype=float)
    problem = Problem(
        name,
        list(model.state_names),
        list(model.control_names),
        model.dynamics,
        horizon=2.0,
        initial=list(first),
        final=list(last),
        running_cost=lambda x, u: sum((u[i] - HOVER) ** 2 for i in range(4)),
        state_bounds=(_tilt(0.0), _tilt(0.0)) if level else None,
    )
    start = line(2.0, first, last, [HOVER] * 4, [HOVER] * 4)
    return Reference(problem, optimum, source, start, recipe=Recipe(Lobatto(10, 9)))


def _tilt(most: float) -> list[float | None]:
    """Return bounds on the states that bound roll and pitch alone."""
    return [*[None] * 6, most, most, *[None] * 4]


def _computed(reference: Reference, digits: int) -> Reference:
    return replace(reference, kind=COMPUTED, digits=digits)


def quadrotor_transfer() -> Reference:
    """3 m ahead, 2 m left, 1 m up, 45° of yaw left in 2 s, rest to rest, least ∫Σ(f_i − mg/4)²."""
    move, source = (3.0, -2.0, -1.0), "computed; no bound is active"
    found = transfer("quadrotor transfer", move, -np.pi / 4, 0.9649868217, source)
    return _computed(found, 10)


def quadrotor_transfer_in_drag() -> Reference:
    """3 m ahead, 2 m left, 1 m up, 45° of yaw in 2 s, with a drag of 0.1 N s/m times velocity."""
    move, source = (3.0, -2.0, -1.0), "computed; no bound is active"
    found = transfer("quadrotor transfer in drag", move, -np.pi / 4, 1.0339833564, source, 0.1)
    return _computed(found, 11)


def quadrotor_step(d: float = 1.0) -> Reference:
    """Go d north: for small d the closed form of four integrators, 100800 (J_y/2lg)² d²/T⁷."""
    known = {1.0: (0.0116005545697, 12), 0.1: (0.00859735e-2, 6), 0.01: (0.00856557e-4, 6)}
    optimum, digits = known[d]
    linear = (INERTIA[1] / (2 * LEVER * G)) ** 2 * 100800 / 2.0**7
    source = f"computed; closed form of the linear craft {linear * d**2:.7g}"
    return _computed(transfer(f"quadrotor step {d:g} m", (d, 0, 0), 0.0, optimum, source), digits)


def quadrotor_climb(d: float = 1.0) -> Reference:
    """Climb d in 2 s kept level: 12 d²/4T³ m² as every rotor carries a quarter."""
    source = "closed form: least energy of a double integrator; kept level by bounds"
    cost = 12 * d**2 / (4 * 2.0**3)
    return transfer("quadrotor climb", (0, 0, -d), 0.0, cost, source, level=True)


def quadrotor_yaw(psi: float = 1.0) -> Reference:
    """Turn by ψ in 2 s kept level: (J_z/2κ)² 12 ψ²/T³; a craft that may tilt does with less."""
    source = "closed form: least energy of a double integrator; kept level by bounds"
    cost = (INERTIA[2] / (2 * KAPPA)) ** 2 * 12 * psi**2 / 2.0**3
    return transfer("quadrotor yaw", (0, 0, 0), psi, cost, source, level=True)


def upright_climb(H: float = 5.0, most: float = 20.0, g: float = G) -> Reference:
    """Climb H kept upright with a thrust acceleration of 0 to ``most``: √(2H (1/(most−g) + 1/g)).

    A craft that may turn over, and pull itself down, is faster.
    """
    found = minimum_time(H, most - g, g)
    found.problem.name = f"upright climb {H:g} m"
    source = "closed form: Bryson & Ho, section 3.9; kept upright by construction"
    return replace(found, source=source)


def upright_yaw(psi: float = 0.5 * np.pi) -> Reference:
    """Turn by ψ kept level in least time with rotors from 0 to mg/2: 2√(ψ J_z/(κ m g))."""
    most = KAPPA * G / INERTIA[2]
    found = minimum_time(float(psi), most, most)
    found.problem.name = "upright yaw"
    source = "closed form: Bryson & Ho, section 3.9; kept level by construction"
    return replace(found, source=source)


def planar_quadrotor() -> Reference:
    """Least time over 5 m, rest to rest at equal height: Hehn & D'Andrea's planar craft.

    Thrust acceleration 1 to 20 m/s², pitch rate ±10 rad/s: rate bang, singular, bang, singular,
    bang, with full thrust throughout.
    """
    T, arcs = 1.1318588787, (0.14072831, 0.33334271, 0.18371684, 0.33334271)
    problem = Problem(
        "planar quadrotor",
        ["x", "z", "vx", "vz", "angle"],
        ["thrust", "rate"],
        lambda x, u: [
            x[2],
            x[3],
            u[0] * ca.sin(x[4]),
            u[0] * ca.cos(x[4]) - G,
            u[1],
        ],
        horizon=Free(0.5, 4.0, 1.4),
        initial=[0.0] * 5,
        final=[5.0, 0.0, 0.0, 0.0, 0.0],
        terminal_cost=lambda x, tf: tf,
        control_bounds=([1.0, -10.0], [20.0, 10.0]),
    )
    t = np.linspace(0.0, 1.4, 6)
    angle = np.array([0.0, 1.2, 0.9, -0.9, -1.2, 0.0])
    states = np.zeros((6, 5))
    states[:, 0] = 5 * t / 1.4
    states[:, 4] = angle
    controls = np.stack([np.full(6, 18.0), np.gradient(angle, t)], axis=1)
    source = (
        "computed with the five arcs as phases; model and structure of Hehn & D'Andrea, IFAC World"
        " Congress 2011"
    )
    return Reference(
        problem,
        T,
        source,
        Trajectory(t, states, controls),
        kind=COMPUTED,
        digits=11,
        switches=tuple(float(each) for each in np.cumsum(arcs)),
        recipe=Recipe(
            Radau(100, 2, controls="linear"), accuracy=1e-6, tolerance=1e-9, phases=(10, 5)
        ),
    )


def lateral_minimum_time(d: float = 5.0) -> Reference:
    """Least time over d north with rotors from 0 to 5 N, |roll| and |pitch| ≤ 1.5 rad.

    A local optimum; the point mass gives the lower bound of 1.0451 s.
    """
    model = craft().rotor_model()
    first, last = np.zeros(12), np.array([d, *[0.0] * 11])
    problem = Problem(
        "lateral minimum time",
        list(model.state_names),
        list(model.control_names),
        model.dynamics,
        horizon=Free(0.8, 4.0, 1.6),
        initial=list(first),
        final=list(last),
        terminal_cost=lambda x, tf: tf,
        state_bounds=(_tilt(-1.5), _tilt(1.5)),
        control_bounds=(0.0, 5.0),
    )
    start = line(1.6, first, last, [HOVER] * 4, [HOVER] * 4)
    return Reference(
        problem,
        1.27814,
        "computed; a local optimum, known to one unit of the last digit",
        start,
        kind=COMPUTED,
        digits=6,
        recipe=Recipe(Radau(40, 3), accuracy=1e-4, tolerance=1e-7),
    )
