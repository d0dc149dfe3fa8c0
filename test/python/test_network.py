# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Timed streams, and `python -m tmini serve`."""

import asyncio
import contextlib
import http.client
import json
import pathlib
import re
import select
import socket
import struct
import subprocess
import time
from types import SimpleNamespace

import pytest

import tmini
from conftest import SIM, TOOL
from lidar_bytes import MAGIC, chunk, chunks


class Sender:
    """Sends 4 s of a lidar with its times to each listener; nothing passes for half of each second. Stands in for the
    modules socket, select and time: time passes while the lidar's thread sleeps."""
    IPPROTO_TCP = TCP_NODELAY = None

    def __init__(self):
        room = subprocess.run([SIM, "--write", "-", "--seconds", "5"], check=True, capture_output=True).stdout
        self.chunks = chunks(room[:400 * 131])
        self.now_s, self.heard, self.is_open = 1000.0, b"", False
        self.begun = []  # When each connection was.

    def monotonic(self):
        return self.now_s

    def monotonic_ns(self):
        return round(self.now_s * 1e9)

    def sleep(self, seconds):
        self.now_s += seconds
        time.sleep(0)

    def create_connection(self, *_):
        self.begun.append(self.now_s)
        self.waiting, self.is_open = [MAGIC, *self.chunks], True
        return self

    def setsockopt(self, *_): ...

    def setblocking(self, _): ...

    def select(self, sockets, *_):
        return sockets, [], []

    def recv(self, _):
        passed = min(len(self.chunks), round(100 * (self.now_s - self.begun[-1])))
        count = len(self.waiting) - len(self.chunks) + passed
        if self.waiting and (count <= 0 or 1 < passed < len(self.chunks) and passed % 100 < 50):
            raise BlockingIOError
        data, self.waiting = b"".join(self.waiting[:count]), self.waiting[count:]
        return data

    def send(self, data):
        self.heard += data
        return len(data)

    def close(self):
        self.is_open = False


@pytest.fixture
def sender(monkeypatch):
    one = Sender()
    for name in ("_line.socket", "_line.select", "_line.time", "_lidar.time"):
        monkeypatch.setattr(f"tmini.{name}", one)
    return one


def test_a_timed_stream_with_stalls_of_half_a_second_spoils_neither_scans_nor_times(sender, tmp_path):
    with tmini.Lidar("tcp:x:1", backlog=9999) as lidar:
        scans = [next(iter(lidar)) for _ in range(18)]  # Of the first connection.
        next(scan for scan in lidar if len(sender.begun) > 1 and scan.start_s > sender.begun[1])
    assert sender.begun[1] < sender.begun[0] + 4.6 and all(scan.complete for scan in scans)
    path = tmp_path / "room.tmini"
    path.write_bytes(MAGIC + b"".join(sender.chunks))
    truth = {scan.ranges_m.tobytes(): scan.start_s for scan in tmini.read(path)}
    delays = [scan.start_s - truth[scan.ranges_m.tobytes()] for scan in scans]
    assert max(delays) - min(delays) <= 0.025
    assert sender.heard == b""


def test_a_timed_stream_that_is_there_later_only_listens(sender, monkeypatch):
    opened, open_line = [], tmini._lidar.open_line

    def open_later(name):
        opened.append(name)
        if len(opened) < 3:
            raise OSError
        return open_line(name)

    monkeypatch.setattr(tmini._lidar, "open_line", open_later)
    with tmini.Lidar("tcp:x:1", 8, timeout=None, backlog=9999) as lidar:
        assert [lidar.read(1000).number for _ in range(16)] == list(range(1, 17))
        lidar.stop()
        lidar.start()
        next(scan for scan in lidar if len(sender.begun) > 4)
    # A driver that waited for replies would open the line again and again.
    assert all(after - before > 4 for before, after in zip(sender.begun[1:], sender.begun[2:]))
    assert sender.heard == b""


