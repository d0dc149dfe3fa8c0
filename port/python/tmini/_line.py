# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Where the lidar's bytes come from: a serial port, or a socket to a controller that forwards its
UART. Reading and writing never wait; they raise OSError if the line has gone."""

from __future__ import annotations

import socket
from typing import Protocol

import serial

try:
    from termios import error as TerminalError  # No OSError, and pyserial lets it through.
except ImportError:  # Windows.
    TerminalError = OSError  # type: ignore[misc,assignment]

_BAUD_RATE = 230400
_CONNECT_S = 5.0


class Line(Protocol):
    def read(self) -> bytes:
        """Returns the bytes that have come."""

    def write(self, data: bytes) -> int:
        """Returns how many bytes were taken."""

    def close(self) -> None: ...


class _Port:
    def __init__(self, name: str) -> None:
        try:
            self._port = serial.Serial(name, _BAUD_RATE, timeout=0, write_timeout=0, exclusive=True)
        except TerminalError as error:
            raise OSError(f"{name}: {error}") from error

    def read(self) -> bytes:
        return bytes(self._port.read(self._port.in_waiting or 1))

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

    def read(self) -> bytes:
        try:
            data = self._socket.recv(65536)
        except BlockingIOError:
            return b""
        if not data:
            raise ConnectionResetError("the other end has closed the socket")
        return data

    def write(self, data: bytes) -> int:
        try:
            return self._socket.send(data)
        except BlockingIOError:
            return 0

    def close(self) -> None:
        self._socket.close()


def open_line(name: str) -> Line:
    return _Socket(name[4:]) if name.startswith("tcp:") else _Port(name)
