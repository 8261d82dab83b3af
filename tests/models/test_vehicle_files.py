"""Claim: the vehicles of the package are what their sources say, and load as written."""

from __future__ import annotations

import casadi
import numpy as np
import pytest
from craft import sample_vehicle

from skyknot.missions import vehicles
from skyknot.missions.vehicle_form import QUANTITIES
from skyknot.missions.vehicle_text import vehicle_text
from skyknot.models import HoverPower, Limits, WrenchLimits

PROMISED = {"crazyflie", "f450", "hummingbird", "nasa_six_passenger", "report", "rpg_racing"}
AIR = 1.225  # kg/m^3, ISA sea level
KNOT = 1852.0 / 3600.0  # m/s, by definition
POUND = 0.45359237  # kg, by definition


@pytest.fixture(params=vehicles.names(), name="vehicle")
def each_vehicle(request):
    return vehicles.load(request.param)


def test_the_promised_vehicles_are_there():
    assert set(vehicles.names()) >= PROMISED


def test_name_matches_file_and_every_number_has_a_source(vehicle):
    assert vehicle.name in vehicles.names()
    required = {key for key, quantity in QUANTITIES.items() if quantity.required}
    assert required <= set(vehicle.sources)
    assert all(source.strip() for source in vehicle.sources.values())
    assert vehicle.notes


def test_hover_holds_still_and_each_rotor_carries_its_quarter(vehicle):
    rates = np.array(vehicle.dynamics(np.zeros(12), vehicle.hover), dtype=float)
    np.testing.assert_allclose(rates, 0.0, atol=1e-12)
    quarter = vehicle.mass * vehicle.gravity / 4
    np.testing.assert_allclose(vehicle.rotor_thrusts(vehicle.hover), quarter, rtol=1e-12)


def test_rotors_can_lift_more_than_the_weight_and_positions_are_planar(vehicle):
    assert vehicle.thrust_to_weight > 1.2
    assert vehicle.rotor_positions.shape == (4, 3)
    np.testing.assert_array_equal(vehicle.rotor_positions[:, 2], 0.0)
    np.testing.assert_allclose(vehicle.rotor_positions.mean(axis=0), 0.0, atol=1e-12)


def test_every_corner_of_a_derived_wrench_box_is_flyable(vehicle):
    if vehicle.wrench_limits is None:
        lower, upper = vehicle.control_bounds
        picks = np.array(np.meshgrid(*[[0, 1]] * 4)).reshape(4, -1).T
        thrusts = vehicle.rotor_thrusts(np.where(picks == 1, upper, lower))
        assert thrusts.min() >= vehicle.thrust_min * (1 - 1e-9) - 1e-12
        assert thrusts.max() <= vehicle.thrust_max * (1 + 1e-9)
    else:
        assert vehicle.name == "report"


def test_a_vehicle_written_out_reads_back_equal(vehicle):
    again = vehicles.parse(vehicle_text(vehicle))
    assert again == vehicle
    assert again.sources.keys() >= {"body.mass", "rotors.positions"}


def test_a_vehicle_made_in_python_writes_out_and_reads_back_equal():
    vehicle = sample_vehicle(
        title='quotes " and \\ and é',
        drag=(0.1, 0.2, 0.3),
        limits=Limits(speed=5.0, climb=2.0, descent=1.0, tilt=0.4, body_rates=(1.0, 2.0, 3.0)),
        wrench_limits=WrenchLimits((1.0, 25.0), (0.1, 0.2, 0.3)),
        power=HoverPower(hover=100.0, rated=180.0, figure_of_merit=0.6),
        rotor_radius=0.1,
        notes=("one", "two"),
    )
    assert vehicles.parse(vehicle_text(vehicle)) == vehicle


def test_a_path_loads_like_a_name(tmp_path):
    text = (vehicles.FOLDER / "f450.toml").read_text(encoding="utf-8")
    own = tmp_path / "own.toml"
    own.write_text(text, encoding="utf-8")
    assert vehicles.load(own) == vehicles.load(str(own)) == vehicles.load("f450")


def test_vehicle_dynamics_take_casadi_symbols(vehicle):
    x, u = casadi.SX.sym("x", 12), casadi.SX.sym("u", 4)
    f = casadi.Function("f", [x, u], [casadi.vertcat(*vehicle.dynamics(x, u))])
    np.testing.assert_allclose(f(np.zeros(12), vehicle.hover).full(), 0.0, atol=1e-12)


