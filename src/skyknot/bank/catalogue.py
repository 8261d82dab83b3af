"""All reference problems by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import partial

import numpy as np

from skyknot.bank import (
    attitudes,
    fleets,
    integrators,
    rockets_and_gliders,
    rotorcraft,
    shortest_times,
    singular_arcs,
    smooth_optima,
    state_limits,
)
from skyknot.bank.base import Reference

CATALOGUE: dict[str, Callable[[], Reference]] = {
    # least time, energy and fuel of integrators
    "minimum-time": integrators.minimum_time,
    "minimum-time-even": partial(integrators.minimum_time, 1.0, 1.0, 1.0),
    "to-the-origin": integrators.to_the_origin,
    "speed-limited": integrators.speed_limited,
    "triple-integrator": integrators.chain_minimum_time,
    "quadruple-integrator": partial(integrators.chain_minimum_time, 4),
    "minimum-energy": integrators.minimum_energy,
    "least-jerk": integrators.least_derivative,
    "least-snap": partial(integrators.least_derivative, 4),
    "minimum-fuel": integrators.minimum_fuel,
    "soft-landing": integrators.soft_landing,
    "quadratic-drag": integrators.quadratic_drag,
    "linear-drag": integrators.linear_drag,
    "fuller": integrators.fuller,
    # smooth
    "hager": smooth_optima.hager,
    "garg": smooth_optima.garg,
    "scalar-regulator": smooth_optima.scalar_regulator,
    "scalar-regulator-long": partial(smooth_optima.scalar_regulator, 5.0),
    "coupled-regulator": smooth_optima.coupled_regulator,
    "double-regulator": smooth_optima.double_regulator,
    "double-regulator-long": partial(smooth_optima.double_regulator, 5.0),
    "stationary-regulator": partial(smooth_optima.double_regulator, 2.0, stationary=True),
    "oscillator": smooth_optima.oscillator,
    "cart": smooth_optima.cart,
    "hypersensitive": smooth_optima.hypersensitive,
    "hypersensitive-reversed": partial(smooth_optima.hypersensitive, 1.0, 1.5),
    "linear-hypersensitive": smooth_optima.linear_hypersensitive,
    "linear-hypersensitive-long": partial(smooth_optima.linear_hypersensitive, 50.0),
    "hanging-chain": smooth_optima.hanging_chain,
    # limits on states
    "bryson-denham": state_limits.bryson_denham,
    "breakwell": partial(state_limits.bryson_denham, 0.1),
    "bryson-denham-low": partial(state_limits.bryson_denham, 0.05),
    "bryson-denham-touching": partial(state_limits.bryson_denham, 0.2),
    "bryson-denham-free": partial(state_limits.bryson_denham, 0.3),
    "van-der-pol": state_limits.van_der_pol,
    "van-der-pol-control": partial(state_limits.van_der_pol, None, 1.0),
    "van-der-pol-limited": partial(state_limits.van_der_pol, -0.25, 1.0),
    "round-the-circle": state_limits.round_the_circle,
    # steering in least time
    "brachistochrone": shortest_times.brachistochrone,
    "brachistochrone-psopt": partial(shortest_times.brachistochrone, 2.0, 2.0, 9.8),
    "brachistochrone-unit": partial(shortest_times.brachistochrone, 1.0, 1.0, 9.81),
    "brachistochrone-half-turn": partial(shortest_times.brachistochrone, np.pi, 2.0, 1.0),
    "zermelo": shortest_times.zermelo,
    "steering": shortest_times.steering,
    "point-mass": shortest_times.point_mass,
    "point-mass-racing": partial(shortest_times.point_mass, 3.3 * 9.81, 10.0),
    # singular arcs
    "neuenhofen-kerrigan": singular_arcs.neuenhofen_kerrigan,
    "aly-chan": singular_arcs.aly_chan,
    "goddard": singular_arcs.goddard,
    # mechanics
    "cart-pole": rockets_and_gliders.cart_pole,
    "hang-glider": rockets_and_gliders.hang_glider,
    "orbit-raising": rockets_and_gliders.orbit_raising,
    "reorientation": attitudes.reorientation,
    "racing-quadrotor": attitudes.racing_quadrotor,
    "racing-quadrotor-short": partial(attitudes.racing_quadrotor, 5.0),
    # quadrotors
    "quadrotor-transfer": rotorcraft.quadrotor_transfer,
    "quadrotor-transfer-in-drag": rotorcraft.quadrotor_transfer_in_drag,
    "quadrotor-step": rotorcraft.quadrotor_step,
    "quadrotor-step-small": partial(rotorcraft.quadrotor_step, 0.1),
    "quadrotor-step-tiny": partial(rotorcraft.quadrotor_step, 0.01),
    "quadrotor-climb": rotorcraft.quadrotor_climb,
    "quadrotor-yaw": rotorcraft.quadrotor_yaw,
    "upright-climb": rotorcraft.upright_climb,
    "upright-climb-racing": partial(rotorcraft.upright_climb, 10.0, 3.3 * 9.81),
    "upright-climb-racing-short": partial(rotorcraft.upright_climb, 2.0, 3.3 * 9.81),
    "upright-yaw": rotorcraft.upright_yaw,
    "planar-quadrotor": rotorcraft.planar_quadrotor,
    "lateral-minimum-time": rotorcraft.lateral_minimum_time,
    # several at once
    "fleet": fleets.fleet,
}
"""Name in the command line and the documents → what makes the reference."""


def about(name: str) -> str:
    """Return what a problem asks, in one line."""
    made = CATALOGUE[name]
    factory = made.func if isinstance(made, partial) else made
    return (inspect.getdoc(factory) or "").splitlines()[0]