def test_a_timed_stream_takes_no_frequency(sender):
    with pytest.raises(tmini.LidarError, match="whose sender sets the frequency"):
        tmini.Lidar("tcp:x:1", frequency_hz=12)
    assert len(sender.begun) == 1 and not sender.is_open
    with tmini.Lidar("tcp:x:1") as lidar, pytest.raises(tmini.LidarError, match="sends nothing"):
        lidar.set_frequency(6)


# ---- serve


@pytest.fixture
def server(simulator, command):
    """(port number, process) of a server for the simulated lidar. If it runs until the end, it ends without a word."""
    pytest.importorskip("websockets")
    started = []

    def start(*words, lidar=None, first="pass"):
        started.append(command("serve", lidar or simulator.start(), "--tcp", 0, *words, first=first))
        return int(started[-1].stdout.readline().rpartition(":")[2]), started[-1]

    yield start
    for process in started:
        if process.poll() is None:
            process.terminate()
            assert (process.communicate(timeout=60)[1], process.returncode) == ("", 0)


def get(number, path, **headers):
    """(status, headers, body)."""
    connection = http.client.HTTPConnection("127.0.0.1", number, timeout=60)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    content = answer.status, dict(answer.getheaders()), answer.read()
    connection.close()
    return content


def listen(number, **options):
    client = pytest.importorskip("websockets.sync.client")
    return client.connect(f"ws://127.0.0.1:{number}/stream", compression=None, close_timeout=0.5, **options)


def receive(listener, size):
    content = b""
    while len(content) < size:
        content += listener.recv(60)
    return content


def test_a_browser_gets_the_page(server, tmp_path):
    page = tmp_path / "page.html"
    page.write_bytes(b"<p>the page")
    number, _ = server("--page", page)
    status, headers, _ = get(number, "/")
    assert (status, headers["Location"]) == (302, "/live")
    status, headers, body = get(number, "/live")
    assert (status, headers["Content-Type"], body) == (200, "text/html; charset=utf-8", b"<p>the page")
    assert (headers["X-Frame-Options"], headers["X-Content-Type-Options"]) == ("DENY", "nosniff")
    assert get(number, "/etc/passwd")[0] == 404


def test_the_page_comes_with_the_package(server):
    number, _ = server()
    assert b"<title>tmini viewer</title>" in get(number, "/live")[2]


def test_the_lidar_scans_while_somebody_listens_and_listeners_hear_all(server, simulator, tmp_path):
    number, _ = server("--frequency", 10)
    assert "start" not in simulator.log.read_text()
    begun = time.monotonic()
    with listen(number) as one:
        early = receive(one, 20000)
        with listen(number) as other:
            late = receive(other, 20000)
    took_ms = 1000 * (time.monotonic() - begun)
    path, stats = tmp_path / "heard.tmini", tmp_path / "stats.json"
    for content in (early, late):
        assert content[:8] == MAGIC
        path.write_bytes(content)
        rows = subprocess.run([TOOL, "decode", path, "--csv", "--stats", stats], check=True, capture_output=True,
                              text=True).stdout.splitlines()
        counts = json.loads(stats.read_text())
        assert counts["start_packets"] >= 10 and counts["checksum_errors"] == 0
    assert 1000 < int(rows[-1].split(",")[7]) - int(rows[1].split(",")[7]) < took_ms
    simulator.await_idle()


def test_a_lidar_that_still_scans_is_stopped_when_the_server_ends(server, simulator):
    # By Python's own handler it would end in the midst of anything.
    number, process = server(first="import os, signal; signal.default_int_handler = lambda *_: os._exit(3)")
    with listen(number) as one:
        receive(one, 2000)
        process.terminate()
        assert process.wait(60) == 0
    simulator.await_idle()


def test_another_page_or_name_gets_nothing(server):
    number, _ = server("--name", "robot.example")
    assert get(number, "/live", Host="evil.example")[0] == 403
    assert get(number, "/live", Host="localhost:1@evil.example")[0] == 403
    for name in ("robot.example", f"localhost:{number}", f"{socket.gethostname()}.local", "[::1]", "192.0.2.1:80"):
        assert get(number, "/live", Host=name)[0] == 200
    invalid = pytest.importorskip("websockets.exceptions").InvalidStatus
    for origin in ("http://evil.example", "null", f"http://127.0.0.1:{number + 1}", "http://localhost"):
        with pytest.raises(invalid, match="403"):
            listen(number, origin=origin)
    with listen(number, origin=f"http://127.0.0.1:{number}"):
        pass


