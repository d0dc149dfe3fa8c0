# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""`python -m tmini`: what it writes and sends is read by programs of others."""

import io
import itertools
import json
import math
import re
import signal
import struct
import subprocess
import sys
import time
from types import SimpleNamespace

import numpy as np
import pytest

import tmini
from conftest import RECORDINGS, SIM
from lidar_bytes import packet
from tmini.__main__ import _parser
from tmini._command import scans_of
from tmini._laser import Laser
from tmini._scan import POINT

RECORDING = RECORDINGS / "sim-6hz.bin"
REMARKS = "no scans from x; waiting for it\nthe lidar is back\n"


def messages_in(path):
    """(stamp in s, LaserScan) of each message, read by rosbags."""
    with pytest.importorskip("rosbags.highlevel").AnyReader([path]) as bag:
        for connection, _, data in bag.messages():
            message = bag.deserialize(data, connection.msgtype)
            stamp = message.header.stamp
            assert (connection.topic, message.header.frame_id) == ("/scan", "laser")
            yield stamp.sec + stamp.nanosec / 1e9, message


@pytest.fixture
def room(tmp_path):
    pytest.importorskip("mcap_ros2")
    return tmp_path / "room.mcap"


def nearest(scan, ray, half=0.499):
    """The nearest distance within half a degree of ray / 360 of a circle, counter-clockwise."""
    away = (scan.angles_deg + ray + 180) % 360 - 180
    here = scan.ranges_m[(away > -half) & (away < half)]
    return np.nanmin(here, initial=np.inf)


@pytest.mark.parametrize("words, mount, begin_deg", [
    ((), {}, 0), (("--upside-down", "--mask", "95:110"), {"upside_down": True, "mask": [(95, 110)]}, 0),
    (("--front", "90"), {"front": 90}, 90)], ids=["upright", "upside_down", "turned"])
def test_a_recording_becomes_messages_however_the_lidar_is_mounted(run, room, words, mount, begin_deg):
    assert run("mcap", RECORDING, room, *words) == (0, f"{room}: 9 scans; 1 incomplete\n", "")
    scans, found = list(tmini.read(RECORDING, **mount)), list(messages_in(room))
    assert len(found) == len(scans)
    for scan, (stamp, message) in zip(scans, found):
        first = round(math.degrees(message.angle_min))
        assert abs(first - begin_deg) <= 1
        if not mount:
            assert stamp == pytest.approx(scan.end_s, abs=1e-6 if scan.complete else 0.2)
        assert message.angle_increment == pytest.approx(math.radians(1), rel=1e-6)
        assert message.angle_max == pytest.approx(message.angle_min + math.radians(359), rel=1e-6)
        assert (message.range_min, message.range_max) == pytest.approx((0.05, 12))
        for ray in range(4, 356):  # Ahead, where a turn ends, only the points of one end count.
            if math.isfinite(message.ranges[ray]):
                assert nearest(scan, ray + first, 0.501) - 1e-6 <= message.ranges[ray]
            if math.isfinite(nearest(scan, ray + first)):
                assert message.ranges[ray] <= nearest(scan, ray + first) + 1e-6
        assert np.isin(message.ranges, np.append(scan.ranges_m, np.nan).astype(np.float32)).sum() \
            == np.isfinite(message.ranges).sum() > (300 if scan.complete else 0)
    scan, (stamp, message) = scans[4], found[4]
    first = round(math.degrees(message.angle_min))
    assert message.scan_time == pytest.approx(1 / scan.frequency_hz, rel=0.02)
    assert abs(message.time_increment) == pytest.approx(message.scan_time / 360)
    assert message.intensities[np.nanargmin(message.ranges)] == scan.intensities[np.nanargmin(scan.ranges_m)]
    assert np.isnan(message.ranges[-100 - first]) == ("mask" in mount)
    for index in (5, 300, 600):
        ray = round(-scan.angles_deg[index] - first) % 360
        assert message.ranges[ray] == pytest.approx(nearest(scan, ray + first), abs=1e-6)
        assert stamp + ray * message.time_increment == pytest.approx(scan.times_s[index], abs=0.003)


class Turn:
    """What a Scan has that a message is made of: 0.05 s of it came, at 100 s."""

    def __init__(self, angles_q6, complete=False, frequency_hz=None):
        self._points = np.array([(angle_q6, 1000, 9, 0) for angle_q6 in angles_q6], POINT).tobytes()
        self.complete, self.frequency_hz = complete, frequency_hz
        self.start_s, self.end_s = 99.95, 100.0

    def __len__(self):
        return len(self._points) // POINT.itemsize


