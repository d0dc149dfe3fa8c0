# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The program tmini-sim from outside: usage, pseudo-terminal, socket, lines, recordings."""

import os
import re
import signal
import socket
import subprocess
import termios
from pathlib import Path

import pytest
from conftest import TMINI_SIM
from lidar_bytes import INFORMATION, decode

START, STOP, ASK_INFORMATION, ASK_FREQUENCY = b"\xA5\x60", b"\xA5\x65", b"\xA5\x90", b"\xA5\x0D"
SIX_HERTZ = bytes.fromhex("A55A0400000004 58020000")


@pytest.fixture
def sim(start):
    return lambda *words, **options: start(*words, program=TMINI_SIM, **options)


class Client:
    """One end of the line; commands go out, and what comes within 5 s is received."""

    def __init__(self, clock, port):
        self.clock, self.socket = clock, None
        if port.startswith("tcp:"):
            host, number = port[4:].split(":")
            self.socket = socket.create_connection((host, int(number)))
            self.fd = self.socket.fileno()
        else:
            self.fd = os.open(port, os.O_RDWR | os.O_NOCTTY)

    def send(self, command):
        assert os.write(self.fd, command) == len(command)

    def receive(self, wanted, timeout_ms=5000):
        received = b""
        while len(received) < wanted and self.clock.wait([self.fd], timeout_ms):
            received += (more := os.read(self.fd, wanted - len(received)))
            if not more:
                break
        return received

    def ask(self, command, reply):
        self.send(command)
        assert self.receive(len(reply)) == reply

    def close(self):
        if self.socket:
            self.socket.close()
        else:
            os.close(self.fd)


@pytest.fixture
def client(clock):
    return lambda port: Client(clock, port)


# ---- Usage


@pytest.mark.parametrize("words", [
    ["--help"], ["-h"], ["-V"], ["--vers"], ["--writ=/dev/null", "-s1"], ["--seco", "1", "--write", "/dev/null"]])
def test_options_may_be_short_joined_and_abbreviated(sim, words):
    assert sim(*words).finish().status == 0


@pytest.mark.parametrize("words", [
    "", "--what", "--pty --tcp 0", "--tcp", "--tcp 70000", "--pty --frequency fast", "--pty --fault drop",
    "--pty --fault dropp=1e-4", "--pty --fault drop=2", "--pty --seed -1", "--pty --health ill", "--write /dev/null",
    "--pty=yes", "--pty word", "--s 1",  # --samples, --seed, --seconds, --speed, --spin-up
    "--pty --bridge x", "--pty --begin x", "--write - --seconds 1 --log", "--lines --pty", "--lines --log -"])
def test_wrong_usage_is_exit_status_2(sim, words):
    run = sim(*words.split()).finish()
    assert run.status == 2 and run.err.startswith("tmini-sim: ")


def test_numbers_have_the_limits_that_the_help_names(sim):
    texts = re.split(r"^ +(?:-., )?--", sim("--help").finish().out, flags=re.MULTILINE)
    limits = [(text.split()[0], *found.groups()) for text in texts
              if (found := re.search(r"(-?[\d.]+) to (0x[\dA-F]+|[\d.]+)", text))]
    assert len(limits) == 8
    for name, low, high in limits:
        low, high = float(low), float(high) if "x" not in high else int(high, 0)
        for value, status in ((low, 0), (high, 0), (low - 0.0005, 2), (high + 0.01, 2)):
            run = sim("--write", "/dev/null", "--seconds=0.001", f"--{name}={value}").finish()
            assert run.status == status, f"--{name}={value}: {run.err}"


@pytest.mark.parametrize("words", [
    "--write / --seconds 1", "--write /dev/full --seconds 9", "--write /dev/null --seconds 1 --log /",
    "--write /dev/null --seconds 9 --log /dev/full", "--write /dev/null --seconds 1 --truth /"])
def test_a_file_that_cannot_be_written_is_exit_status_1(sim, words):
    assert sim(*words.split()).finish().status == 1


# The distance to what stands at these angles, in mm.
ROOM = {0: 2300, 12: 2351, 38: 5457, 76: 2886, 82: 0, 90: 2800, 143: 1000, 180: 1700, 218: 1045, 270: 2200,
        312: 1345, 349: 1380}