def test_who_sends_something_is_left_and_the_lidar_hears_nothing_of_it(server, simulator, crowd):
    closed = pytest.importorskip("websockets.exceptions").ConnectionClosed
    number, _ = server()
    with listen(number) as one:
        receive(one, 2000)
        one.send(b"\xA5\x40")
        with pytest.raises(closed, match="1008 .*listeners send nothing"):
            receive(one, 1000000)
    begun = time.monotonic()
    rest(crowd(number, OPENING + b"\x81\x80" + bytes(4)))
    assert time.monotonic() - begun >= 1  # It may answer until then.
    with socket.create_connection(("127.0.0.1", number)) as stranger:
        stranger.sendall(b"\xA5\x40" * 10000)
    with listen(number) as one:
        receive(one, 2000)
    assert "A5 40" not in simulator.log.read_text()


@pytest.fixture
def crowd():
    """crowd(number, content): a stranger who sends that, as far as it is taken; the system receives little for it."""
    with contextlib.ExitStack() as stack:
        def join(number, content):
            one = stack.enter_context(socket.socket())
            one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            one.settimeout(20)
            one.connect(("127.0.0.1", number))
            with contextlib.suppress(ConnectionError):
                one.sendall(content)
            return one
        yield join


def rest(stranger, most=10**6):
    """How many bytes come until the server leaves."""
    size = 0
    with contextlib.suppress(ConnectionError):
        while (more := len(stranger.recv(4096))) > 0 and size < most:
            size += more
    return size


def memory_kb(process, name="VmHWM"):
    """The peak, unless another name is given."""
    status = pathlib.Path(f"/proc/{process.pid}/status")
    if not status.exists():
        pytest.skip("this system does not say how much memory a process takes")
    return int(re.search(rf"{name}:\s*(\d+)", status.read_text())[1])


OPENING = b"GET /stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" \
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
PING = b"\x89\xFD" + bytes(4 + 125)


def test_who_sends_much_is_left_and_takes_no_memory(server, crowd):
    number, process = server()
    with listen(number) as one:
        receive(one, 2000)
        before = memory_kb(process)
        for content in (b"GET /" + b"a" * 3000000,
                        b"GET / HTTP/1.1\r\n" + b"".join(b"X-%d: %s\r\n" % (i, b"a" * 8000) for i in range(400)),
                        bytes(range(256)) * 12000,
                        OPENING + b"\x82\xFF" + struct.pack(">Q", 10**8) + bytes(3000000),
                        OPENING + PING * 24000,
                        OPENING + (b"\x02\x80" + bytes(4)) * 500000):  # A message without an end.
            assert rest(crowd(number, content)) < 100000, content[-200:]
            receive(one, 2000)
        assert memory_kb(process) < before + 4096


def test_200_strangers_who_wait_cost_little_and_go(server, crowd):
    number, process = server()
    with listen(number) as one:
        receive(one, 2000)
        before = memory_kb(process)
        strangers = [crowd(number, content) for _ in range(50) for content in (
            b"", OPENING[:60], OPENING[:-2] + b"X: 1", b"GET /live HTTP/1.1\r\nHost: localhost\r\n\r\n")]
        assert memory_kb(process) < before + 12288
        receive(one, 80000)  # For six seconds.
        assert all(rest(stranger) < 200000 for stranger in strangers)
        with listen(number) as other:
            receive(other, 2000)


def test_listeners_that_take_nothing_or_come_and_go_cost_nothing_in_the_long_run(server, crowd):
    number, process = server(first="import tmini._serve; tmini._serve._DEAD_S = 1")
    with listen(number) as one:
        dead = crowd(number, OPENING)
        for i in range(700):
            if i == 200:  # Until then the memory settles.
                before = memory_kb(process)
            with crowd(number, OPENING) as guest:
                guest.recv(4096)
            while select.select([one.socket], [], [], 0)[0]:
                one.recv(10)
        assert memory_kb(process) < before + 512  # A kilobyte for each.
        # Until the dead one has filled what the system keeps for it, and a second longer.
        receive(one, 14000 * 8)
    assert rest(dead) < 200000


