# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Where the lidar's bytes come from: a serial port, or a socket to a controller that forwards its
UART, raw or as a timed stream. Reading and writing never wait; they raise OSError if the line has
gone."""

from __future__ import annotations

import select
import socket
import time
from collections.abc import Iterator
from typing import Protocol

import serial

from ._native import ffi, lib

try:
    from termios import error as TerminalError  # No OSError, and pyserial lets it through.
except ImportError:  # Windows.
    TerminalError = OSError  # type: ignore[misc,assignment]

_BAUD_RATE = 230400
_CONNECT_S = 5.0
_GREETING_S = 0.6  # For a socket's first bytes, which show whether the stream is timed.


def now_us() -> int:
    return time.monotonic_ns() // 1000


class Line(Protocol):
    @property
    def is_timed(self) -> bool:
        """A timed stream, which only listens."""

    def read(self) -> Iterator[bytes | None]:
        """The bytes that have come: each part is polled before the next. None: some were lost."""

    def now_us(self) -> int:
        """When the part came."""

    def write(self, data: bytes) -> int:
        """Returns how many bytes were taken."""

    def close(self) -> None: ...


class _Port:
    is_timed = False

    def __init__(self, name: str) -> None:
        try:
            self._port = serial.Serial(name, _BAUD_RATE, timeout=0, write_timeout=0, exclusive=True)
        except TerminalError as error:
            raise OSError(f"{name}: {error}") from error

    def read(self) -> Iterator[bytes | None]:
        yield bytes(self._port.read(self._port.in_waiting or 1))

    def now_us(self) -> int:
        return now_us()

    def write(self, data: bytes) -> int:
        return self._port.write(data) or 0

    def close(self) -> None:
        self._port.close()


class _Socket:
    def __init__(self, address: str) -> None:
        host, colon, port = address.rpartition(":")
        if not colon or not host or not port.isdigit():
            raise ValueError(f"tcp:{address}: a lidar on a socket is tcp:HOST:PORT")
        self._socket = socket.create_connection((host.strip("[]"), int(port)), _CONNECT_S)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket.setblocking(False)
        self._timed = ffi.new("tmini_timed_t *")
        end = time.monotonic() + _GREETING_S
        while (self._timed.kind == lib.TMINI_TIMED_UNKNOWN and (left := end - time.monotonic()) > 0
               and select.select([self._socket], [], [], left)[0]):
            self._put(self._receive())

    @property
    def is_timed(self) -> bool:
        return bool(self._timed.kind == lib.TMINI_TIMED_YES)

    def now_us(self) -> int:
        return int(lib.tmini_timed_now_us(self._timed, now_us()))

    def read(self) -> Iterator[bytes | None]:
        yield from self._take()
        data = self._receive()
        while data and (self.is_timed or self._timed.kind == lib.TMINI_TIMED_UNKNOWN):
            data = self._put(data)
            yield from self._take()
        yield data

    def _put(self, data: bytes) -> bytes:
        """Returns those for which there is no room."""
        room = ffi.new("size_t *")
        place = lib.tmini_timed_room(self._timed, room)
        ffi.memmove(place, data, min(room[0], len(data)))
        lib.tmini_timed_put(self._timed, min(room[0], len(data)))
        return data[room[0]:]

    def _take(self) -> Iterator[bytes | None]:
        place, is_gap = ffi.new("uint8_t **"), ffi.new("bool *")
        while (count := lib.tmini_timed_take(self._timed, now_us(), lib.TMINI_TIMED_MAX, place,
                                             is_gap)) or is_gap[0]:
            yield None if is_gap[0] else bytes(ffi.buffer(place[0], count))

    def _receive(self) -> bytes:
        try:
            data = self._socket.recv(65536)
        except BlockingIOError:
            return b""
        if not data:
            raise ConnectionResetError("the other end has closed the socket")
        return data

    def write(self, data: bytes) -> int:
        if self.is_timed:
            raise BrokenPipeError("a timed stream takes no commands")
        try:
            return self._socket.send(data)
        except BlockingIOError:
            return 0

    def close(self) -> None:
        self._socket.close()


def open_line(name: str) -> Line:
    return _Socket(name[4:]) if name.startswith("tcp:") else _Port(name)
