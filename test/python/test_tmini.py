# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The Python package, compared with `tmini decode` and used with the simulated lidar."""

import copy
import inspect
import json
import os
import pickle
import random
import re
import signal
import socket
import subprocess
import sys
import termios
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import tmini
from conftest import RECORDINGS, ROOT, SIM, TOOL, wait_until
from lidar_bytes import damaged, timed


# ------------------------------------------------------------------------------------- recordings


def decode(path, *options):
    """The scans that the tool decodes, as JSON objects."""
    result = subprocess.run([TOOL, "decode", "-q", "--json", *options, path], capture_output=True, check=False)
    return [json.loads(line) for line in result.stdout.splitlines()]


def as_json(scan):
    millimetres = np.nan_to_num(scan.ranges_m * 1000).round().astype(int)
    return {
        "scan": scan.number, "time_ms": round(scan.start_s * 1000),
        "frequency_hz": scan.frequency_hz, "complete": scan.complete, "packets": scan.packets,
        "gaps": scan.gaps, "dropped": scan.dropped, "checksum_errors": scan.checksum_errors, "faults": scan.faults,
        "points": [list(point) for point in zip(scan.angles_deg.tolist(), millimetres.tolist(),
                                                scan.intensities.tolist(), scan.flags.tolist())],
    }


def chunked(content, version=2):
    """A recording as `tmini record` writes it: 100 bytes every 8 ms, and one pause of two seconds."""
    middle = len(content) // 200 * 100
    return timed(*((2_000_000 if at == middle else 8000, content[at:at + 100]) for at in range(0, len(content), 100)),
                 version=version)


@pytest.mark.parametrize("path", sorted(RECORDINGS.glob("*.bin")), ids=lambda path: path.stem)
def test_a_recording_holds_the_scans_that_the_tool_decodes(path, tmp_path):
    assert [as_json(scan) for scan in tmini.read(path)] == decode(path)
    for version in (1, 2):
        (tmp_path / "timed").write_bytes(chunked(path.read_bytes(), version))
        assert [as_json(scan) for scan in tmini.read(tmp_path / "timed")] == decode(tmp_path / "timed")


@pytest.mark.parametrize("dropped, said", [([500], "is damaged in 1 place: bytes"),
                                           ([500, 9000], "is damaged in 2 places: bytes")])
def test_damage_of_a_recording_is_reported_and_the_rest_read(dropped, said, tmp_path):
    path = tmp_path / "damaged.tmini"
    file = bytearray(chunked((RECORDINGS / "sim-6hz.bin").read_bytes()))
    for at in reversed(dropped):
        del file[at]
    path.write_bytes(file)
    with pytest.warns(RuntimeWarning, match=said) as warned:
        scans = list(tmini.read(path))
    assert warned[0].filename == __file__
    assert [as_json(scan) for scan in scans] == decode(path)


@pytest.mark.filterwarnings("ignore:.* is damaged in:RuntimeWarning")
@pytest.mark.parametrize("part", range(15))
def test_a_recording_with_random_damage_gives_what_the_tool_gives_or_an_error(tmp_path, part):
    """Each day other recordings, unless SEED is given."""
    path, content = tmp_path / "some", (RECORDINGS / "sim-6hz.bin").read_bytes()
    for number in range(20 * part, 20 * part + 20):
        seed = int(os.environ.get("SEED", time.strftime("%Y%m%d"))) * 1000 + number
        draw = random.Random(seed)
        cut = content[:draw.randint(10, 9000)]
        cut = draw.choice([cut, chunked(cut, 1), chunked(cut, 2)])  # The beginning that marks a timed one stays.
        path.write_bytes(cut[:8] + damaged(cut[8:], draw.randint(0, 20), seed))
        try:
            scans = [as_json(scan) for scan in tmini.read(path)]
        except ValueError as error:
            assert path.name in str(error), f"seed {seed}"
        else:
            assert scans == decode(path), f"seed {seed}"


def test_what_is_no_recording_of_a_lidar_is_reported(tmp_path):
    path = tmp_path / "letter.bin"
    for content, words in ((b"", "is empty"), (b"Dear lidar, ", "no lidar packet in 12 bytes"),
                           (b"\x89tmini\x03\n12345678", "is of version 3: too new")):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=words):
            list(tmini.read(path))


