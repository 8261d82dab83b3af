"""MAVLink setpoint streams as telemetry logs (.tlog): times and MAVLink 2 packets.

Sources: mavlink.io, "MAVLink 2 Packet Serialization" and the message set common.xml (numbers,
CRC_EXTRA, field order, type masks); QGroundControl's telemetry log: every packet after eight bytes
of microseconds since 1970, big-endian. Two streams, because an autopilot follows one:

- SET_POSITION_TARGET_LOCAL_NED (84): position, velocity, acceleration, yaw and yaw rate, all used.
- SET_ATTITUDE_TARGET (82): attitude (w first), body rates and thrust from 0 to 1, all used.

The first packets are STATUSTEXT (253) with the mission, the certificate and, for thrust, the scale.
Frames are those of the flight itself, LOCAL_NED and BODY_FRD: nothing is turned.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from skyknot.export.base import EPOCH, Encoded, Format, Request

MAGIC = 0xFD
SYSTEM, COMPONENT = 1, 191
"""Sender: system 1, MAV_COMP_ID_ONBOARD_COMPUTER; receiver: system 1, MAV_COMP_ID_AUTOPILOT1."""

TARGET_SYSTEM, TARGET_COMPONENT = 1, 1
LOCAL_NED = 1
USE_EVERYTHING = 0
POSITION_TARGET, ATTITUDE_TARGET, STATUSTEXT = 84, 82, 253
CRC_EXTRA = {POSITION_TARGET: 143, ATTITUDE_TARGET: 49, STATUSTEXT: 83}
NOTICE, TEXT_LENGTH = 5, 50

Packet = tuple[int, int, bytes]
"""Milliseconds since the start, message number, payload."""


def encode_position(request: Request) -> Encoded:
    """Return the log of SET_POSITION_TARGET_LOCAL_NED."""
    flight = request.sampled
    yaw = np.angle(np.exp(1j * flight.yaw))
    rows = np.column_stack(
        [flight.position, flight.velocity, flight.acceleration, yaw, flight.yaw_rate]
    )
    tail = (USE_EVERYTHING, TARGET_SYSTEM, TARGET_COMPONENT, LOCAL_NED)
    packets = [
        (time, POSITION_TARGET, struct.pack("<I11fHBBB", time, *row, *tail))
        for time, row in zip(_milliseconds(flight.times), rows.tolist(), strict=True)
    ]
    return Encoded(_log([*_words(request), *packets]), _accuracy(flight.position, "position", "m"))


def encode_attitude(request: Request) -> Encoded:
    """Return the log of SET_ATTITUDE_TARGET; thrust is linear, 1 is all rotors at their limit."""
    flight, vehicle = request.sampled, _vehicle(request)
    assert flight.attitude is not None
    assert flight.thrust is not None
    full = vehicle.allocation.rotor_count * vehicle.thrust_max
    thrust = np.clip(flight.thrust / full, 0.0, 1.0)
    rows = np.column_stack([flight.attitude.quaternions, flight.attitude.rates, thrust])
    tail = (TARGET_SYSTEM, TARGET_COMPONENT, USE_EVERYTHING)
    packets = [
        (time, ATTITUDE_TARGET, struct.pack("<I8fBBB", time, *row, *tail))
        for time, row in zip(_milliseconds(flight.times), rows.tolist(), strict=True)
    ]
    scale = f"thrust 1 is {full:.6g} N, linear; hover {vehicle.weight / full:.4f}"
    accuracy = f"{_accuracy(flight.attitude.rates, 'rates', 'rad/s')}; {scale}"
    return Encoded(_log([*_words(request, scale), *packets]), accuracy)


def _vehicle(request: Request) -> Any:
    return getattr(request.solution.problem, "vehicle", None)


def _milliseconds(times: Any) -> list[int]:
    return [int(entry) for entry in np.rint(1e3 * times)]


def _accuracy(values: Any, name: str, unit: str) -> str:
    half = 0.5 * float(np.spacing(np.float32(np.max(np.abs(values)))))
    return f"whole milliseconds, single precision: {name} to {half:.1g} {unit}"


def _words(request: Request, *more: str) -> Iterator[Packet]:
    """Yield STATUSTEXT packets; a text of more than 50 bytes comes in chunks of one number."""
    texts = (f"skyknot: {request.title}", request.verdict, *more)
    for number, text in enumerate(texts, start=1):
        content = text.encode("ascii", "replace")
        chunks = range(0, len(content), TEXT_LENGTH)
        many = number if len(chunks) > 1 else 0
        for sequence, start in enumerate(chunks):
            part = content[start : start + TEXT_LENGTH]
            yield 0, STATUSTEXT, struct.pack("<B50sHB", NOTICE, part, many, sequence)


def _log(packets: Iterable[Packet]) -> bytes:
    """Return the bytes of a telemetry log."""
    start = int(EPOCH.timestamp()) * 1_000_000
    parts = []
    for sequence, (time, number, payload) in enumerate(packets):
        parts.append(struct.pack(">Q", start + 1000 * time))
        parts.append(_framed(sequence % 256, number, payload))
    return b"".join(parts)


def _framed(sequence: int, number: int, payload: bytes) -> bytes:
    """Return one MAVLink 2 packet, not signed, trailing zeros cut as the protocol asks."""
    content = payload.rstrip(b"\0") or b"\0"
    head = struct.pack(
        "<BBBBBB3s", len(content), 0, 0, sequence, SYSTEM, COMPONENT, number.to_bytes(3, "little")
    )
    checksum = _x25(head + content + bytes([CRC_EXTRA[number]]))
    return bytes([MAGIC]) + head + content + struct.pack("<H", checksum)


def _x25(content: bytes) -> int:
    """Return the CRC-16/MCRF4XX of bytes."""
    checksum = 0xFFFF
    for byte in content:
        mixed = byte ^ (checksum & 0xFF)
        mixed ^= (mixed << 4) & 0xFF
        checksum = (checksum >> 8) ^ (mixed << 8) ^ (mixed << 3) ^ (mixed >> 4)
    return checksum


MAVLINK_POSITION = Format(
    name="mavlink-position",
    title="MAVLink log of SET_POSITION_TARGET_LOCAL_NED",
    file_name="flight_position.tlog",
    encode=encode_position,
    frames=("ned",),
    rate=50.0,
    tick=1e-3,
)
MAVLINK_ATTITUDE = Format(
    name="mavlink-attitude",
    title="MAVLink log of SET_ATTITUDE_TARGET",
    file_name="flight_attitude.tlog",
    encode=encode_attitude,
    frames=("ned",),
    rate=50.0,
    tick=1e-3,
    needs=("attitude", "thrust", "rotors"),
)
