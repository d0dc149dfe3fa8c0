# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""A connected lidar. The library's driver runs in its own thread, so that no bytes are lost while
the program is busy. One lock protects the driver's data."""

from __future__ import annotations

import atexit
import threading
import time
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from ._line import Line, open_line
from ._mount import Mount
from ._native import ffi, lib
from ._scan import Fault, Scan

_PERIOD_S = 0.01  # 130 bytes come in this time.
_REOPEN_S = 0.25
_CLOSE_S = 1.0
_RING = 32768
_BLOCK = 16384
_POINTS = 2400  # For a turn at 2 Hz, while the motor comes up to speed.


class LidarError(Exception):
    """The lidar does not scan; the text says what to check."""


@dataclass(frozen=True)
class Info:
    """The device information that the lidar has sent."""

    model: int  # 151: T-mini Plus.
    firmware: str
    hardware: int
    serial: str


@ffi.def_extern()
def python_write(context: Any, data: Any, count: int) -> int:
    return ffi.from_handle(context)._write(bytes(ffi.buffer(data, count)))


@ffi.def_extern()
def python_now_ms(_context: Any) -> int:
    return int(time.monotonic() * 1000) & 0xFFFFFFFF


@ffi.def_extern()
def python_restart(context: Any) -> None:
    ffi.from_handle(context)._is_stale = True


