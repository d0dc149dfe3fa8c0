# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The bridge on a PC, between the simulated lidar and listeners that are well, slow, dead and hostile."""

import json
import os
import re
import signal
import socket
from pathlib import Path

import pytest
from conftest import plug_in
from lidar_bytes import MAGIC

BRIDGE = os.environ["TMINI_BRIDGE"]


@pytest.fixture
def bridge(lidar, start):
    """bridge(): the program; `device` is its lidar, plugged in as "adapter"; `port` is for listeners."""
    def begin(*words):
        device = lidar()
        plug_in(device.port)
        one = start(*words, "adapter", "0", program=BRIDGE)
        one.device = device
        one.wait_for("tcp:")
        one.port = one.out.strip()
        return one
    return begin


@pytest.fixture
def listen():
    """A listener of which the system takes as little as it can."""
    listeners = []

    def begin(bridge, host="127.0.0.1"):
        listener = socket.socket()
        listeners.append(listener)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        listener.connect((host, int(bridge.port.rpartition(":")[2])))
        return listener
    yield begin
    for listener in listeners:
        listener.close()


def receive(clock, listener, size):
    """Receives `size` bytes; fewer if the bridge leaves."""
    content = b""
    while len(content) < size:
        clock.wait([listener.fileno()])
        try:
            more = listener.recv(size - len(content))
        except ConnectionResetError:
            more = b""
        if not more:
            break
        content += more
    return content


def whole_chunks(content):
    """Without the last chunk, which receive() may have cut in its head: that would be damage."""
    end = len(MAGIC)
    while True:
        size = 10 + int.from_bytes(content[end + 6:end + 8], "little")
        if end + size > len(content):
            return content[:end]
        end += size


def counts(tmini, content):
    """What the tool finds in a timed stream."""
    Path("heard.tmini").write_bytes(content)
    run = tmini("decode", "heard.tmini", "--stats", "stats.json")
    return json.loads(Path("stats.json").read_text(encoding="ascii")), run.out + run.err


def test_the_tool_sees_the_room_and_the_lidar_rests_when_nobody_listens(bridge, tmini):
    one = bridge("-f", "8")
    assert "command A5 60" not in one.device.log
    run = tmini("scan", "-p", one.port, "-n", "5", "--json")
    scans = [json.loads(line) for line in run.out.splitlines()]
    assert run.status == 0
    assert [scan["complete"] for scan in scans] == [True] * 5
    assert 7.8 < scans[-1]["frequency_hz"] < 8.2
    one.device.wait_for_log("stopping -> idle")
    assert one.end(signal.SIGTERM).status == 0


def test_a_lidar_that_scans_is_stopped_when_the_bridge_ends(bridge, listen, clock):
    one = bridge()
    receive(clock, listen(one), 20000)
    assert one.end(signal.SIGHUP).status == 0
    one.device.wait_for_log("stopping -> idle")


def test_a_slow_listener_is_told_what_it_lost_and_the_others_lose_nothing(bridge, listen, clock, tmini):
    one = bridge()
    slow, well = listen(one), listen(one)
    content = receive(clock, well, 140000)
    receive(clock, slow, 1)
    slow_content = MAGIC[:1] + receive(clock, slow, 150000)  # More than had come, so some places of loss.
    stats, text = counts(tmini, whole_chunks(content))
    assert (stats["checksum_errors"], "damaged" in text) == (0, False)
    stats, text = counts(tmini, slow_content)
    places = int(re.search(r"damaged in (\d+) place", text)[1])
    assert stats["packets"] > 500
    assert stats["checksum_errors"] <= places  # One packet is cut at each.


def test_a_listener_that_takes_nothing_for_15_s_is_left(bridge, listen, clock):
    one = bridge()
    dead = listen(one)
    one.device.wait_for_log("idle -> scanning")
    clock.sleep(22000)
    one.device.wait_for_log("stopping -> idle")
    assert len(receive(clock, dead, 10**9)) < 5 * 13100  # What the system had taken, then the end.


def test_who_sends_something_is_left_and_the_lidar_hears_nothing_of_it(bridge, listen, clock):
    one = bridge()
    well = listen(one)
    for content in (b"\xA5\x40", b"GET / HTTP/1.1\r\n\r\n", b"\0" * 100000):
        hostile = listen(one)
        hostile.setblocking(False)
        hostile.send(content)
        hostile.setblocking(True)
        assert len(receive(clock, hostile, 10**6)) < 10**6
    assert len(receive(clock, well, 20000)) == 20000
    assert one.end().status == 0
    commands = {line.split("command ")[1][:5] for line in one.device.log.splitlines() if "command " in line}
    assert commands == {"A5 0D", "A5 60", "A5 65"}


def test_there_are_four_listeners_at_most(bridge, listen, clock):
    one = bridge()
    four = [listen(one) for _ in range(4)]
    assert receive(clock, listen(one), 1) == b""
    four.pop().close()
    clock.sleep(100)
    assert receive(clock, listen(one), 8) == MAGIC


def held(program):
    """(open files, kB of memory at most) of it."""
    process = Path(f"/proc/{program.process.pid}")
    return (len(list((process / "fd").iterdir())),
            int(re.search(r"VmHWM:\s*(\d+)", (process / "status").read_text(encoding="ascii"))[1]))


def test_200_strangers_cost_nothing_and_the_others_lose_nothing(bridge, listen, clock, tmini):
    one = bridge()
    well = listen(one)
    content = receive(clock, well, 40000)
    before = held(one)
    for i in range(200):
        stranger = listen(one)
        if i % 4 < 3:  # Half a request, garbage, much; or it goes at once.
            stranger.setblocking(False)
            stranger.send((b"GET / HTTP", b"\xA5\x65" * 100, bytes(100000))[i % 4])
            stranger.setblocking(True)
            receive(clock, stranger, 10**6)
        stranger.close()
        content += receive(clock, well, 500)
    content += receive(clock, well, 40000)
    stats, text = counts(tmini, whole_chunks(content))
    assert (stats["checksum_errors"], "damaged" in text) == (0, False)
    after = held(one)
    assert after[0] == before[0] and after[1] < before[1] + 100


def test_a_lidar_that_comes_back_goes_on_after_a_gap(lidar, bridge, listen, clock, tmini):
    one = bridge()
    listener = listen(one)
    content = receive(clock, listener, 20000)
    one.device.unplug()
    plug_in(None)
    one.wait_for("lost")
    plug_in(lidar().port)
    content += receive(clock, listener, 30000)
    stats, text = counts(tmini, content)
    assert "damaged in" in text
    assert stats["start_packets"] > 15


def test_it_is_on_the_loopback_interface_unless_asked(bridge, listen):
    with pytest.raises(ConnectionRefusedError):
        listen(bridge(), "127.0.0.2")
    listen(bridge("--all"), "127.0.0.2")


@pytest.mark.parametrize("words", ["", "--what x", "x 70000", "-f 13 x", "-f 5 x", "x 1 2", "-f"])
def test_wrong_usage_is_exit_status_2(start, words):
    run = start(*words.split(), program=BRIDGE).finish()
    assert run.status == 2
    assert run.err.startswith("usage: tmini-bridge ")