def test_angles_of_ros_count_the_other_way_round():
    scan = next(tmini.read(RECORDINGS / "sim-6hz.bin"))
    for degrees, radians in zip(scan.angles_deg, scan.angles_rad):
        turned = -degrees if degrees <= 180 else 360 - degrees
        assert radians == pytest.approx(turned * np.pi / 180, abs=1e-12)


def test_faults_are_those_of_the_protocol():
    assert [(fault.name, fault.value) for fault in tmini.Fault] == [  # Section 4, and the driver's own.
        ("SENSOR", 1), ("ENCODER", 2), ("WIRELESS_POWER", 4), ("PD", 8), ("LD", 16), ("DATA", 32), ("FREQUENCY", 64)]


def test_points_are_a_quarter_of_a_millisecond_apart():
    scan = list(tmini.read(RECORDINGS / "sim-6hz.bin"))[-2]
    assert np.median(np.diff(scan.times_s)) == pytest.approx(1 / 4000, rel=0.05)
    assert scan.times_s[0] >= scan.start_s and scan.times_s[-1] == pytest.approx(scan.end_s, abs=0.005)


def test_a_scan_comes_out_as_the_robot_sees_it():
    plain = next(tmini.read(RECORDINGS / "sim-6hz.bin"))
    turned = next(tmini.read(RECORDINGS / "sim-6hz.bin", front=87.5, upside_down=True, mask=[(-10, 10)]))
    assert np.array_equal(turned.angles_deg, (87.5 - plain.angles_deg) % 360)
    masked = (turned.angles_deg <= 10) | (turned.angles_deg >= 350)
    assert np.isnan(turned.ranges_m[masked]).all() and masked.any()
    assert np.array_equal(turned.ranges_m[~masked], plain.ranges_m[~masked], equal_nan=True)
    assert np.array_equal(turned.times_s, plain.times_s)
    longer = next(tmini.read(RECORDINGS / "sim-6hz.bin", offset_mm=69))
    assert np.allclose(longer.ranges_m, plain.ranges_m + 0.069, atol=1e-6, equal_nan=True)


def test_bins_and_sectors_hold_the_nearest_of_equal_parts_clockwise_from_the_front():
    scan = next(tmini.read(RECORDINGS / "sim-6hz.bin"))
    for count, parts in ((4, scan.sectors(4)), (360, scan.sectors(360))):
        part = np.floor(scan.angles_deg * count / 360 + 0.5) % count
        for i, sector in enumerate(parts):
            here = scan.ranges_m[part == i]
            assert (sector.points, sector.ranges) == (len(here), np.isfinite(here).sum())
            assert sector.is_blind == (sector.ranges == 0)
            if not sector.is_blind:
                assert sector.nearest_m == np.nanmin(here)
                assert scan.ranges_m[scan.angles_deg == sector.angle_deg][0] == sector.nearest_m
                assert sector.is_free(sector.nearest_m)
                assert not sector.is_free(sector.nearest_m + 0.001)
    assert scan.bins(4).tolist() == [sector.nearest_m for sector in scan.sectors(4)]
    assert scan.bins()[[90, 270]] == pytest.approx([2.8, 2.2], abs=0.03)  # Right and left wall.
    assert len(scan.bins()) == 360 and len(scan.sectors()) == 8
    assert np.nanmin(scan.ranges_m) == scan.bins(1) == np.nanmin(scan.bins(65535))
    assert repr(scan) == f"<tmini.Scan 1: {len(scan)} points, complete>"
    for wrong in (0, 65536):
        with pytest.raises(ValueError):
            scan.bins(wrong)


def test_a_blind_sector_is_not_free():
    scan = next(tmini.read(RECORDINGS / "sim-6hz.bin", mask=[(-45, 45)]))
    ahead = scan.sectors(4)[0]
    assert ahead.is_blind and not ahead.is_free(0.1)
    assert np.isnan([ahead.nearest_m, ahead.angle_deg, scan.bins(4)[0]]).all()


def test_a_scan_can_be_copied_and_sent_to_another_process():
    scan = next(tmini.read(RECORDINGS / "sim-6hz.bin"))
    assert len(scan.angles_deg) == len(scan)  # Also one whose arrays have been created.
    for other in (copy.copy(scan), copy.deepcopy(scan), pickle.loads(pickle.dumps(scan))):
        assert as_json(other) == as_json(scan)
        assert np.array_equal(other.times_s, scan.times_s)
        assert other.sectors(9) == scan.sectors(9)


def test_a_recording_that_is_not_there_is_an_error():
    with pytest.raises(FileNotFoundError):
        next(tmini.read("nothing.tmini"))