def test_the_room_is_as_described(sim):
    assert sim("--write", "room.bin", "-s3", "--truth", "room.csv").finish().status == 0
    with open("room.csv", encoding="ascii") as file:
        samples = [[int(number) for number in line.split(",")] for line in list(file)[1:]]
    for angle, distance in ROOM.items():
        seen = [sample[4] for sample in samples if abs(sample[3] - 64 * angle) <= 16]
        assert distance - 40 <= sorted(seen)[len(seen) // 2] <= distance + 40, angle


# ---- Pseudo-terminal and socket


@pytest.mark.parametrize("options", [[], ["--tcp", "0"]], ids=["pty", "socket"])
def test_clients_are_served_one_after_another_without_echo(lidar, client, options):
    device = lidar(*options)
    for _ in range(3):
        one = client(device.port)
        one.ask(ASK_INFORMATION, INFORMATION)
        one.ask(ASK_FREQUENCY, SIX_HERTZ)
        assert one.receive(1, 100) == b""
        one.close()
    assert device.end(signal.SIGTERM).status == 0


def test_settings_of_a_client_do_not_affect_the_next_one(lidar, client, clock):
    device = lidar()
    one = client(device.port)
    settings = termios.tcgetattr(one.fd)
    settings[3] |= termios.ECHO | termios.ICANON
    termios.tcsetattr(one.fd, termios.TCSANOW, settings)
    clock.sleep(50)
    one.close()
    clock.sleep(200)
    client(device.port).ask(ASK_FREQUENCY, SIX_HERTZ)


def test_without_a_client_it_sleeps(lidar, clock):
    stat = Path(f"/proc/{lidar().process.pid}/stat")
    ticks = lambda: sum(map(int, stat.read_text(encoding="ascii").split(") ")[1].split()[11:13]))
    before = ticks()
    clock.sleep(1000)
    assert ticks() - before < 30  # 0.3 s of the processor.


def test_the_stream_goes_on_without_a_client_and_nothing_stale_is_kept(lidar, client, clock):
    device = lidar()
    one = client(device.port)
    one.send(START)
    clock.sleep(7000)
    assert decode(one.receive(80000))[1]["bytes_skipped"] < 200  # What it could not take yet has waited.
    one.close()
    clock.sleep(500)
    one = client(device.port)
    assert len(one.receive(3000)) == 3000
    one.send(STOP)
    one.close()
    clock.sleep(500)
    assert client(device.port).receive(1, 100) == b""


def test_its_own_input_is_no_client(sim, client):
    reader, writer = os.pipe()
    run = sim("--tcp", "0", stdin=reader)
    run.wait_for("\n")
    client("tcp:" + run.out.strip()).ask(ASK_FREQUENCY, SIX_HERTZ)
    os.close(reader), os.close(writer)


# On Linux all of 127.0.0.0/8 is this computer: who listens on every address has these, too.
def test_the_socket_is_that_of_the_loopback_interface_only(lidar):
    address, port = lidar("--tcp", "0").port[4:].split(":")
    assert address == "127.0.0.1"
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", int(port)))


def test_a_client_that_has_ended_its_sending_still_gets_its_reply(lidar, client):
    one = client(lidar("--tcp", "0").port)
    one.send(ASK_FREQUENCY)
    one.socket.shutdown(socket.SHUT_WR)
    assert one.receive(len(SIX_HERTZ)) == SIX_HERTZ


# 13 kB per virtual second; spin-up costs one of them.
def test_it_ends_after_the_virtual_seconds_given(lidar, client, clock):
    device = lidar("--tcp", "0", "--speed", "50", "--seconds", "50")
    begun = clock.now_ms()
    one = client(device.port)
    one.send(START)
    assert 600000 < len(one.receive(1000000)) < 660000
    assert device.finish().status == 0
    assert 990 <= clock.now_ms() - begun <= 1020


# ---- In the caller's time


# A reply takes 3 ms of latency and 43.4 us per byte: less than the 1 s and the 10 ms given.
def test_the_shared_clock_forgets_programs_that_have_ended(clock):
    for _ in range(100):  # More than it knows at once.
        with subprocess.Popen(["true"]) as program:
            program.wait()
        clock.expect(program.pid)


def test_lines_are_answered_in_the_callers_time(sim, folder):
    (folder / "questions").write_text("0 A590\n1000000\n1000000\n2000000 a50D\n2010000\n", encoding="ascii")
    with open("questions", "rb") as stdin:
        run = sim("--lines", stdin=stdin).finish()
    assert (run.status, run.out) == (0, f"\n{INFORMATION.hex().upper()}\n\n\n{SIX_HERTZ.hex().upper()}\n")


# ---- Recordings


def test_the_same_options_give_the_same_recording(sim):
    words = ["--write", "-", "--seconds", "20", "--fault", "drop=1e-4"]
    one, other, seeded = (sim(*words, *seed).finish().raw_out for seed in ([], [], ["--seed", "2"]))
    assert len(one) > 250000 and one == other != seeded


# 2 s less 3 ms of latency and 200 ms before the first sample, at 4000 per second.
def test_the_truth_has_a_row_per_sample(sim):
    assert sim("--write", "/dev/null", "--seconds", "2", "--truth", "truth.csv").finish().status == 0
    rows = Path("truth.csv").read_text(encoding="ascii").splitlines()
    assert rows[0] == "packet,revolution,index,angle_q6,distance_mm,intensity,flag,intact"
    assert rows[1].startswith("0,0,0,") and rows[-1].startswith("189,9,39,")
    assert 7108 < len(rows) < 7268


def test_the_log_has_commands_modes_faults_and_totals(lidar, client):
    device = lidar("--tcp", "0", "--fault", "flip=0.01")
    one = client(device.port)
    one.send(START)
    assert len(one.receive(1000)) == 1000
    for command in (ASK_FREQUENCY, b"\xA5\x77", STOP):
        one.send(command)
    device.wait_for_log("stopping -> idle")
    assert device.end(signal.SIGTERM).status == 0
    assert re.search(r"^0\.00\d{4} command A5 60 start\n\d+\.\d{6} mode idle", device.log, re.MULTILINE)
    for words in ("command A5 0D get frequency (forbidden while scanning)\n",
                  "command A5 77 unknown", "mode idle -> scanning\n", "mode stopping -> idle\n", "fault flip begins\n",
                  "3 commands, 1 forbidden while scanning, 1 unknown, "):
        assert words in device.log
