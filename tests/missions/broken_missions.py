"""Broken mission files: a sound one, and one change each, with the five parts of its message."""

from __future__ import annotations

from dataclasses import dataclass

SOUND = """\
title = "A sound mission"
vehicle = "hummingbird"

[start]
position = [0.0, 0.0, -5.0]

[goal]
position = [30.0, 0.0]
altitude = 5.0

[[waypoints]]
name = "gate"
position = [15.0, 6.0, -8.0]
tolerance = 1.0

[horizon]
free = {lower = 2.0, upper = 30.0}

[objective]
kind = "effort"
R = [0.1, 100, 100, 100]
time = 1.0

[limits]
speed = 6.0
tilt_degrees = 30.0

[airspace]
altitude = {lowest = 2.0, highest = 40.0}

[[airspace.obstacles]]
kind = "cylinder"
name = "mast"
center = [15.0, 0.0]
radius = 2.0

[scheme]
name = "hermite-simpson"
segments = 40
"""


@dataclass(frozen=True)
class Broken:
    """One fault: ``old`` becomes ``new``, and what its message must contain, part by part."""

    name: str
    old: str
    new: str
    what: str
    where: str
    found: str
    expected: str
    do: str

    @property
    def text(self) -> str:
        """The broken mission file."""
        base = SOUND.replace(EFFORT, 'kind = "energy"') if "energy" in self.name else SOUND
        assert base.count(self.old) == 1, f"'{self.old}' must occur once"
        return base.replace(self.old, self.new)


START = "position = [0.0, 0.0, -5.0]"
FREE = "free = {lower = 2.0, upper = 30.0}"
R = "R = [0.1, 100, 100, 100]"
EFFORT = 'kind = "effort"'
SPEED = "speed = 6.0"
TILT = "tilt_degrees = 30.0"
SCHEME = 'name = "hermite-simpson"'

