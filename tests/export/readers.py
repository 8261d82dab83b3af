"""Readers of exported files: other people's libraries, and arithmetic of their own."""

from __future__ import annotations

import csv
import json
import math
import struct
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from xml.etree import ElementTree

import netCDF4
import numpy as np
import pymap3d
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from pymavlink.dialects.v20 import common

HOME = (37.2296, -80.4139, 634.0)
"""Where the test flights begin on Earth."""


@dataclass(frozen=True)
class Read:
    """What a file says: times, and whatever else is in it, in its own frame.

    ``quaternions`` have w first, whatever the file's order; ``text`` is all the words in it.
    """

    frame: str
    text: str
    times: np.ndarray
    position: np.ndarray | None = None
    velocity: np.ndarray | None = None
    acceleration: np.ndarray | None = None
    quaternions: np.ndarray | None = None
    rates: np.ndarray | None = None
    angular_acceleration: np.ndarray | None = None
    world_rates: np.ndarray | None = None
    yaw: np.ndarray | None = None
    yaw_rate: np.ndarray | None = None
    rotors: np.ndarray | None = None


def read_csv(path: Path) -> Read:
    lines = path.read_text(encoding="utf-8").splitlines()
    words = [line for line in lines if line.startswith("#")]
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))

    def columns(*names):
        return np.array([[float(row[name]) for name in names] for row in rows])

    def vector(quantity):
        return columns(*(f"{quantity}_{axis}" for axis in "xyz"))

    text = "\n".join(words)
    return Read(
        frame="enu" if "frame: ENU" in text else "ned",
        text=text,
        times=columns("t")[:, 0],
        position=vector("p"),
        velocity=vector("v"),
        acceleration=vector("a_lin"),
        quaternions=columns("q_w", "q_x", "q_y", "q_z"),
        rates=vector("w"),
        angular_acceleration=vector("a_rot"),
        rotors=columns("u_1", "u_2", "u_3", "u_4"),
    )


def packets(path: Path) -> list:
    """Return (microseconds, message) of a telemetry log, by pymavlink, which checks every CRC."""
    content, place, found = path.read_bytes(), 0, []
    parser = common.MAVLink(None)
    while place < len(content):
        (time,) = struct.unpack_from(">Q", content, place)
        length = 12 + content[place + 9]
        (message,) = parser.parse_buffer(content[place + 8 : place + 8 + length])
        found.append((time, message))
        place += 8 + length
    return found


def read_mavlink(path: Path) -> Read:
    found = packets(path)
    texts: dict[int, str] = {}
    for i, (_, message) in enumerate(found):
        if message.get_type() == "STATUSTEXT":
            key = message.id or -i
            texts[key] = texts.get(key, "") + message.text
    targets = [m for _, m in found if m.get_type().startswith("SET_")]
    times = np.array([m.time_boot_ms for m in targets]) * 1e-3
    rest: dict[str, np.ndarray] = {}
    if targets[0].get_type() == "SET_POSITION_TARGET_LOCAL_NED":
        assert {m.coordinate_frame for m in targets} == {common.MAV_FRAME_LOCAL_NED}
        rest = {
            "position": np.array([[m.x, m.y, m.z] for m in targets]),
            "velocity": np.array([[m.vx, m.vy, m.vz] for m in targets]),
            "acceleration": np.array([[m.afx, m.afy, m.afz] for m in targets]),
            "yaw": np.array([m.yaw for m in targets]),
            "yaw_rate": np.array([m.yaw_rate for m in targets]),
        }
    else:
        names = ("body_roll_rate", "body_pitch_rate", "body_yaw_rate")
        rest = {
            "quaternions": np.array([m.q for m in targets]),
            "rates": np.array([[getattr(m, name) for name in names] for m in targets]),
            "rotors": np.array([[m.thrust] for m in targets]),
        }
    return Read("ned", "\n".join(texts.values()), times, **rest)


