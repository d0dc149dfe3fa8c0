# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""A timed stream at tcp:HOST:PORT: the bytes come late, and have the times at which the sender received them."""

import json
import signal
import socket
from pathlib import Path

import pytest
from conftest import TMINI_SIM
from lidar_bytes import MAGIC, chunks

CHUNK_MS = 10


class Sender:
    """Accepts one listener after another, and sends what a lidar sends, with times."""

    def __init__(self, clock):
        self.clock = clock
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.port = f"tcp:127.0.0.1:{self.socket.getsockname()[1]}"
        self.listener = None
        self.heard = b""

    def accept(self):
        """A listener that hears nothing may have connected more than once."""
        while self.clock.wait([self.socket.fileno()], -1 if self.listener is None else 0):
            self.listener = self.socket.accept()[0]
        self.listener.sendall(MAGIC)

    def send(self, content, run, stall_ms=0):
        """Sends as fast as a lidar, to the program `run`, and reads what that prints. In each second nothing passes for
        `stall_ms`."""
        late = b""
        for i, one in enumerate(chunks(content)):
            until = self.clock.now_ms() + CHUNK_MS
            while self.clock.now_ms() < until:
                assert run.read_some(until - self.clock.now_ms())
            late += one
            if (i * CHUNK_MS + 500) % 1000 >= stall_ms:
                self.listener.sendall(late)
                late = b""
        self.listener.sendall(late)

    def leave(self):
        """Ends the connection; notes what the listener has sent."""
        self.listener.setblocking(False)
        try:
            self.heard += self.listener.recv(1000)
        except BlockingIOError:
            pass
        self.listener.close()
        self.listener = None


@pytest.fixture
def sender(clock):
    one = Sender(clock)
    yield one
    one.socket.close()


@pytest.fixture
def room(start):
    """20 s of a lidar."""
    return start("--write", "-", "--seconds", "21", program=TMINI_SIM).finish().raw_out[:20 * 13100]


def complete_scans(text):
    """The complete scans: their times, by their points."""
    scans = [json.loads(line) for line in text.splitlines()]
    return {str(scan["points"]): scan["time_ms"] for scan in scans if scan["complete"]}


def test_stalls_of_half_a_second_in_each_second_spoil_neither_scans_nor_times(sender, room, start, tmini):
    run = start("scan", "-p", sender.port, "--json")
    sender.accept()
    sender.send(room, run, 500)
    sender.leave()
    seen = complete_scans(run.finish().out)
    assert "has gone: the other end closed the connection" in run.err
    assert sender.heard == b""
    Path("room.tmini").write_bytes(MAGIC + b"".join(chunks(room)))
    truth = complete_scans(tmini("decode", "room.tmini", "--json").out)
    assert len(seen) >= 0.99 * len(truth) and len(truth) > 110
    delays = [seen[scan] - truth[scan] for scan in seen][6:]  # From when a chunk has come without delay.
    assert max(delays) - min(delays) <= 25


def test_a_recording_of_it_has_the_senders_times(sender, room, start, tmini):
    run = start("record", "-p", sender.port, "room.tmini")
    sender.accept()
    sender.send(room[:5 * 13100], run, 500)
    assert run.end(signal.SIGINT).status == 0
    sender.leave()
    rows = tmini("decode", "room.tmini", "--csv").out.splitlines()[1:]
    times = sorted({int(row.split(",")[7]) for row in rows})
    assert max(after - before for before, after in zip(times[60:], times[61:])) <= 30


def test_it_takes_no_commands(sender, start):
    for words in (("info",), ("frequency", "8"), ("survey",)):
        run = start(*words, "-p", sender.port)
        sender.accept()
        run.finish()
        assert (run.status, run.out) == (1, "")
        assert f"{sender.port} sends what a lidar sends, with times, and takes no commands" in run.err
        sender.leave()
    assert sender.heard == b""


def test_each_connection_is_judged_anew(sender, room, start):
    run = start("scan", "-p", sender.port, "--json", "--wait")
    sender.accept()
    sender.send(room[:3 * 13100], run)
    sender.leave()
    run.wait_for("is not there; waiting for it")
    before = run.out.count("\n")
    sender.accept()
    sender.send(room[:3 * 13100], run)
    sender.leave()
    run.wait_until(lambda: run.out.count("\n") >= before + 15)
    assert run.end(signal.SIGINT).status == 0
    assert sender.heard == b""


def test_a_link_that_is_dead_is_lost(sender, room, start, clock):
    run = start("scan", "-p", sender.port, "--json")
    sender.accept()
    sender.send(room[:3 * 13100], run)
    begun_ms = clock.now_ms()
    run.wait_for("the lidar has fallen silent")
    assert 1000 <= clock.now_ms() - begun_ms <= 2000
    sender.leave()