@pytest.mark.parametrize("turn, takes_s, stamp_s", [
    pytest.param(*row, id=claim) for claim, row in {
        "a_complete_turn_ends_with_its_scan": (Turn(range(0, 23040, 36), True, 6.0), 0.16, 100),
        "one_of_unknown_frequency_takes_as_long_as_its_points": (Turn(range(0, 23040, 36), True), 0.16, 100),
        "one_that_breaks_off_takes_as_long_as_the_lidar_reports": (Turn([0, 36], False, 6.0), 0.167, 100.117),
    }.items()])
def test_a_message_knows_the_time_of_its_turn(turn, takes_s, stamp_s):
    rays = Laser(360, upside_down=False).convert(turn)
    assert (rays.scan_time, rays.stamp_s) == (pytest.approx(takes_s, abs=1e-6), pytest.approx(stamp_s, abs=1e-6))


@pytest.mark.parametrize("upside_down", [False, True], ids=["upright", "upside_down"])
@pytest.mark.parametrize("angle_q6", [0, 1, 5760, 23039])
def test_a_message_has_each_point_at_its_angle(angle_q6, upside_down):
    rays = Laser(360 * 64, upside_down=upside_down).convert(Turn([angle_q6]))
    (ray,) = np.flatnonzero(np.isfinite(rays.ranges))
    assert round(math.degrees(rays.angle_min + ray * rays.angle_increment) * 64) % 23040 == -angle_q6 % 23040


@pytest.mark.parametrize("rays", [2, 65534])
def test_a_message_has_the_wanted_number_of_rays_and_may_have_to_be_complete(run, room, rays):
    status, out, _ = run("mcap", RECORDING, room, "--rays", rays, "--complete")
    assert (status, out) == (0, f"{room}: 8 scans; 1 incomplete, left out\n")
    assert [len(message.ranges) for _, message in messages_in(room)] == 8 * [rays]


def test_a_file_is_not_overwritten_unless_asked_and_not_made_from_nothing(run, room, tmp_path):
    room.write_bytes(b"mine")
    status, _, error = run("mcap", RECORDING, room)
    assert (status, room.read_bytes()) == (1, b"mine") and "--force overwrites it" in error
    assert run("mcap", RECORDING, room, "--force")[0] == 0
    assert room.stat().st_size > 5000
    (tmp_path / "letter").write_bytes(b"Dear lidar,")
    assert run("mcap", tmp_path / "letter", tmp_path / "letter.mcap")[0] == 1
    assert not (tmp_path / "letter.mcap").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_a_live_file_and_stops_the_lidar(command, simulator, room, number):
    begun = time.time()
    process = command("mcap", simulator.start(), room, first="import tmini._mcap as mcap; of = mcap.message_of; "
                      "mcap.message_of = lambda *of_scan: print('message', flush=True) or of(*of_scan)")
    for _ in range(3):
        assert process.stdout.readline() == "message\n"
    process.send_signal(number)
    out, error = process.communicate(timeout=60)
    assert (process.returncode, error) == (0, "") and "incomplete" in out
    simulator.await_idle()
    stamps = [stamp for stamp, _ in messages_in(room)]
    assert len(stamps) >= 2 and begun < stamps[0] < stamps[-1] < time.time()


@pytest.mark.parametrize("seconds, longest, remarks", [
    (None, 3, REMARKS), (60, 3, REMARKS), (2, 2, "")], ids=["ever", "a_minute", "briefly"])
def test_missing_scans_are_remarked_once_after_three_seconds(capsys, monkeypatch, seconds, longest, remarks):
    scans, waits = ["one", None, None, "two", "three"], []
    monkeypatch.setattr(tmini._command, "time", SimpleNamespace(monotonic=lambda: 100.0))

    def read(timeout):
        waits.append(timeout)
        return scans.pop(0)

    lidar = SimpleNamespace(port="x", read=read)
    assert list(itertools.islice(scans_of(lidar, seconds), 3)) == ["one", "two", "three"]
    assert capsys.readouterr().err == remarks
    assert waits == [longest] * 5