def read_ros2(path: Path) -> Read:
    """Read by Foxglove's mcap and its decoder of ROS 2 messages, which know nothing of rosbags."""
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        found = {
            channel.topic: (schema.name, message)
            for schema, channel, _, message in reader.iter_decoded_messages()
        }
    kind, trajectory = found["/command/trajectory"]
    assert kind == "trajectory_msgs/msg/MultiDOFJointTrajectory"
    assert (trajectory.header.frame_id, list(trajectory.joint_names)) == ("map", ["base_link"])
    points = trajectory.points

    def vectors(pick):
        return np.array([[v.x, v.y, v.z] for v in map(pick, points)])

    turns = [p.transforms[0].rotation for p in points]
    times = [p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in points]
    return Read(
        frame="enu",
        text=found["/skyknot/about"][1].data,
        times=np.array(times),
        position=vectors(lambda p: p.transforms[0].translation),
        velocity=vectors(lambda p: p.velocities[0].linear),
        acceleration=vectors(lambda p: p.accelerations[0].linear),
        quaternions=np.array([[q.w, q.x, q.y, q.z] for q in turns]),
        world_rates=vectors(lambda p: p.velocities[0].angular),
    )


def read_plan(path: Path) -> Read:
    """Fly the plan on paper: wait at a waypoint, then to the next at the speed last set."""
    plan = json.loads(path.read_text(encoding="utf-8"))
    home = plan["mission"]["plannedHomePosition"]
    clock, wait, speed = 0.0, 0.0, math.nan
    times, places, headings = [], [], []
    for item in plan["mission"]["items"]:
        p1, p2, _, heading, latitude, longitude, height = item["params"]
        if item["command"] == 178:
            speed = p2
        if item["command"] != 16:
            continue
        north, east, _ = pymap3d.geodetic2ned(latitude, longitude, home[2] + height, *home)
        place = np.array([north, east, -height])
        if places:
            clock += wait + np.linalg.norm(place - places[-1]) / speed
        wait = p1
        times.append(clock)
        places.append(place)
        headings.append(np.radians(heading))
    return Read(
        frame="ned",
        text=json.dumps(plan["skyknot"]),
        times=np.array(times),
        position=np.array(places),
        yaw=np.array(headings),
    )


def read_netcdf(path: Path) -> Read:
    """Read by the C library of the format's makers."""
    with netCDF4.Dataset(path) as data:
        data.set_auto_mask(False)
        text = "\n".join(f"{name}: {data.getncattr(name)}" for name in data.ncattrs())

        def columns(*names):
            return np.stack([data[name][:] for name in names], axis=1)

        return Read(
            frame=data.frame.split(":")[0].lower(),
            text=text,
            times=data["time"][:],
            position=columns("x", "y", "z"),
            velocity=columns("vx", "vy", "vz"),
            quaternions=columns("q_w", "q_x", "q_y", "q_z"),
            rates=columns("p", "q", "r"),
            rotors=columns(*(f"rotor_thrust_{i}" for i in (1, 2, 3, 4))),
        )


def from_home(longitudes, latitudes, heights) -> np.ndarray:
    """Return NED by pymap3d; the altitude is kept, as the documents say."""
    north, east, _ = pymap3d.geodetic2ned(latitudes, longitudes, heights, *HOME)
    return np.stack([north, east, HOME[2] - np.asarray(heights)], axis=1)


def read_geojson(path: Path) -> Read:
    track = json.loads(path.read_text(encoding="utf-8"))["features"][0]
    assert (track["type"], track["geometry"]["type"]) == ("Feature", "LineString")
    return Read(
        frame="ned",
        text=json.dumps({k: v for k, v in track["properties"].items() if isinstance(v, str)}),
        times=np.array(track["properties"]["times"]),
        position=from_home(*np.array(track["geometry"]["coordinates"]).T),
    )


def read_kml(path: Path) -> Read:
    names = {"k": "http://www.opengis.net/kml/2.2", "gx": "http://www.google.com/kml/ext/2.2"}
    document = ElementTree.fromstring(path.read_bytes()).find("k:Document", names)
    track = document.find("k:Placemark/gx:Track", names)
    assert track.find("k:altitudeMode", names).text == "absolute"
    moments = [datetime.fromisoformat(when.text) for when in track.findall("k:when", names)]
    places = [coord.text.split() for coord in track.findall("gx:coord", names)]
    words = [document.find(f"k:{part}", names).text for part in ("name", "description")]
    return Read(
        frame="ned",
        text="\n".join(words),
        times=np.array([(moment - moments[0]).total_seconds() for moment in moments]),
        position=from_home(*np.array(places, dtype=float).T),
    )


READERS = {
    "csv": read_csv,
    "netcdf": read_netcdf,
    "plan": read_plan,
    "mavlink-position": read_mavlink,
    "mavlink-attitude": read_mavlink,
    "ros2": read_ros2,
    "geojson": read_geojson,
    "kml": read_kml,
}
"""A reader for every format."""
