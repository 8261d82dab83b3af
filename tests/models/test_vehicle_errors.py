"""Claim: a broken vehicle file is told in five parts, with the line and the nearest right word."""

from __future__ import annotations

import pytest
from craft import sample_vehicle

from skyknot.errors import UserError
from skyknot.missions import vehicles
from skyknot.models import HoverPower, Limits, WrenchLimits

GOOD = """\
name = "own"
title = "A craft of one's own"
kind = "small"
notes = ["an example"]

[body]
mass = {value = 1.0, unit = "kg", source = "scale"}
inertia = {value = [0.01, 0.01, 0.018], unit = "kg m^2", source = "pendulum"}
gravity = {value = 9.81, unit = "m/s^2", source = "conventional"}

[rotors]
layout = "x"
arm = {value = 0.2, unit = "m", source = "ruler"}
kappa = {value = 0.02, unit = "m", source = "test stand"}
thrust_min = {value = 0.0, unit = "N", source = "test stand"}
thrust_max = {value = 6.0, unit = "N", source = "test stand"}
"""
MASS = 'mass = {value = 1.0, unit = "kg", source = "scale"}'
INERTIA = "[0.01, 0.01, 0.018]"
ARM = 'arm = {value = 0.2, unit = "m", source = "ruler"}'

# (text replaced, its replacement, words of: what, where, found, expected, do)
BROKEN = {
    "misspelt key": (
        "mass =", "mas =", 'no key "mas"', "own.toml line 7, body.mas", "mas", "mass, inertia",
        'Did you mean "mass"?',
    ),
    "misspelt section": (
        "[rotors]", "[rotor]", 'no key "rotor"', "line 11, rotor", "rotor", "rotors",
        'Did you mean "rotors"?',
    ),
    "unknown top key": (
        "notes =", "zzz =", 'no key "zzz"', "line 4, zzz", "zzz", "name, title, kind", "Remove it",
    ),
    "bare number": (
        MASS, "mass = 1.0", "stands alone", "line 7, body.mass", "1.0", "value, unit and source",
        "Write it like mass = {value",
    ),
    "missing unit": (
        'unit = "kg", ', "", "body.mass has no unit", "line 7, body.mass", "'source'",
        "value, unit and source", "Write it like",
    ),
    "missing source": (
        ', source = "scale"', "", "body.mass has no source", "line 7", "'unit'", "source",
        "Write it like",
    ),
    "misspelt part": (
        'source = "scale"', 'sorce = "scale"', 'unknown part "sorce"', "line 7", "sorce",
        "value, unit, source", 'Did you mean "source"?',
    ),
    "wrong unit": (
        '"kg",', '"g",', 'cannot be in "g"', "line 7, body.mass", 'unit = "g"', '"kg"',
        'write unit = "kg"',
    ),
    "missing number": (
        MASS, "", "does not give body.mass", "line 6, body.mass", "nothing", "kg",
        "Add mass under [body]",
    ),
    "text for a number": (
        "value = 1.0", 'value = "1.0"', "not made of finite numbers", "line 7", "'1.0'",
        "one finite number", "without quotes",
    ),
    "truth for a number": (
        "value = 1.0", "value = true", "not made of finite numbers", "line 7", "True",
        "one finite number", "plain numbers",
    ),
    "nan": (
        "value = 1.0", "value = nan", "not made of finite numbers", "line 7", "nan",
        "one finite number", "plain numbers",
    ),
    "two moments": (
        INERTIA, "[0.01, 0.01]", "wrong number of entries", "line 8, body.inertia", "[0.01, 0.01]",
        "a list of 3 finite numbers", "value = [1, 1, 1]",
    ),
    "ragged list": (
        INERTIA, "[0.01, [0.01]]", "not made of finite numbers", "line 8", "[0.01, [0.01]]",
        "a list of 3", "plain numbers",
    ),
    "negative mass": (
        "value = 1.0", "value = -1.0", "mass is not positive", "line 7, body.mass", "-1 kg",
        "above zero", "without a sign",
    ),
    "negative inertia": (
        INERTIA, "[0.01, -0.01, 0.01]", "not positive definite", "line 8, body.inertia", "-0.01",
        "three moments above zero", "principal moments",
    ),
    "impossible inertia": (
        INERTIA, "[0.01, 0.01, 0.03]", "one moment exceeds the sum", "line 8, body.inertia",
        "0.01, 0.01, 0.03", "at most the sum of the other two", "Check the units",
    ),
    "unknown kind": (
        '"small"', '"smal"', '"smal" is not known', "line 3, kind", "smal",
        '"small" or "passenger"', 'Did you mean "small"?',
    ),
    "missing title": (
        'title = "A craft of one\'s own"', "", "title is missing", "own.toml, title", "nothing",
        "a text", "Write title =",
    ),
    "number for a name": (
        'name = "own"', "name = 3", "name is not a text", "line 1, name", "3", "a text in quotes",
        "Write name =",
    ),
    "notes not listed": (
        '["an example"]', '"an example"', "notes are not a list", "line 4, notes", "an example",
        "texts in quotes", "in brackets",
    ),
    "section not a table": (
        "[body]\n", "body = 1\n[limits]\n", "body is not a table", "line 6, body", "1",
        "headed [body]", "Write [body]",
    ),
    "unknown layout": (
        '"x"', '"plux"', '"plux" is not known', "line 12, rotors.layout", "plux",
        '"x" or "plus" or "custom"', 'Did you mean "plus"?',
    ),
    "one lever": (
        "arm =", "levers =", "wrong number of entries", "line 13, rotors.levers", "0.2",
        "a list of 2 finite numbers", "value = [1, 1]",
    ),
    "lengths of another layout": (
        '"x"', '"custom"', '"custom" is not given by these lengths', "line 12, rotors.layout",
        "arm", "positions and spins", "hub distance",
    ),
    "no lengths": (
        ARM, "", "is not given by these lengths", "line 12, rotors.layout", "no lengths",
        "arm or levers", "hub distance",
    ),
    "negative arm": (
        "value = 0.2", "value = -0.2", "rotors.arm is not positive", "line 13", "-0.2",
        "above zero", "without a sign",
    ),
    "negative kappa": (
        "value = 0.02", "value = -0.02", "not a positive length", "line 14, rotors.kappa", "-0.02",
        "above zero", "sign into the spins",
    ),
    "weak rotors": (
        "value = 6.0", "value = 2.0", "cannot hover", "line 16, rotors.thrust_max", "2.453",
        "between 0 and 2 N", "Check mass",
    ),
    "broken TOML": (
        "[body]", "[body", "not valid TOML", "own.toml", "line 6", "TOML 1.0", "Mend the file",
    ),
    "half a wrench box": (
        "[rotors]",
        '[wrench_limits]\nthrust = {value = [0, 20], unit = "N", source = "me"}\n[rotors]',
        "does not give wrench_limits.torque", "line 11, wrench_limits.torque", "nothing", "N m",
        "leave the whole section",
    ),
    "wrench box below the weight": (
        "[rotors]",
        '[wrench_limits]\nthrust = {value = [0, 5], unit = "N", source = "me"}\n'
        'torque = {value = [1, 1, 1], unit = "N m", source = "me"}\n[rotors]',
        "do not hold the weight", "line 12, wrench_limits.thrust", "0 to 5 N", "9.81 N", "Widen",
    ),
    "tilt in degrees without saying": (
        "[rotors]", '[limits]\ntilt = {value = 30, unit = "rad", source = "me"}\n[rotors]',
        "singularity of the Euler angles", "line 12, limits.tilt", "1719 deg", "less than 90 deg",
        "below 90 deg",
    ),
}  # fmt: skip


