"""Claim: a NetCDF archive holds any solution, to the last bit, with units others understand."""

from __future__ import annotations

from dataclasses import replace

import netCDF4
import numpy as np
import pytest

from export.flights import CERTIFIED, flown
from report.gallery import flight, rail
from skyknot.export import write_export
from skyknot.export.netcdf import udunits


def archived(folder, solution, **options):
    path = folder / "f.nc"
    write_export(solution, path, certificate=CERTIFIED, **options)
    data = netCDF4.Dataset(path)
    data.set_auto_mask(False)
    return data


@pytest.mark.parametrize("solution", [rail, flight], ids=["rail", "flight"])
def test_nodes_come_back_to_the_last_bit(solution, tmp_path):
    with archived(tmp_path, solution()) as data:
        trajectory = solution().trajectory
        np.testing.assert_array_equal(data["time"][:], trajectory.times)
        for i, name in enumerate(trajectory.state_names):
            found = trajectory.state(trajectory.times)[:, i]
            np.testing.assert_array_equal(data[name][:], found)
            np.testing.assert_array_equal(data[f"costate_{name}"][:], solution().costates[:, i])
        for i, name in enumerate(trajectory.control_names):
            found = trajectory.control(trajectory.times)[:, i]
            np.testing.assert_array_equal(data[name][:], found)


def test_what_is_no_flight_has_no_attitude_but_its_own_units(tmp_path):
    with archived(tmp_path, rail(), rate=10) as data:
        assert {name: data[name].units for name in data.variables} == {
            "time": "s",
            "x": "m",
            "v": "m s-1",
            "a": "m s-2",
        }
        assert data.dimensions["time"].size == 21


def test_the_archive_says_where_it_comes_from(tmp_path):
    with archived(tmp_path, flight()) as data:
        assert data.Conventions == "CF-1.8"
        assert data.title == "wrench transfer"
        assert data.certificate == "certified"
        assert data.status == flight().status.value
        assert float(data.objective) == flight().objective
        assert data.inputs_hash == flight().record.inputs_hash
        assert data.solver.startswith(flight().record.solver)


def test_every_variable_is_named_for_people_and_has_a_unit_or_is_a_costate(tmp_path):
    with archived(tmp_path, flight()) as data:
        for name, variable in data.variables.items():
            assert len(variable.long_name) > 5
            assert hasattr(variable, "units") != name.startswith("costate_")


def test_names_that_netcdf_cannot_hold_are_changed_and_told(tmp_path):
    solution = rail()
    named = replace(solution.trajectory, state_names=("turn ψ", "turn φ"))
    with archived(tmp_path, replace(solution, trajectory=named)) as data:
        assert data["turn__"].long_name == "state turn ψ"
        assert data["turn___"].long_name == "state turn φ"
        np.testing.assert_array_equal(data["turn___"][:], named.state(named.times)[:, 1])


def test_a_rate_leaves_costates_out(tmp_path):
    with archived(tmp_path, flown("pure yaw"), rate=7) as data:
        assert not [name for name in data.variables if name.startswith("costate")]


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        ("", "1"),
        ("m", "m"),
        ("m/s", "m s-1"),
        ("m/s^2", "m s-2"),
        ("m/s²", "m s-2"),
        ("N m", "N m"),
        ("rad/s", "rad s-1"),
        ("kg·m²/s³", "kg m2 s-3"),
        ("J/kg/K", "J kg-1 K-1"),
        ("1/s", "s-1"),
    ],
)
def test_units_are_written_as_udunits_reads_them(ours, theirs):
    assert udunits(ours) == theirs
