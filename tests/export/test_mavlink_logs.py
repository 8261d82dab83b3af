"""Claim: MAVLink logs are what other ground software reads, packet by packet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import common

from export.flights import CERTIFIED, flown
from export.readers import packets, read_mavlink
from skyknot.export import write_export

SOLUTION = flown("asymmetric path")


def written(folder, name, **options):
    path = folder / "flight.tlog"
    return write_export(SOLUTION, path, name, certificate=CERTIFIED, **options)


@pytest.mark.parametrize("name", ["mavlink-position", "mavlink-attitude"])
def test_the_log_opens_as_a_telemetry_log(name, tmp_path):
    """pymavlink's own log reader finds the same packets at the same times."""
    written(tmp_path, name)
    log = mavutil.mavlink_connection(str(tmp_path / "flight.tlog"), dialect="common")
    seconds, kinds = [], set()
    while (message := log.recv_match(blocking=False)) is not None:
        assert message.get_type() != "BAD_DATA"
        kinds.add(message.get_type())
        seconds.append(message._timestamp)
    log.close()
    mine = packets(tmp_path / "flight.tlog")
    np.testing.assert_allclose(np.array(seconds), [1e-6 * time for time, _ in mine], atol=1e-6)
    assert len(kinds) == 2
    assert seconds[-1] - seconds[0] == pytest.approx(SOLUTION.trajectory.duration)


def test_pymavlink_packs_the_same_bytes(tmp_path):
    """Decoded and packed again by the other implementation, every packet is the same."""
    for name in ("mavlink-position", "mavlink-attitude"):
        written(tmp_path, name, rate=5)
        content = (tmp_path / "flight.tlog").read_bytes()
        packer = common.MAVLink(None, srcSystem=1, srcComponent=191)
        again = b"".join(
            time.to_bytes(8, "big") + _packed(packer, message, sequence)
            for sequence, (time, message) in enumerate(packets(tmp_path / "flight.tlog"))
        )
        assert content == again


def _packed(packer, message, sequence):
    packer.seq = sequence % 256
    return message.pack(packer)


def test_setpoints_come_at_the_rate_and_address_the_autopilot(tmp_path):
    written(tmp_path, "mavlink-position", rate=20)
    targets = [m for _, m in packets(tmp_path / "flight.tlog") if m.get_type() != "STATUSTEXT"]
    assert set(np.diff([m.time_boot_ms for m in targets])) == {50}
    assert {(m.target_system, m.target_component) for m in targets} == {(1, 1)}
    assert {m.type_mask for m in targets} == {0}
    assert {(m.get_srcSystem(), m.get_srcComponent()) for m in targets} == {(1, 191)}


def test_thrust_is_a_share_of_all_rotors_and_the_log_says_of_how_much(tmp_path):
    craft = SOLUTION.problem.vehicle
    full = 4 * craft.thrust_max
    accuracy = written(tmp_path, "mavlink-attitude").accuracy
    read = read_mavlink(tmp_path / "flight.tlog")
    np.testing.assert_allclose(read.rotors * full, craft.hover[0] + 0.3, rtol=1e-7)
    scale = f"thrust 1 is {full:.6g} N, linear; hover {craft.weight / full:.4f}"
    assert scale in read.text
    assert scale in accuracy


def test_a_long_sentence_comes_in_chunks(tmp_path):
    sentence = "Not certified: " + "the open-loop flight misses by a mile, " * 4 + "truly."
    failed = type("Certificate", (), {"passed": False, "sentence": sentence})
    path = tmp_path / "flight.tlog"
    write_export(SOLUTION, path, "mavlink-position", certificate=failed, uncertified=True)
    assert f"UNCERTIFIED: {sentence[15:-1]}" in read_mavlink(path).text


def test_yaw_is_told_within_half_a_turn(tmp_path):
    many = flown("pure yaw", segments=40)
    states = many.trajectory.states.copy()
    assert states[-1, 8] < np.pi
    turned = type(many.trajectory)(
        many.times, states + 10 * np.eye(12)[8], many.controls, None, *_names(many)
    )
    solution = replace(many, trajectory=turned)
    write_export(solution, tmp_path / "f.tlog", "mavlink-position", certificate=CERTIFIED)
    yaw = read_mavlink(tmp_path / "f.tlog").yaw
    assert np.all(np.abs(yaw) <= np.float32(np.pi))
    np.testing.assert_allclose(np.exp(1j * yaw[0]), np.exp(10j), atol=1e-6)


def _names(solution):
    return solution.trajectory.state_names, solution.trajectory.control_names