def test_the_example_without_faults_loads():
    assert vehicles.parse(GOOD, "own.toml").name == "own"


@pytest.mark.parametrize("name", BROKEN)
def test_a_fault_is_told_in_five_parts(name):
    old, new, what, where, found, expected, do = BROKEN[name]
    assert GOOD.count(old) >= 1
    with pytest.raises(UserError, match="where: ") as caught:
        vehicles.parse(GOOD.replace(old, new, 1), "own.toml")
    error = caught.value
    assert what in error.what
    assert where in error.where
    assert found in error.found
    assert expected in error.expected
    assert do in error.do


def test_a_rank_deficient_layout_is_told_at_its_line():
    text = GOOD.replace('"x"', '"custom"').replace(
        ARM,
        "positions = {value = [[0.14, 0.18], [-0.14, 0.18], [0.14, -0.18], [-0.14, -0.18]],"
        ' unit = "m", source = "s"}\nspins = {value = [1, 1, -1, -1], unit = "1", source = "s"}',
    )
    with pytest.raises(UserError, match="cannot command yaw on its own") as caught:
        vehicles.parse(text, "own.toml")
    assert caught.value.where == "own.toml line 12, rotors.layout"


def test_a_half_spin_is_refused():
    text = GOOD.replace('"x"', '"custom"').replace(
        ARM,
        "positions = {value = [[0.1, 0.1], [-0.1, -0.1], [0.1, -0.1], [-0.1, 0.1]],"
        ' unit = "m", source = "s"}\nspins = {value = [1, 1, -1, 0.5], unit = "1", source = "s"}',
    )
    with pytest.raises(UserError, match="neither clockwise nor counter-clockwise") as caught:
        vehicles.parse(text, "own.toml")
    assert caught.value.where == "own.toml line 14, rotors.spins"