def test_there_are_eight_listeners_at_most(server):
    invalid = pytest.importorskip("websockets.exceptions").InvalidStatus
    number, _ = server()
    with contextlib.ExitStack() as stack:
        listeners = [stack.enter_context(listen(number)) for _ in range(8)]
        with pytest.raises(invalid, match="503"):
            listen(number)
        listeners.pop().close()
        receive(stack.enter_context(listen(number)), 2000)


def test_the_server_is_on_the_loopback_interface_unless_asked(server):
    number, _ = server()
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", number))  # Of this computer, too.
    number, process = server("--host", "0.0.0.0", lidar="nowhere")
    socket.create_connection(("127.0.0.2", number)).close()
    process.terminate()
    assert process.communicate()[1] == "everybody in the network can see the room\n"


def test_what_comes_when_the_server_has_ended_is_for_nobody():
    from tmini._serve import _Hub
    hub = _Hub(SimpleNamespace(), None)

    async def scenario():
        hub.begin()

    asyncio.run(scenario())
    hub._tap(1000, b"late")


def test_a_slow_listener_loses_all_that_waits_and_is_told_so():
    from tmini._serve import _Listener

    async def scenario():
        slow = _Listener()
        slow.add(1000, b"first")
        first = await slow.take()
        for i in range(33):
            slow.add(10000 + 1000 * i, bytes([i]) * 1000)
        return first, await slow.take()

    assert asyncio.run(scenario()) == (
        chunk(0, b"first"), chunk(41000, b"") + chunk(0, bytes([32]) * 1000))


def test_who_sends_more_than_a_request_and_answers_to_our_pings_is_left():
    from tmini._serve import _Guard
    heard, left = [], []
    guard = _Guard(SimpleNamespace(data_received=heard.append))
    guard._transport, guard._since = SimpleNamespace(abort=lambda: left.append(1)), time.monotonic() - 10
    guard.data_received(bytes(17000))
    assert len(heard) == 1 and not left
    guard.data_received(bytes(1000))
    assert len(heard) == 1 and left


@pytest.mark.parametrize("waiting, resumes, is_left", [
    pytest.param(*row, id=claim) for claim, row in {
        "who_takes_nothing_is_left": ([5, 5], False, True),
        "who_takes_some_and_then_nothing_is_left": ([5, 4, 4, 4], False, True),
        "who_has_taken_it_is_not": ([5, 5], True, False),
    }.items()])
def test_a_connection_is_watched_while_too_much_waits_for_it(monkeypatch, waiting, resumes, is_left):
    from tmini._serve import _Guard
    monkeypatch.setattr("tmini._serve._DEAD_S", 0)
    left, sizes = [], list(waiting)

    async def scenario():
        guard = _Guard(SimpleNamespace(pause_writing=lambda: None, resume_writing=lambda: None))
        guard._transport = SimpleNamespace(get_write_buffer_size=lambda: sizes.pop(0), abort=lambda: left.append(1))
        guard.pause_writing()
        if resumes:
            guard.resume_writing()
        for _ in range(100):
            await asyncio.sleep(0)

    asyncio.run(scenario())
    assert left == ([1] if is_left else [])


def test_what_a_timed_stream_lost_is_lost_for_listeners_too(server):
    other = socket.create_server(("127.0.0.1", 0))
    number, _ = server(lidar=f"tcp:127.0.0.1:{other.getsockname()[1]}")
    with listen(number) as one:
        upstream = other.accept()[0]
        upstream.sendall(MAGIC + chunk(5, b"a"))
        content = receive(one, 8 + 11)
        upstream.sendall(chunk(5000, b"") + chunk(20000, b"b"))
        content += receive(one, 21)
    assert content[8:] == chunk(0, b"a") + content[19:29] + content[29:]
    assert content[19 + 6:19 + 8] == b"\0\0" and content[-1:] == b"b"