def test_report_vehicle_has_the_reference_problems_numbers():
    report = vehicles.load("report")
    assert report.mass == 1.2
    assert report.inertia == (0.012, 0.012, 0.022)
    np.testing.assert_array_equal(report.control_bounds[0], [0.0, -0.5, -0.5, -0.2])
    np.testing.assert_array_equal(report.control_bounds[1], [24.0, 0.5, 0.5, 0.2])
    assert not any(report.drag)
    assert any("not publish" in note for note in report.notes)


def test_report_torques_are_all_flyable_at_hover():
    report = vehicles.load("report")
    picks = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    torques = picks * report.control_bounds[1][1:]
    wrenches = np.column_stack([np.full(8, report.weight), torques])
    thrusts = report.rotor_thrusts(wrenches)
    assert thrusts.min() >= report.thrust_min
    assert thrusts.max() <= report.thrust_max


def test_hummingbird_is_capped_and_says_so():
    craft = vehicles.load("hummingbird")
    thrust_coefficient, torque_coefficient = 5.57e-6, 1.36e-7  # RotorPy 3.0.0, N s^2 and N m s^2
    assert craft.thrust_max == pytest.approx(thrust_coefficient * 838.0**2, rel=1e-4)
    assert craft.allocation.kappa == pytest.approx(
        torque_coefficient / thrust_coefficient, rel=1e-4
    )
    speed = np.sqrt(craft.weight / 4 / thrust_coefficient)
    expected = 4 * speed * np.array([1.19e-4, 1.19e-4, 2.32e-4])  # RotorPy k_d, k_d, k_z
    np.testing.assert_allclose(craft.drag, expected, rtol=1e-3)
    assert any("838" in note for note in craft.notes)


def test_racing_quad_warns_of_euler_angles():
    craft = vehicles.load("rpg_racing")
    assert craft.thrust_to_weight == pytest.approx(3.3, abs=0.1)
    assert any("Euler" in note for note in craft.notes)
    np.testing.assert_allclose(craft.state_bounds[1][9:], [15.0, 15.0, 0.3])


def test_passenger_craft_follows_from_its_published_figures():
    craft = vehicles.load("nasa_six_passenger")
    assert craft.kind == "passenger"
    assert craft.mass == pytest.approx(6480 * POUND, rel=1e-3)
    area = 4 * np.pi * craft.rotor_radius**2
    ideal = craft.weight * np.sqrt(craft.weight / (2 * AIR * area))
    assert craft.power.hover == pytest.approx(ideal / craft.power.figure_of_merit, rel=5e-3)
    margin = (craft.power.rated / craft.power.hover) ** (2 / 3)  # P ~ T^1.5 at constant merit
    assert margin == pytest.approx(1.36, abs=0.005)
    assert craft.thrust_to_weight == pytest.approx(margin, rel=5e-3)
    induced = np.sqrt(craft.weight / (2 * AIR * area))
    assert craft.limits.descent == pytest.approx(induced / 2, rel=0.02)
    assert craft.limits.speed == pytest.approx(98 * KNOT, rel=1e-3)
    assert np.tan(craft.limits.tilt) == pytest.approx(0.5, rel=1e-3)
    parasite = 0.5 * AIR * 1.20 * craft.limits.speed**2
    assert craft.drag[0] * craft.limits.speed == pytest.approx(parasite, rel=5e-3)


def test_passenger_craft_calls_its_inertia_an_estimate():
    craft = vehicles.load("nasa_six_passenger")
    assert "ESTIMATE" in craft.sources["body.inertia"]
    assert any("Inertia is not published" in note for note in craft.notes)
    height = 2.0
    Ixx, Iyy, Izz = craft.inertia
    assert pytest.approx(craft.mass * height**2 / 12, rel=0.03) == (Ixx + Iyy - Izz) / 2


def test_f450_follows_from_its_coefficients():
    craft = vehicles.load("f450")
    assert craft.allocation.kappa == pytest.approx(2.55e-7 / 1.30e-5, rel=5e-3)
    assert craft.rotor_radius == pytest.approx(0.5 * 9.4 * 0.0254, rel=1e-3)
    assert np.hypot(*craft.rotor_positions[0, :2]) == pytest.approx(0.2335, rel=1e-3)