def test_foxglove_gets_each_scan(command, simulator):
    """By a client that knows Foxglove's protocol and nothing of the package's libraries."""
    pytest.importorskip("foxglove")
    connect = pytest.importorskip("websockets.sync.client").connect
    begun = time.time()
    process = command("live", simulator.start(), "--tcp", "0")
    with connect(process.stdout.readline().strip(), subprotocols=["foxglove.sdk.v1"]) as client:
        while not (channels := json.loads(client.recv(60)).get("channels")):
            pass
        (channel,) = channels
        assert (channel["topic"], channel["encoding"], channel["schemaName"]) == (
            "/scan", "protobuf", "foxglove.LaserScan")
        client.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": 7, "channelId": channel["id"]}]}))
        before, seen = None, 0
        for _ in range(60):
            data = client.recv(60)
            while isinstance(data, str):
                data = client.recv(60)
            assert struct.unpack_from("<BI", data) == (1, 7)
            fields = protobuf(data[13:])
            ranges = np.frombuffer(fields[6], "<f8")
            assert (fields[2], len(ranges), len(fields[7])) == (b"laser", 360, 8 * 360)
            assert 4 not in fields  # start_angle: the default, 0.
            assert struct.unpack("<d", fields[5])[0] == pytest.approx(math.radians(359))
            if np.isnan(ranges[[90, 180]]).any():
                continue  # A part of a turn, on a busy computer.
            # 2.2 m to the left wall, 1.7 m to the one behind; counter-clockwise.
            assert ranges[[90, 180]] == pytest.approx([2.2, 1.7], abs=0.05)
            stamp = protobuf(fields[1])
            assert begun < stamp[1] + stamp[2] / 1e9 < time.time()
            assert before != stamp
            before, seen = stamp, seen + 1
            if seen == 3:
                break
        assert seen == 3
    process.send_signal(signal.SIGTERM)
    assert process.wait(60) == 0
    simulator.await_idle()


def protobuf(data):
    """The last value of each field: numbers of varints, bytes of all else."""
    fields, stream = {}, io.BytesIO(data)

    def varint():
        (byte,) = stream.read(1)
        return byte if byte < 128 else (byte & 127) + 128 * varint()

    while stream.tell() < len(data):
        field, kind = divmod(varint(), 8)
        fields[field] = varint() if kind == 0 else stream.read(8 if kind == 1 else varint())
    return fields


@pytest.mark.parametrize("words, package, extra", [
    ("live COM3", "foxglove", "foxglove"), ("mcap COM3 x", "mcap_ros2.writer", "mcap"),
    ("serve COM3", "websockets.asyncio.server", "serve")])
def test_without_its_extra_a_command_names_the_line_that_installs_it(run, monkeypatch, words, package, extra):
    monkeypatch.setitem(sys.modules, package, None)
    status, _, error = run(*words.split())
    assert status == 1 and f"pip install './port/python[{extra}]'" in error


@pytest.mark.parametrize("words, said", [
    ("", "required: COMMAND"), ("dance", "invalid choice: 'dance'"), ("mcap", "required: SOURCE, FILE"),
    ("mcap x y --rays 7", "invalid _even value: '7'"), ("mcap x y --rays 0", "invalid _even value: '0'"),
    ("mcap x y --rays 65536", "invalid _even value: '65536'"),
    ("mcap x y --mask 10", "invalid _arc value: '10'")])
def test_wrong_words_are_answered_in_a_sentence(run, words, said):
    status, _, error = run(*words.split())
    assert status == 2 and said in error


def test_defaults_are_those_that_the_help_names():
    commands = _parser()._subparsers._group_actions[0].choices.values()
    pairs = [(str(action.default), re.search(r"default: (.*)\)", action.help)[1]) for command in commands
             for action in command._actions if "default: " in action.help]
    assert len(pairs) == 5 and all(is_value == said for is_value, said in pairs)


def test_a_lidar_that_is_not_there_is_answered_in_a_sentence(run, tmp_path):
    pytest.importorskip("foxglove")
    status, _, error = run("live", tmp_path / "nothing", "--tcp", 0)
    assert status == 1 and error.startswith("tmini: ")


def test_hours_of_recording_become_a_file_in_constant_memory(command, room, tmp_path):
    resource = pytest.importorskip("resource")
    peaks, path = [], tmp_path / "hours.bin"
    for seconds in (20, 120):
        subprocess.run([SIM, "--write", path, "--seconds", str(seconds), "--frequency", "12"], check=True)
        assert command("mcap", path, room, "--force").wait(60) == 0
        peaks.append(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
    assert peaks[1] < peaks[0] + 8192  # In kB.


def test_a_turn_of_unknown_frequency_becomes_a_message(run, room, tmp_path):
    path, samples = tmp_path / "turn.bin", 3 * [(1000, 9, 0)]
    path.write_bytes(packet(samples[:1], 0, 0, ct=1) + packet(samples, 90 * 64, 270 * 64))
    assert [scan.frequency_hz for scan in tmini.read(path)] == [None]
    assert run("mcap", path, room)[0] == 0
    ((_, message),) = messages_in(room)
    assert [message.ranges[ray] for ray in (0, 90, 180, 270)] == 4 * [1]
