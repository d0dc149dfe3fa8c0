# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Shows the room in a browser, also on a phone: open the address that is printed. The lidar scans
while somebody looks. Nobody can command it from there."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import ipaddress
import logging
import pathlib
import socket
import sys
import time
import urllib.parse
from typing import Any

from ._command import add_frequency_argument, add_port_argument, load, on_signal, watch_signals
from ._lidar import Lidar
from ._native import ffi, lib

SUMMARY = "in a browser, on this computer or in the network"

_PAGE = pathlib.Path(__file__).with_name("tmini.html")
_MAGIC = b"\x89tmini\x02\n"
_LISTENERS_MAX = 8
_WAITING_MAX = 32768  # Bytes for one listener: more than two seconds.
_SYSTEM_BYTES = 16384  # What the system keeps for one, about.
_CONNECTIONS_MAX = 32  # Listeners, and those that ask for the page.
_HEARD_MAX = 16384  # Bytes of one connection: its request; and then the answers to our pings:
_HEARD_MAX_PER_S = 100
_DEAD_S = 15.0  # Who takes nothing for as long is left.
_LINGER_S = 2.0  # The lidar scans on for as long, for a page that is loaded again.
_HEADERS = {"Cache-Control": "no-store", "X-Content-Type-Options": "nosniff",
            "X-Frame-Options": "DENY", "Connection": "close"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_port_argument(parser)
    add_frequency_argument(parser)
    parser.add_argument("--host", default="127.0.0.1", metavar="ADDRESS",
                        help="where to listen; 0.0.0.0: anybody in the network sees the room")
    parser.add_argument("--tcp", type=int, default=8080, metavar="NUMBER",
                        help="the number of the TCP port; 0: any that is free (default: 8080)")
    parser.add_argument("--name", action="append", default=[], metavar="HOST",
                        help="another name of this computer, by which browsers may ask for it")
    parser.add_argument("--page", type=pathlib.Path, default=_PAGE, metavar="FILE",
                        help="another tmini.html")


def run(arguments: argparse.Namespace) -> None:
    server = load("websockets.asyncio.server", "serve")
    http = load("websockets.http11", "serve")
    closed = load("websockets.exceptions", "serve").ConnectionClosed
    page = arguments.page.read_bytes()
    watch_signals()
    with Lidar(arguments.port, arguments.frequency, timeout=None) as lidar:
        lidar.stop()
        asyncio.run(_serve(arguments, _Hub(lidar, closed), server,
                           _Answers(http, page, arguments.name)))


class _Listener:
    """What waits for one listener. If it is too slow, that is dropped as a whole, and it is told
    so."""

    def __init__(self) -> None:
        self.parts: list[tuple[int, bytes]] = []
        self.size = 0
        self.has_parts = asyncio.Event()
        self.told_us: int | None = None

    def add(self, came_us: int, data: bytes) -> None:
        if self.size + len(data) > _WAITING_MAX:
            self.parts, self.size = [(came_us, b"")], 0
        self.parts.append((came_us, data))
        self.size += len(data)
        self.has_parts.set()

    async def take(self) -> bytes:
        """The next chunks."""
        await self.has_parts.wait()
        self.has_parts.clear()
        parts, self.parts, self.size = self.parts, [], 0
        return b"".join(self._chunk(came_us, data) for came_us, data in parts)

    def _chunk(self, came_us: int, data: bytes) -> bytes:
        head = ffi.new("uint8_t[]", lib.TMINI_TIMED_HEAD_SIZE)
        passed_us = 0 if self.told_us is None else came_us - self.told_us
        lib.tmini_timed_write_head(head, min(passed_us, 0xFFFFFFFF), data, len(data))
        self.told_us = came_us
        return bytes(ffi.buffer(head)) + data


class _Hub:
    """Passes on what the lidar sends. It scans while there are listeners."""

    def __init__(self, lidar: Lidar, closed: type[Exception]) -> None:
        self.listeners: set[_Listener] = set()
        self._lidar = lidar
        self._closed = closed

    def begin(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._lidar._tap = self._tap

    def _tap(self, came_us: int, data: bytes | None) -> None:
        """In the lidar's thread. No data: some were lost."""
        if data or data is None:
            with contextlib.suppress(RuntimeError):  # The loop has ended, and the lidar is to be stopped.
                self._loop.call_soon_threadsafe(self._pass_on, came_us, data or b"")

    def _pass_on(self, came_us: int, data: bytes) -> None:
        for at in range(0, len(data) or 1, lib.TMINI_TIMED_MAX):
            for listener in self.listeners:
                listener.add(came_us, data[at:at + lib.TMINI_TIMED_MAX])

    async def serve(self, connection: Any) -> None:
        """Serves one listener until it has gone. One that sends something is not meant to."""
        listener = _Listener()
        self.listeners.add(listener)
        self._lidar.start()
        sending = asyncio.create_task(self._send(listener, connection))
        try:
            async for _ in connection:
                await connection.close(1008, "listeners send nothing")
        except self._closed:
            pass  # Without a word.
        finally:
            sending.cancel()
            self.listeners.discard(listener)
            self._loop.call_later(_LINGER_S, self._rest)

    async def _send(self, listener: _Listener, connection: Any) -> None:
        with contextlib.suppress(self._closed):
            await connection.send(_MAGIC)
            while True:
                await connection.send(await listener.take())

    def _rest(self) -> None:
        if not self.listeners:
            self._lidar.stop()


class _Guard(asyncio.Protocol):
    """Between the system and a connection of `websockets`, which has no limit for the number of
    connections, for what one sends (each ping is answered, even if nobody reads the answers), and
    for the time in which one takes nothing (the ping that should notice it waits, too). Who is too
    much is left without a word."""

    number = 0  # Of connections.

    def __init__(self, connection: Any) -> None:
        self._connection = connection
        self._is_admitted = False
        self._heard = 0
        self._timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport: Any) -> None:
        self._transport = transport
        self._since = time.monotonic()
        if _Guard.number >= _CONNECTIONS_MAX:
            transport.abort()
            return
        self._is_admitted = True
        _Guard.number += 1
        self._connection.connection_made(transport)

    def data_received(self, data: bytes) -> None:
        self._heard += len(data)
        if self._heard > _HEARD_MAX + _HEARD_MAX_PER_S * (time.monotonic() - self._since):
            self._transport.abort()
        else:
            self._connection.data_received(data)

    def eof_received(self) -> bool | None:
        is_kept: bool | None = self._connection.eof_received()
        return is_kept

    def pause_writing(self) -> None:
        """Too much waits for the other end."""
        self._watch()
        self._connection.pause_writing()

    def resume_writing(self) -> None:
        self._unwatch()
        self._connection.resume_writing()

    def connection_lost(self, exc: Exception | None) -> None:
        self._unwatch()
        if self._is_admitted:
            _Guard.number -= 1
            self._connection.connection_lost(exc)

    def _watch(self) -> None:
        waits = self._transport.get_write_buffer_size()
        self._timer = asyncio.get_running_loop().call_later(_DEAD_S, self._look, waits)

    def _look(self, waited: int) -> None:
        if self._transport.get_write_buffer_size() < waited:
            self._watch()
        else:
            self._transport.abort()

    def _unwatch(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


class _Answers:
    """Answers requests. A page of others must not see the room: its name is not this computer's,
    or its origin is another."""

    def __init__(self, http: Any, page: bytes, names: list[str]) -> None:
        self._http = http
        self._page = page
        own = socket.gethostname().lower()
        self._names = {"localhost", own, f"{own}.local", *(name.lower() for name in names)}

    def answer(self, hub: _Hub, request: Any) -> Any:
        """None: the request may become a WebSocket."""
        path = request.path.partition("?")[0]
        hosts, origins = (request.headers.get_all(name) for name in ("Host", "Origin"))
        if len(hosts) != 1 or not self._is_own(hosts[0]):
            return self._text(403, "Forbidden", "This computer has another name (see --name).\n")
        if path == "/":
            return self._response(302, "Found", {"Location": "/live"}, b"")
        if path == "/live":
            return self._response(200, "OK", {"Content-Type": "text/html; charset=utf-8"}, self._page)
        if path != "/stream":
            return self._text(404, "Not Found", "There is only /live.\n")
        if any(origin not in (f"http://{hosts[0]}", f"https://{hosts[0]}") for origin in origins):
            return self._text(403, "Forbidden", "Only for the page from here.\n")
        if len(hub.listeners) >= _LISTENERS_MAX:
            return self._text(503, "Service Unavailable", "Too many listeners.\n")
        return None

    def _is_own(self, host: str) -> bool:
        """An address is, because no name leads to it."""
        try:
            name = urllib.parse.urlsplit(f"//{host}").hostname or ""
            return name in self._names or bool(ipaddress.ip_address(name))
        except ValueError:
            return False

    def _text(self, status: int, reason: str, text: str) -> Any:
        return self._response(status, reason, {"Content-Type": "text/plain"}, text.encode())

    def _response(self, status: int, reason: str, headers: dict[str, str], body: bytes) -> Any:
        fields = {**_HEADERS, **headers, "Content-Length": str(len(body))}
        return self._http.Response(status, reason, self._http.Headers(fields), body)


async def _serve(arguments: argparse.Namespace, hub: _Hub, server: Any, answers: _Answers) -> None:
    quiet = logging.getLogger("tmini.serve")  # What strangers do is no news.
    quiet.addHandler(logging.NullHandler())
    quiet.propagate = False
    hub.begin()
    async with server.serve(
            hub.serve, arguments.host, arguments.tcp, compression=None, write_limit=8192,
            max_size=125, max_queue=1, open_timeout=5, ping_interval=10, ping_timeout=10, close_timeout=1, logger=quiet,
            process_request=lambda _, request: answers.answer(hub, request),
            create_connection=lambda *words, **more: _Guard(server.ServerConnection(*words, **more))) as running:
        for one in running.sockets:  # More would only be old.
            one.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SYSTEM_BYTES)
        number = running.sockets[0].getsockname()[1]
        is_private = ipaddress.ip_address(running.sockets[0].getsockname()[0]).is_loopback
        name = arguments.host if is_private else f"{socket.gethostname()}.local"
        if not is_private:
            print("everybody in the network can see the room", file=sys.stderr)
        over = on_signal(asyncio.get_running_loop())
        print(f"http://{name}:{number}", flush=True)
        await over.wait()