# ------------------------------------------------------------------------------------ live lidars


def read_until(lidar, wish, seconds=60):
    """The first scan that the wish is true of."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        scan = lidar.read(30)
        if scan is not None and wish(scan):
            return scan
    pytest.fail("no such scan came")


def test_a_lidar_scans_at_the_frequency_wanted_and_is_stopped_in_the_end(simulator):
    begun = time.monotonic()
    with tmini.Lidar(simulator.start(), frequency_hz=10) as lidar:
        scan = read_until(lidar, lambda scan: scan.number >= 15 and scan.complete)
        assert {lidar.info} == {tmini.Info(151, "1.2", 1, "2026031700012345")}
        assert lidar.is_scanning
        assert lidar.faults == tmini.Fault(0)
    assert scan.frequency_hz == pytest.approx(10, abs=0.2)
    assert len(scan) == pytest.approx(400, abs=5)
    assert begun < scan.times_s[-1] < time.monotonic()
    # The lidar is 2.2 m from the left wall and 1.7 m from the wall behind it.
    for degrees, metres in ((270, 2.2), (180, 1.7)):
        near = np.abs(scan.angles_deg - degrees) < 2
        assert np.nanmedian(scan.ranges_m[near]) == pytest.approx(metres, abs=0.02)
    assert lidar.read() is None
    simulator.await_idle()


def test_after_the_cable_was_out_it_goes_on(simulator):
    with tmini.Lidar(simulator.start()) as lidar:
        assert lidar.read(30) is not None
        simulator.stop()
        wait_until(lambda: lidar.read(0.1) is None and lidar.counters["losses"] == 1)  # Noticed while it is out.
        assert not lidar.is_scanning
        simulator.start()
        assert lidar.read(30) is not None and lidar.counters["losses"] == 1


def test_a_lidar_can_be_stopped_and_started_and_set(simulator):
    with tmini.Lidar(simulator.start(), backlog=50) as lidar:
        lidar.set_frequency(9.96)
        scan = read_until(lidar, lambda scan: scan.frequency_hz and abs(scan.frequency_hz - 10) < 0.2)
        assert 0.08 < scan.period_s < 0.11
        assert lidar.scan_age_s < 3
        wait_until(lambda waiting=lidar.counters["scans"] + 1: lidar.counters["scans"] > waiting)
        lidar.stop()
        assert lidar.read() is None and list(lidar) == []
        simulator.await_idle()
        wait_until(lambda: not lidar.is_scanning and lidar.scan_age_s > 0.4)
        begun = time.monotonic()
        lidar.start()
        assert lidar.read(30).start_s > begun
        for wrong in (5.9, 13):
            with pytest.raises(ValueError):
                lidar.set_frequency(wrong)
    for wish in (lidar.start, lidar.stop, lambda: lidar.set_frequency(8)):
        with pytest.raises(tmini.LidarError, match="is closed"):
            wish()


def test_a_listener_sends_nothing(simulator):
    with tmini.Lidar(simulator.start(), listen_only=True, timeout=None) as lidar:
        assert lidar.read(0.5) is None
        with pytest.raises(tmini.LidarError, match="sends nothing"):
            lidar.set_frequency(8)
    assert "command" not in simulator.log.read_text()


def test_an_error_of_the_terminal_while_the_cable_is_plugged_in_is_survived(simulator, monkeypatch):
    failures = []

    def fail_once(*arguments, real=termios.tcsetattr):
        if failures:
            return real(*arguments)
        failures.append(arguments)
        raise termios.error(5, "Input/output error")

    with tmini.Lidar(simulator.start()) as lidar:
        simulator.stop()
        wait_until(lambda: not lidar.is_scanning)
        monkeypatch.setattr(termios, "tcsetattr", fail_once)
        begun = time.monotonic()
        simulator.start()
        assert read_until(lidar, lambda scan: scan.start_s > begun) and failures


def test_after_a_fork_the_lidar_is_the_parents(simulator):
    """A fork while another thread holds the lock would leave it locked in the child for ever."""
    port = simulator.start()
    with tmini.Lidar(port) as lidar:
        locked, forked = threading.Event(), threading.Event()

        def hold():
            with lidar._changed:
                locked.set()
                forked.wait()

        threading.Thread(target=hold).start()
        locked.wait()
        child = os.fork()
        if child == 0:
            signal.alarm(30)  # Ends a child that hangs.
            try:
                lidar.read()
            except tmini.LidarError as error:
                lidar.close()
                has_port = any(os.path.realpath(fd) == os.path.realpath(port) for fd in Path("/proc/self/fd").iterdir())
                os._exit(0 if "only the process that opened" in str(error) and not has_port else 1)
            os._exit(2)
        forked.set()
        assert os.waitpid(child, 0)[1] == 0
        number = lidar.read(30).number
        assert read_until(lidar, lambda scan: scan.number > number + 2)
        assert lidar.counters["losses"] == 0


def test_a_port_has_one_user_and_is_free_afterwards(simulator):
    port = simulator.start()
    with tmini.Lidar(port), pytest.raises(OSError):
        tmini.Lidar(port)
    with tmini.Lidar(port) as lidar:
        assert lidar.read(30).number == 1


@pytest.mark.parametrize("end", ["sys.exit()", "raise ValueError",
                                 "os.kill(os.getpid(), signal.SIGTERM)\nlidar.read(5)",
                                 "os.kill(os.getpid(), signal.SIGHUP)\nlidar.read(5)"])
def test_however_a_program_ends_the_lidar_stops(simulator, end):
    """A signal needs the lines of the README."""
    readme = (ROOT / "port" / "python" / "README.md").read_text()
    lines = next(code for code in re.findall("```python\n(.*?)```", readme, re.DOTALL) if "SIGTERM" in code)
    program = f"{lines}\nimport os, tmini\nlidar = tmini.Lidar(sys.argv[1])\nlidar.read(1)\n{end}"
    subprocess.run([sys.executable, "-c", program, simulator.start()], stderr=subprocess.DEVNULL, timeout=60,
                   check=False)
    simulator.await_idle()


def played(monkeypatch, *connections, count):
    """The first scans of lines that deliver these (milliseconds that pass meanwhile, bytes), then are gone."""
    clock, connections = [100.0], list(map(iter, connections))

    def read(line):
        for passed_ms, data in line:
            clock[0] += passed_ms / 1000
            return data
        raise OSError

    def open_line(_):
        if not connections:
            raise OSError
        line = connections.pop(0)
        return SimpleNamespace(read=lambda: [read(line)], close=lambda: None, is_timed=False, now_us=now_us)

    def now_us():
        return round(clock[0] * 1e6)

    monkeypatch.setattr(tmini._lidar, "open_line", open_line)
    monkeypatch.setattr(tmini._lidar, "now_us", now_us)
    monkeypatch.setattr(tmini._lidar, "time", SimpleNamespace(
        monotonic=lambda: clock[0], sleep=lambda _: time.sleep(0.001)))
    with tmini.Lidar("x", listen_only=True, backlog=99, timeout=None) as lidar, lidar._changed:
        lidar._changed.wait_for(lambda: len(lidar._scans) >= count, 30)
        return list(lidar._scans)


def paced(data):
    return [(10, data[at:at + 130]) for at in range(0, len(data), 130)]


def test_bytes_that_waited_while_the_program_was_busy_cost_no_scan(monkeypatch):
    content = (RECORDINGS / "sim-6hz.bin").read_bytes()
    line = paced(content[:4000]) + [(1500, b""), (10, content[4000:])]  # More than is fed at once.
    assert [scan.complete for scan in played(monkeypatch, line, count=8)] == [True] * 8


@pytest.mark.parametrize("is_reported", [False, True])
def test_no_scan_continues_after_a_loss(monkeypatch, is_reported):
    """A turn is missing: between two connections, or in a stream that reports it."""
    content = (RECORDINGS / "sim-10hz-plain.bin").read_bytes()
    starts = [found.start() for found in re.finditer(rb"\xaa\x55[\x01-\xff]\x01(?=.{9}\xaa\x55)", content, re.DOTALL)]
    middle = [content.index(b"\xaa\x55\x00", begin + 500) for begin in starts[:5]]
    before, after = paced(content[starts[1]:middle[2]]), paced(content[middle[3]:starts[5] + 13])
    scans = played(monkeypatch, *([before + [(0, None)] + after] if is_reported else [before, after]), count=4)
    assert [scan.complete for scan in scans] == [True, False, False, True]
    assert sum(scan.packets for scan in scans) == 39  # All, to the first byte after the loss.


@pytest.mark.parametrize("backlog", [1, 20])
def test_a_program_gets_the_newest_scan_or_all_that_its_backlog_keeps(simulator, backlog):
    with tmini.Lidar(simulator.start(), backlog=backlog) as lidar:
        first = lidar.read(30).number
        while (newest := lidar.counters["scans"]) < first + 3:
            time.sleep(0.01)
        number = lidar.read(30).number
        if backlog == 1:
            assert number >= newest
        else:
            assert [first, number, lidar.read(30).number] == [1, 2, 3]


def test_a_connection_that_brings_nothing_is_made_again(monkeypatch):
    monkeypatch.setattr(tmini._line, "now_us", lambda: time.monotonic_ns() // 100)  # Ten times as fast.
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(60)
        with tmini.Lidar(f"tcp:127.0.0.1:{server.getsockname()[1]}", timeout=None):
            with server.accept()[0], server.accept()[0]:
                pass


def test_a_socket_that_takes_nothing_now_is_no_error():
    with socket.create_server(("127.0.0.1", 0)) as server:
        line = tmini._line.open_line(f"tcp:127.0.0.1:{server.getsockname()[1]}")
        while line.write(bytes(65536)):
            pass
        line.close()


def test_what_the_lidar_reports_is_in_each_scan(simulator):
    with tmini.Lidar(simulator.start("--covered")) as lidar:
        for scan in lidar:
            if scan.faults:
                break
    assert scan.faults == tmini.Fault.DATA
    assert np.isnan(scan.ranges_m).all()


def test_a_silent_line_is_an_error_that_says_what_to_look_at():
    _, device = os.openpty()
    for _ in range(2):  # The port is closed again.
        with pytest.raises(tmini.LidarError, match="not one byte"):
            tmini.Lidar(os.ttyname(device), timeout=0.5)
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("tmini ")]


@pytest.mark.parametrize("options, words", [
    (("--samples", "4"), r"packets come at \d+ per second, all with wrong checksums; they fit four-byte samples: "
     r"perhaps a T-mini Plus SH \(another YDLIDAR\), which this version does not read"),
    (("--samples", "2"), r"packets come at \d+ per second, all with wrong checksums; they fit two-byte samples: "
     "another YDLIDAR, which this version does not read"),
    (("--bridge", "seven"), "no byte is above 7F"),
])
def test_whoever_gets_no_scans_is_told_the_reason_in_the_words_of_the_tool(simulator, options, words):
    with tmini.Lidar(simulator.start(*options), timeout=None) as lidar:
        wait_until(lambda: re.search(words, lidar._trouble()))


def test_a_lidar_on_a_socket_that_still_boots_is_waited_for(simulator):
    with tmini.Lidar("tcp:" + os.readlink(simulator.start("--boot", "2.5", line="--tcp 0"))) as lidar:
        assert lidar.read(30) is not None


def test_unless_asked_a_lidar_keeps_the_newest_scan_as_it_sees_it():
    parameters = inspect.signature(tmini.Lidar).parameters
    assert [parameters[name].default for name in ("front", "offset_mm", "backlog")] == [0, 0, 1]


def test_a_port_has_the_lidars_baud_rate():
    _, device = os.openpty()
    tmini._line.open_line(os.ttyname(device)).close()
    assert termios.tcgetattr(device)[4:6] == [termios.B230400] * 2


def test_a_port_that_is_not_there_is_an_error_or_waited_for(simulator):
    with pytest.raises(OSError):
        tmini.Lidar(simulator.port)
    with tmini.Lidar(simulator.port, timeout=None) as lidar:
        assert lidar.read(0.1) is None
        simulator.start()
        assert lidar.read(30) is not None


@pytest.mark.parametrize("arguments, options, error, words", [
    (("x", 5.96), {}, ValueError, "6 to 12, not 5.96"), (("x", 12.1), {}, ValueError, "6 to 12, not 12.1"),
    (("x", float("nan")), {}, ValueError, "6 to 12, not nan"),
    (("x", 230400), {}, ValueError, "the baud rate is always 230400"),
    (("x", "10"), {}, TypeError, "a number of 6 to 12, not '10'"),
    ((None,), {}, TypeError, 'such as "/dev/ttyUSB0", not None'), (("x",), {"backlog": 0}, ValueError, "1 or more"),
    (("x", 10), {"listen_only": True}, ValueError, "cannot set frequency_hz"),
    (("tcp:robot",), {}, ValueError, "is tcp:HOST:PORT"),
])
def test_wrong_arguments_are_refused_in_words(arguments, options, error, words):
    with pytest.raises(error, match=words):
        tmini.Lidar(*arguments, **options)