class Lidar:
    """A lidar on a serial port ("/dev/ttyUSB0", "COM3") or on a socket ("tcp:HOST:PORT"). It scans
    until close(). If it is lost or unplugged, it is started again.

    A program that is slower than the lidar gets the newest scan, and Scan.number shows how many it
    has missed; `backlog` is the number of scans that wait for it."""

    def __init__(self, port: str, frequency_hz: float | None = None, *, front: float = 0,
                 upside_down: bool = False, mask: Sequence[tuple[int, int]] = (),
                 listen_only: bool = False, backlog: int = 1,
                 timeout: float | None = 10.0) -> None:
        """`frequency_hz`: 6 to 12, in steps of 0.1; None: left as it is. `front`, `upside_down` and
        `mask`: see Mount. `listen_only`: never sends anything. Waits up to `timeout` seconds for
        the first scan, and raises LidarError if there is none, OSError if there is no such port;
        None: returns at once, even if the port does not exist yet."""
        self.port = port
        self.info: Info | None = None  # None: the lidar has not answered.
        self._scans: deque[Scan] = deque(maxlen=backlog)
        self._changed = threading.Condition()
        self._closing = False
        self._failure: Exception | None = None
        self._received = 0
        self._number = 0
        self._line: Line | None = None
        self._is_stale = False  # The line is silent, and is to be opened again.
        self._mount = Mount(front, upside_down, mask)
        self._listen_only = listen_only
        self._set_up(frequency_hz)
        try:
            self._line = open_line(port)
        except OSError:
            if timeout is not None:
                raise
        self._thread = threading.Thread(target=self._run, name=f"tmini {port}", daemon=True)
        self._thread.start()
        atexit.register(self.close)
        if timeout is not None:
            self._await_first(timeout)

    def __enter__(self) -> Lidar:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[Scan]:
        """Each scan as it comes, without end; while the lidar is lost there are none. To
        notice that, call read()."""
        while (scan := self.read()) is not None:
            yield scan

    def read(self, timeout: float | None = None) -> Scan | None:
        """The next scan; None if none comes within `timeout` seconds, or after close()."""
        end = None if timeout is None else time.monotonic() + timeout
        with self._changed:
            while not self._scans:
                left = 1.0 if end is None else end - time.monotonic()
                if self._failure is not None:
                    raise LidarError(f"the driver's thread failed: {self._failure!r}")
                if self._closing or left <= 0:
                    return None
                self._changed.wait(min(left, 1.0))  # On Windows, Ctrl-C interrupts no endless wait.
            return self._scans.popleft()

    @property
    def faults(self) -> Fault:
        """As last reported by the lidar, or found by the driver."""
        with self._changed:
            return Fault(lib.tmini_faults(self._lidar))

    @property
    def is_scanning(self) -> bool:
        with self._changed:
            return (self._line is not None
                    and lib.tmini_state(self._lidar) == lib.TMINI_STATE_SCANNING)

    @property
    def counters(self) -> dict[str, int]:
        """The driver's running totals, by the names of tmini_counters_t."""
        with self._changed:
            lib.tmini_counters(self._lidar, self._totals)
        return {name: getattr(self._totals, name) for name, _ in ffi.typeof(self._totals[0]).fields}

    def close(self) -> None:
        """Stops the lidar and closes the port."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join()
        atexit.unregister(self.close)

    # ------------------------------------------------------------------------- under the lock

    def _set_up(self, frequency_hz: float | None) -> None:
        self._handle = ffi.new_handle(self)
        self._rx = ffi.new("uint8_t[]", _RING)
        self._points = ffi.new("tmini_point_t[]", _POINTS)
        self._totals = ffi.new("tmini_counters_t *")
        self._lidar = ffi.new("tmini_t *")
        self._timing = ffi.new("tmini_timing_t *", lib.tmini_timing_default)
        self._timing.frame_timeout_ms = 250  # Python may be busy for a while.
        self._timing.max_pause_ms = 250
        self._timing.reply_timeout_ms = 1000
        self._port = ffi.new("tmini_port_t *", {"write": lib.python_write,
                                                "now_ms": lib.python_now_ms,
                                                "restart": lib.python_restart})
        config = ffi.new("tmini_config_t *", {
            "port": self._port, "port_context": self._handle, "rx_buffer": self._rx,
            "rx_size": _RING, "points": self._points, "max_points": _POINTS,
            "frequency_chz": round((frequency_hz or 0) * 100), "listen_only": self._listen_only,
            "step": ffi.addressof(lib, "tmini_mount_step"), "step_data": self._mount.native,
            "timing": self._timing})
        if lib.tmini_init(self._lidar, config) != 0:
            raise ValueError("frequency_hz is 6 to 12, in steps of 0.1, and None if listen_only")

    def _write(self, data: bytes) -> int:
        try:
            return -1 if self._line is None else self._line.write(data)
        except OSError:
            return -1

    def _feed(self, data: bytes) -> None:
        self._received += len(data)
        for begin in range(0, max(len(data), 1), _BLOCK):
            block = data[begin:begin + _BLOCK]
            lib.tmini_feed(self._lidar, block, len(block))
            lib.tmini_feed_held(self._lidar, len(data) - begin - len(block))
            while (event := lib.tmini_poll(self._lidar)) != lib.TMINI_EVENT_NONE:
                self._take(event)

    def _take(self, event: int) -> None:
        if event == lib.TMINI_EVENT_SCAN:
            native = lib.tmini_scan(self._lidar)[0]
            age_ms = (python_now_ms(None) - native.start_ms) & 0xFFFFFFFF
            self._number += 1
            self._scans.append(Scan(native, self._number, self._faults(),
                                    time.monotonic() - age_ms / 1000))
            self._changed.notify_all()
        elif event == lib.TMINI_EVENT_INFO:
            self.info = _info(lib.tmini_info(self._lidar))

    def _faults(self) -> int:
        """The driver's faults; TMINI_FAULTS_UNKNOWN if there is none but the unit does not report
        its health."""
        info = ffi.new("tmini_ct_info_t *")
        lib.tmini_ct_info(self._lidar, info)
        faults = lib.tmini_faults(self._lidar)
        return faults if faults or info.known & lib.TMINI_KNOWN_FAULTS else lib.TMINI_FAULTS_UNKNOWN

    # --------------------------------------------------------------------------------- thread

    def _run(self) -> None:
        try:
            self._work()
        except Exception as error:  # Else a thread that waits for a scan would wait without end.
            with self._changed:
                self._failure = error
                self._changed.notify_all()
        finally:
            if self._line is not None:
                self._line.close()

    def _work(self) -> None:
        with self._changed:
            lib.tmini_request_info(self._lidar)
            lib.tmini_start(self._lidar)  # Begins after the query.
        while not self._closing:
            self._turn()
            time.sleep(_PERIOD_S if self._line is not None else _REOPEN_S)
        with self._changed:
            lib.tmini_stop(self._lidar)
        end = time.monotonic() + _CLOSE_S
        while (self._line is not None and time.monotonic() < end
               and lib.tmini_state(self._lidar) != lib.TMINI_STATE_IDLE):
            self._turn()
            time.sleep(_PERIOD_S)

    def _turn(self) -> None:
        """Feeds received bytes to the driver, and opens the line again if it has gone."""
        data = b""
        try:
            if self._is_stale:
                self._drop_line()
            if self._line is None:
                self._line = open_line(self.port)
                with self._changed:
                    lib.tmini_feed_gap(self._lidar)
            data = self._line.read()
        except OSError:
            self._drop_line()
        with self._changed:
            self._feed(data)

    def _drop_line(self) -> None:
        line, self._line, self._is_stale = self._line, None, False
        if line is not None:
            line.close()

    def _await_first(self, timeout: float) -> None:
        try:
            with self._changed:
                if self._changed.wait_for(lambda: len(self._scans) > 0, timeout):
                    return
            raise LidarError(self._trouble(timeout))
        except BaseException:
            self.close()
            raise

    def _trouble(self, timeout: float) -> str:
        counters = self.counters
        if self._received == 0:
            return (f"not one byte came from {self.port} in {timeout:g} s. Is it the right port, "
                    "has the lidar 5 V, and is its TX wired to the adapter's RX?")
        if counters["packets"] == 0 and self.info is None:
            return (f"{self._received} bytes came from {self.port}, but no packet of a T-mini: "
            "another device, or another baud rate than 230400?")
        return f"the lidar on {self.port} answers, but does not scan: {self.faults!r}"


def _info(native: Any) -> Info:
    serial = "".join(str(digit) for digit in native.serial)
    return Info(native.model, f"{native.firmware_major}.{native.firmware_minor}", native.hardware,
                serial)