BROKEN = (
    Broken(
        "bad_toml", 'vehicle = "hummingbird"', 'vehicle = "hummingbird',
        "not valid TOML", "line 2", "Illegal character", "key = value", "missing quote",
    ),
    Broken(
        "misspelt_section", "[limits]", "[limts]",
        'has no key "limts"', "line 24, limts", '"limts"', "limits", 'Did you mean "limits"?',
    ),
    Broken(
        "misspelt_key", "tolerance = 1.0", "tolerence = 1.0",
        'waypoints[1] has no key "tolerence"', "line 14, waypoints[1].tolerence", "tolerence",
        "tolerance", 'Did you mean "tolerance"?',
    ),
    Broken(
        "misspelt_obstacle_key", "radius = 2.0", "radios = 2.0",
        'airspace.obstacles[1] has no key "radios"', "line 35", "radios", "clearance",
        'Did you mean "radius"?',
    ),
    Broken(
        "missing_vehicle", 'vehicle = "hummingbird"\n', "",
        "vehicle is missing", "vehicle", "nothing", "name of a vehicle", "Add vehicle to",
    ),
    Broken(
        "missing_radius", "radius = 2.0\n", "",
        "airspace.obstacles[1].radius is missing", "line 31", "nothing", "radius [m]",
        "Add radius to airspace.obstacles[1]",
    ),
    Broken(
        "unknown_vehicle", '"hummingbird"', '"humingbird"',
        'no vehicle named "humingbird"', "line 2, vehicle", "humingbird", "crazyflie",
        'Did you mean "hummingbird"?',
    ),
    Broken(
        "missing_vehicle_file", '"hummingbird"', '"nowhere/craft.toml"',
        "cannot be read", "craft.toml", "No such file", "file", "",
    ),
    Broken(
        "unknown_scheme", SCHEME, 'name = "hermite-simson"',
        "scheme.name is not one of its choices", "line 38, scheme.name", "hermite-simson",
        "trapezoid", 'Did you mean "hermite-simpson"?',
    ),
    Broken(
        "unknown_solver", "segments = 40", 'segments = 40\n[solver]\nname = "ipot"',
        "solver.name is not one of its choices", "line 41, solver.name", "ipot", "interior-point",
        'Did you mean "ipopt"?',
    ),
    Broken(
        "unknown_objective", EFFORT, 'kind = "fuel"',
        "objective.kind is not one of its choices", "line 20", "fuel", "minimum-time",
        "Take one of the choices",
    ),
    Broken(
        "unknown_obstacle", 'kind = "cylinder"', 'kind = "cilinder"',
        "is of no known kind", "airspace.obstacles[1]", 'kind = "cilinder"', "half-space",
        'Did you mean "cylinder"?',
    ),
    Broken(
        "text_for_a_number", SPEED, 'speed = "6"',
        "limits.speed is not what it should be", "line 25, limits.speed", "'6'",
        "a number, without quotes", "Write a number",
    ),
    Broken(
        "not_finite", SPEED, "speed = inf",
        "limits.speed is not what it should be", "line 25", "inf", "finite number",
        "Write a finite",
    ),
    Broken(
        "fraction_of_a_segment", "segments = 40", "segments = 40.5",
        "scheme.segments is not what it should be", "line 39", "40.5", "a whole number",
        "Write a whole number",
    ),
    Broken(
        "no_segments", "segments = 40", "segments = 0",
        "scheme.segments is out of range", "line 39", "0", "1 or more", "Give a number 1 or more",
    ),
    Broken(
        "negative_accuracy", "segments = 40", "segments = 40\naccuracy = -1e-4",
        "scheme.accuracy is out of range", "line 40, scheme.accuracy", "-0.0001", "1e-10 or more",
        "Give a number 1e-10 or more.",
    ),
    Broken(
        "accuracy_in_a_word", "segments = 40", 'segments = 40\naccuracy = "of"',
        "scheme.accuracy is not what it should be", "line 40, scheme.accuracy", "'of'",
        "'off': the first mesh alone", "Write a number, without quotes.",
    ),
    Broken(
        "negative_speed", SPEED, "speed = -6.0",
        "limits.speed is out of range", "line 25", "-6.0", "above 0", "Give a number above 0",
    ),
    Broken(
        "tilt_beyond_the_horizon", TILT, "tilt_degrees = 95.0",
        "limits.tilt_degrees is out of range", "line 26", "95", "below 90",
        "Give a number below 90",
    ),
    Broken(
        "too_many_numbers", START, "position = [0.0, 0.0, -5.0, 1.0]",
        "start.position has the wrong number of entries", "line 5", "4 entries", "at most 3",
        "Give at most 3",
    ),
    Broken(
        "negative_weight", R, "R = [0.1, -100, 100, 100]",
        "objective.R[2] is out of range", "line 21", "-100", "0 or more", "Give a number 0 or more",
    ),
    Broken(
        "weights_of_wrong_length", R, "R = [0.1, 100, 100]",
        "weights R do not fit", "line 21, objective.R", "3 numbers", "4: T, tau_x, tau_y, tau_z",
        "Give one weight for each",
    ),
    Broken(
        "no_weights", R + "\n", "",
        "needs weights R", "objective.R", "nothing", "for each control", "Add R",
    ),
    Broken(
        "weights_without_use", R, R + "\nQ = [1,1,1,1,1,1,1,1,1,1,1,1]",
        "does not use Q", "line 22, objective.Q", "effort", "tracking", "Drop Q",
    ),
    Broken(
        "height_twice", START, START + "\naltitude = 5.0",
        "height of start is given twice or not at all", "line 5, start.position",
        "3 numbers, altitude = 5", "north, east and altitude", "two and an altitude",
    ),
    Broken(
        "height_never", START, "position = [0.0, 0.0]",
        "height of start is given twice or not at all", "line 5", "no altitude", "[m]",
        "Give three numbers",
    ),
    Broken(
        "heading_twice", START, START + "\nyaw = 1.0\nyaw_degrees = 57.3",
        "heading of start is given twice", "line 7, start.yaw_degrees", "yaw = 1", "[deg]",
        "Drop one",
    ),
    Broken(
        "horizon_reversed", FREE, "free = {lower = 30.0, upper = 2.0}",
        "free horizon leave no room", "line 17, horizon.free", "lower = 30, upper = 2",
        "lower < upper", "Exchange them",
    ),
    Broken(
        "horizon_guess_outside", FREE, "free = {lower = 2.0, upper = 30.0, guess = 50.0}",
        "guess of the free horizon lies outside", "line 17, horizon.free.guess", "guess = 50",
        "2 to 30", "Move the guess",
    ),
    Broken(
        "horizon_twice", FREE, FREE + "\nduration = 10.0",
        "horizon is given twice", "line 16, horizon", "both", "duration = 10.0", "Keep one",
    ),
    Broken(
        "minimum_time_of_a_fixed_horizon", FREE + "\n\n[objective]\n" + EFFORT,
        'duration = 10.0\n\n[objective]\nkind = "minimum-time"',
        "needs a free horizon", "line 17, horizon.duration", "duration = 10", "free = {lower",
        "Let the horizon be free",
    ),
    Broken(
        "goal_that_nothing_pulls_to", "altitude = 5.0\n", 'altitude = 5.0\nreach = "cost"\n',
        "Nothing pulls the flight to its goal", "line 10, goal.reach", "effort", "tracking",
        'Write reach = "exact"',
    ),
    Broken(
        "start_inside_an_obstacle", START, "position = [15.0, 1.0, -5.0]",
        "start lies inside 'mast'", "line 5, start.position", "1 m on the wrong side", "line 31",
        "Move start",
    ),
    Broken(
        "waypoint_inside_an_obstacle", "[15.0, 6.0, -8.0]", "[15.0, 0.1, -8.0]",
        "waypoints[1] lies inside 'mast'", "line 13, waypoints[1].position", "on the wrong side",
        "line 31", "Move waypoints[1]",
    ),
    Broken(
        "goal_outside_the_altitude_band", "altitude = 5.0", "altitude = 50.0",
        "goal lies outside 'altitude band'", "line 8, goal.position", "height 50 m",
        "2 to 40 m above ground", "Move goal",
    ),
    Broken(
        "goal_underground", "altitude = 5.0", "altitude = -5.0",
        "goal lies outside 'altitude band'", "line 8", "height -5 m", "2 to 40 m", "Move goal",
    ),
    Broken(
        "band_reversed", "{lowest = 2.0, highest = 40.0}", "{lowest = 40.0, highest = 2.0}",
        "altitude band leaves no room", "line 29, airspace.altitude", "lowest = 40",
        "lowest < highest", "Exchange them",
    ),
    Broken(
        "goal_too_far_for_the_time", FREE, "duration = 4.0",
        "cannot be reached in time", "line 17, horizon.duration", "4 s", "m at 6 m/s",
        "Give more time",
    ),
    Broken(
        "climb_too_slow_for_the_time", SPEED, "speed = 6.0\nclimb = 0.02",
        "cannot be reached in time", "line 17, horizon.free.upper", "30 s", "upwards at 0.02 m/s",
        "raise the speed limits",
    ),
    Broken(
        "start_too_fast", START, START + "\nvelocity = [9.0, 0.0, 0.0]",
        "velocity at start is above the speed limit", "line 6, start.velocity", "9 m/s",
        "at most 6 m/s", "Slow the end down",
    ),
    Broken(
        "waypoints_out_of_order", "tolerance = 1.0",
        'tolerance = 1.0\nat = 0.6\n[[waypoints]]\nposition = [20.0, 6.0, -8.0]\nat = 0.3',
        "waypoint 2 is not after", "line 18, waypoints[2].at", "0.3 after 0.6", "increase",
        "order of flight",
    ),
    Broken(
        "name_taken", 'name = "gate"', 'name = "mast"',
        "name 'mast' is taken", "line 12, waypoints[1].name", "line 33", "a name of its own",
        "Rename one",
    ),
    Broken(
        "name_reserved", 'name = "mast"', 'name = "tilt limit"',
        "name 'tilt limit' is taken", "line 33", "skyknot uses itself", "a name of its own",
        "Rename",
    ),
    Broken(
        "tilt_twice", TILT, TILT + "\ntilt = 0.5",
        "tilt limit is given twice", "line 26, limits.tilt_degrees", "tilt = 0.5", "[rad]",
        "Drop one",
    ),
    Broken(
        "tilt_of_a_point", 'vehicle = "hummingbird"',
        'vehicle = "hummingbird"\nmodel = "translational-yaw"',
        "has no attitude to limit", "line 27, limits.tilt_degrees", "30", "wrench",
        "Drop tilt_degrees",
    ),
    Broken(
        "control_rates_of_wrong_length", SPEED, "speed = 6.0\ncontrol_rates = [1.0, 2.0]",
        "control rates do not fit", "line 26, limits.control_rates", "2 numbers",
        "4: T, tau_x, tau_y, tau_z", "Give one rate",
    ),
    Broken(
        "wind_without_drag", '"hummingbird"', '"report"\nwind = [3.0, 0.0, 0.0]',
        "wind has no effect", "line 3, wind", "no drag", "a vehicle with drag", "Drop the wind",
    ),
    Broken(
        "energy_of_an_unknown_craft", 'vehicle = "hummingbird"', 'vehicle = "rpg_racing"',
        "energy of vehicle 'rpg_racing' is not known", "line 20, objective.kind",
        "without rotor radius", "hover", 'Use kind = "effort"',
    ),
    Broken(
        "leg_without_length", "[scheme]",
        '[[airspace.corridors]]\nname = "lane"\nradius = 9\npoints = [[0,0,0],[0,0,0]]\n[scheme]',
        "'lane' has no size", "line 37, airspace.corridors[1]", "length of a leg: 0.0",
        "a positive number", "size greater than zero",
    ),
    Broken(
        "wall_without_direction",
        'kind = "cylinder"\nname = "mast"\ncenter = [15.0, 0.0]\nradius = 2.0',
        'kind = "half-space"\nname = "mast"\nnormal = [0.0, 0.0, 0.0]\noffset = 1.0',
        "'mast' has no size", "line 31, airspace.obstacles[1]", "length of normal: 0.0",
        "a positive number", "size greater than zero",
    ),
    Broken(
        "sum_of_a_free_horizon", "segments = 40", 'segments = 40\nobjective = "sum"',
        "no meaning with a free horizon", "line 40, scheme.objective", "sum", "integral",
        'Write objective = "integral"',
    ),
    Broken(
        "control_the_scheme_does_not_know", SCHEME, 'name = "euler"\ncontrols = "quadratic"',
        "does not know this kind of control", "line 39, scheme.controls", "quadratic", '"hold"',
        "Choose one of these",
    ),
    Broken(
        "control_of_a_single_point", SCHEME, 'name = "radau"\npoints = 1\ncontrols = "polynomial"',
        "does not know this kind of control", "line 40, scheme.controls", "polynomial", '"hold"',
        "Choose one of these",
    ),
    Broken(
        "points_of_a_scheme_that_has_its_own", SCHEME, 'name = "euler"\npoints = 4',
        "cannot have this number of points", "line 39, scheme.points", "4", "no points",
        "Leave it out",
    ),
    Broken(
        "too_few_points", SCHEME, 'name = "lobatto"\npoints = 1',
        "cannot have this number of points", "line 39, scheme.points", "1", "2 or more",
        "points = 5",
    ),
    Broken(
        "bow_without_offset", "segments = 40", 'segments = 40\n[guess]\nkind = "bow"',
        "'bow' needs offset", "line 41, guess.kind", "nothing", "offset [m]", "Add offset",
    ),
    Broken(
        "offset_without_bow", "segments = 40",
        'segments = 40\n[guess]\nkind = "straight"\noffset = 2.0',
        "'straight' does not use offset", "line 42, guess.offset", "straight", 'kind = "bow"',
        "Drop offset",
    ),
)  # fmt: skip