def test_an_unknown_name_suggests_the_nearest():
    with pytest.raises(UserError, match='no vehicle named "humingbird"') as caught:
        vehicles.load("humingbird")
    assert caught.value.do == 'Did you mean "hummingbird"?'
    assert "crazyflie" in caught.value.expected


def test_a_missing_directory_and_binary_file_are_told(tmp_path):
    binary = tmp_path / "picture.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    for path, found in (
        (tmp_path / "absent.toml", "No such file"),
        (tmp_path, "directory"),
        (binary, "not UTF-8"),
    ):
        with pytest.raises(UserError, match="cannot be read") as caught:
            vehicles.load(path)
        assert found in caught.value.found
        assert str(path) in caught.value.where


def test_a_huge_file_is_not_read(tmp_path):
    huge = tmp_path / "huge.toml"
    huge.write_text("#" * (vehicles.LARGEST_FILE + 1), encoding="utf-8")
    with pytest.raises(UserError, match="too large"):
        vehicles.load(huge)


def test_hostile_text_is_refused_as_data():
    for text in ("a = " + "[" * 100_000, "a = 1" + "0" * 10_000, "a = __import__('os')"):
        with pytest.raises(UserError, match="not valid TOML"):
            vehicles.parse(text)
    with pytest.raises(UserError, match="not made of finite numbers"):
        vehicles.parse(GOOD.replace("value = 1.0", "value = 1" + "0" * 400))


@pytest.mark.parametrize(
    ("changes", "sentence", "where"),
    [
        ({"kind": "huge"}, "kind of vehicle is not known", "kind"),
        ({"gravity": 0.0}, "gravity is not positive", "gravity"),
        ({"thrust_min": -1.0}, "least rotor thrust is negative", "thrust_min"),
        ({"drag": (0.1, -0.1, 0.0)}, "push the craft along", "drag"),
        ({"rotor_radius": 0.0}, "rotor radius is not positive", "rotor_radius"),
        ({"limits": Limits(speed=-1.0)}, "speed is not positive", "speed"),
        ({"limits": Limits(body_rates=(1.0, 0.0, 1.0))}, "body rates is not", "body_rates"),
        ({"wrench_limits": WrenchLimits((0, 24), (0, 1, 1))}, "torque is not positive", "torque"),
        ({"power": HoverPower(hover=9.0, rated=8.0)}, "does not suffice to hover", "rated"),
        ({"power": HoverPower(9.0, None, 1.2)}, "not a fraction of one", "figure_of_merit"),
    ],
)
def test_a_vehicle_made_in_python_is_checked_alike(changes, sentence, where):
    with pytest.raises(UserError, match=sentence) as caught:
        sample_vehicle(**changes)
    assert caught.value.where == where
    assert caught.value.where in vehicles.KEYS_OF_FIELDS
