# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""A connected lidar. The library's driver runs in its own thread, so that no bytes are lost while
the program is busy. One lock protects the driver's data."""

from __future__ import annotations

import atexit
import numbers
import operator
import os
import threading
import time
import weakref
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from ._find import resolve
from ._line import Line, now_us, open_line
from ._mount import Mount
from ._native import ffi, lib
from ._scan import Fault, Scan
from ._witness import Witness

_PERIOD_S = 0.01  # 130 bytes come in this time.
_REOPEN_S = 0.25
_CLOSE_S = 1.0
_CLOSE_TURNS = 20
_RING = 32768
_BLOCK = 16384
_POINTS = 2400  # For a turn at 2 Hz, while the motor comes up to speed.
_UNKNOWN: int = lib.TMINI_FAULTS_UNKNOWN
_FREQUENCY_MIN_HZ, _FREQUENCY_MAX_HZ = 6, 12


class LidarError(Exception):
    """The lidar does not scan; the text says what to check."""


@dataclass(frozen=True)
class Info:
    """The device information that the lidar has sent."""

    model: int  # 151: T-mini Plus.
    firmware: str
    hardware: int
    serial: str


def python_write(context: Any, data: Any, count: int) -> int:
    lidar: Lidar = ffi.from_handle(context)
    return lidar._write(bytes(ffi.buffer(data, count)))


def python_now_ms(context: Any) -> int:
    line = ffi.from_handle(context)._line
    return (now_us() if line is None else line.now_us()) // 1000 & 0xFFFFFFFF


def python_restart(context: Any) -> None:
    ffi.from_handle(context)._is_stale = True


for _function in (python_write, python_now_ms, python_restart):
    ffi.def_extern()(_function)


class Lidar:
    """A lidar on a serial port ("/dev/ttyUSB0", "COM3"), on a socket ("tcp:HOST:PORT"), or by the
    end of its serial number ("serial:2345"; see find()). It scans until close(). If it is lost or
    unplugged, it is started again.

    A program that is slower than the lidar gets the newest scan, and Scan.number shows how many it
    has missed; `backlog` is the number of scans that wait for it. After a fork it remains the
    parent's."""

    def __init__(self, port: str | os.PathLike[str], frequency_hz: float | None = None, *,
                 front: float = 0, upside_down: bool = False, mask: Sequence[tuple[int, int]] = (),
                 offset_mm: int = 0, listen_only: bool = False, backlog: int = 1,
                 timeout: float | None = 10.0) -> None:
        """`frequency_hz`: as in set_frequency(); None: left as it is. `front`, `upside_down`,
        `mask` and `offset_mm`: see Mount. `listen_only`: never sends anything; neither does a timed
        stream. Waits up to `timeout` seconds for the first scan, and raises LidarError if there is
        none, OSError if there is no such port; None: returns at once, even if the port does not
        exist yet."""
        if not isinstance(port, (str, os.PathLike)):
            raise TypeError(f"port is a name such as \"/dev/ttyUSB0\", not {port!r}")
        if operator.index(backlog) < 1:
            raise ValueError("backlog is the number of scans that wait: 1 or more")
        if listen_only and frequency_hz is not None:
            raise ValueError("listen_only sends nothing, so it cannot set frequency_hz")
        self.port = os.fspath(port)
        self.info: Info | None = None  # None: the lidar has not answered.
        self._scans: deque[Scan] = deque(maxlen=backlog)
        self._changed = threading.Condition()
        self._closing = False
        self._is_stopped = False
        self._is_inherited = False  # This process is a fork of the one that opened it.
        self._complete_s = time.monotonic()  # When the newest complete scan ended.
        self._failure: Exception | None = None
        self._number = 0
        self._line: Line | None = None
        self._name: str | None = None  # The line's; None: to be found.
        self._is_stale = False  # The line is silent, and is to be opened again.
        self._tap: Callable[[int, bytes | None], None] | None = None  # Gets what comes, and when.
        self._witness: Witness | None = Witness()  # Until the first scan.
        self._mount = Mount(front, upside_down, mask, offset_mm)
        self._listen_only = listen_only
        chz = 0 if frequency_hz is None else _chz(frequency_hz)
        try:
            self._open_line()
        except OSError:
            if timeout is not None:
                raise
        if self._line is not None and self._line.is_timed:
            self._listen_only = True
            if chz > 0:
                self._line.close()
                raise LidarError(f"{self.port} is a timed stream, whose sender sets the frequency")
        self._set_up(chz)
        lib.tmini_request_info(self._lidar)
        lib.tmini_start(self._lidar)  # Begins after the query.
        self._thread = threading.Thread(target=self._run, name=f"tmini {self.port}", daemon=True)
        self._thread.start()
        _lidars.add(self)
        atexit.register(self.close)
        if timeout is not None:
            self._await_first(timeout)

    def __enter__(self) -> Lidar:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[Scan]:
        """Each scan as it comes, until stop() or close(); while the lidar is lost there are none. To
        notice that, call read()."""
        while (scan := self.read()) is not None:
            yield scan

    def read(self, timeout: float | None = None) -> Scan | None:
        """The next scan; None if none comes within `timeout` seconds, or after stop() or
        close()."""
        end = None if timeout is None else time.monotonic() + timeout
        with self._changed:
            while not self._scans:
                left = 1.0 if end is None else end - time.monotonic()
                if self._failure is not None:
                    raise LidarError(f"the driver's thread failed: {self._failure!r}")
                if self._is_inherited:
                    raise LidarError(f"only the process that opened {self.port} can read it")
                if self._closing or self._is_stopped or left <= 0:
                    return None
                self._changed.wait(min(left, 1.0))  # On Windows, Ctrl-C interrupts no endless wait.
            return self._scans.popleft()

    def start(self) -> None:
        """Scans again after stop()."""
        with self._wishing():
            self._is_stopped = False
            lib.tmini_start(self._lidar)

    def stop(self) -> None:
        """The motor and the laser are switched off until start(). Does not wait for it."""
        with self._wishing():
            self._is_stopped = True
            self._scans.clear()
            lib.tmini_stop(self._lidar)

    def set_frequency(self, frequency_hz: float) -> None:
        """6 to 12, to the nearest 0.1; also after a loss of the lidar. While the lidar sets it, no
        scans come for a second or two."""
        chz = _chz(frequency_hz)
        with self._wishing():
            if self._listen_only:
                raise LidarError("listen_only sends nothing, so it cannot set the frequency")
            lib.tmini_set_frequency(self._lidar, chz)

    @property
    def scan_age_s(self) -> float:
        """How long ago the newest complete scan ended, or this lidar was opened. A robot stops when
        it is more than 0.3."""
        return time.monotonic() - self._complete_s

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
        if self._is_inherited:
            return
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join()
        atexit.unregister(self.close)

    @contextmanager
    def _wishing(self) -> Iterator[None]:
        with self._changed:
            if self._closing:
                raise LidarError(f"the lidar on {self.port} is closed")
            yield
            self._changed.notify_all()

    # ------------------------------------------------------------------------- under the lock

    def _set_up(self, frequency_chz: int) -> None:
        self._handle = ffi.new_handle(self)
        self._rx = ffi.new("uint8_t[]", _RING)
        self._points = ffi.new("tmini_point_t[]", _POINTS)
        self._totals = ffi.new("tmini_counters_t *")
        self._lidar = ffi.new("tmini_t *")
        self._timing = ffi.new("tmini_timing_t *", lib.tmini_timing_default)
        # Python may be busy for a while, and a network for longer.
        self._timing.frame_timeout_ms = self._timing.max_pause_ms = \
            1000 if self.port.startswith("tcp:") else 250
        self._timing.reply_timeout_ms = 1000
        self._port = ffi.new("tmini_port_t *", {"write": lib.python_write,
                                                "now_ms": lib.python_now_ms,
                                                "restart": lib.python_restart})
        config = ffi.new("tmini_config_t *", {
            "port": self._port, "port_context": self._handle, "rx_buffer": self._rx,
            "rx_size": _RING, "points": self._points, "max_points": _POINTS,
            "frequency_chz": frequency_chz, "listen_only": self._listen_only,
            "step": ffi.addressof(lib, "tmini_mount_step"), "step_data": self._mount.native,
            "timing": self._timing})
        if lib.tmini_init(self._lidar, config) != 0:
            raise LidarError("the driver refuses its configuration")

    def _write(self, data: bytes) -> int:
        try:
            return -1 if self._line is None else self._line.write(data)
        except OSError:
            return -1

    def _feed(self, data: bytes) -> None:
        for begin in range(0, max(len(data), 1), _BLOCK):
            block = data[begin:begin + _BLOCK]
            if self._witness is not None:
                self._witness.take(block)
            lib.tmini_feed(self._lidar, block, len(block))
            lib.tmini_feed_held(self._lidar, len(data) - begin - len(block))
            while (event := lib.tmini_poll(self._lidar)) != lib.TMINI_EVENT_NONE:
                self._take(event)

    def _take(self, event: int) -> None:
        if event == lib.TMINI_EVENT_SCAN and not self._is_stopped:
            native = lib.tmini_scan(self._lidar)[0]
            age_ms = (now_us() // 1000 - native.start_ms) & 0xFFFFFFFF
            self._number += 1
            self._witness = None
            scan = Scan(native, self._number, self._faults(), time.monotonic() - age_ms / 1000)
            self._scans.append(scan)
            self._complete_s = scan.end_s if scan.complete else self._complete_s
            self._changed.notify_all()
        elif event == lib.TMINI_EVENT_INFO:
            self.info = _info(lib.tmini_info(self._lidar))

    def _faults(self) -> int:
        """The driver's faults; TMINI_FAULTS_UNKNOWN if there is none but the unit does not report
        its health."""
        info = ffi.new("tmini_ct_info_t *")
        lib.tmini_ct_info(self._lidar, info)
        faults: int = lib.tmini_faults(self._lidar)
        return faults if faults or info.known & lib.TMINI_KNOWN_FAULTS else _UNKNOWN

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
        while not self._closing:
            self._turn()
            time.sleep(_PERIOD_S if self._line is not None else _REOPEN_S)
        with self._changed:
            lib.tmini_stop(self._lidar)
        end, turns = time.monotonic() + _CLOSE_S, 0  # A busy computer may be away for all the time.
        while (self._line is not None and (time.monotonic() < end or turns < _CLOSE_TURNS)
               and lib.tmini_state(self._lidar) != lib.TMINI_STATE_IDLE):
            self._turn()
            time.sleep(_PERIOD_S)
            turns += 1

    def _turn(self) -> None:
        """Feeds received bytes to the driver, and opens the line again if it has gone."""
        try:
            if self._is_stale:
                self._drop_line()
            line = self._line
            if line is None:
                line = self._open_line()
                self._feed_gap()
            for data in line.read():
                self._note_times(line)
                if self._tap is not None:
                    self._tap(line.now_us(), data)
                if data is None:
                    self._feed_gap()
                else:
                    with self._changed:
                        self._feed(data)
        except OSError:
            self._drop_line()
            self._name = None
            with self._changed:
                self._feed(b"")

    def _feed_gap(self) -> None:
        with self._changed:
            lib.tmini_feed_gap(self._lidar)
            self._feed(b"")

    def _note_times(self, line: Line) -> None:
        """A timed stream, on a line that was opened later, only listens."""
        if line.is_timed and not self._listen_only:
            with self._changed:
                self._listen_only = True
                self._set_up(0)
                if not self._is_stopped:
                    lib.tmini_start(self._lidar)

    def _open_line(self) -> Line:
        self._name = self._name or resolve(self.port)
        self._line = open_line(self._name)
        return self._line

    def _drop_line(self) -> None:
        with self._changed:  # The program's wishes write, too.
            line, self._line, self._is_stale = self._line, None, False
            if line is not None:
                line.close()

    def _await_first(self, timeout: float) -> None:
        try:
            with self._changed:
                if self._changed.wait_for(lambda: len(self._scans) > 0, timeout):
                    return
            raise LidarError(self._trouble())
        except BaseException:
            self.close()
            raise

    def _trouble(self) -> str:
        with self._changed:
            reason = "" if self._witness is None else self._witness.judge(
                self.port, listens=self._listen_only, has_replied=self.info is not None)
        faults = "" if not self.faults else f"; it reports {self.faults!r}"
        return f"{self.port}: {reason or 'it answers, but does not scan: its supply may fail'}{faults}"


def _info(native: Any) -> Info:
    serial = "".join(str(digit) for digit in native.serial)
    return Info(native.model, f"{native.firmware_major}.{native.firmware_minor}", native.hardware,
                serial)


def _chz(frequency_hz: float) -> int:
    """The frequency in 0.01 Hz, to the nearest 0.1 Hz."""
    if not isinstance(frequency_hz, numbers.Real):
        raise TypeError(f"frequency_hz is a number of 6 to 12, not {frequency_hz!r}")
    if not _FREQUENCY_MIN_HZ <= frequency_hz <= _FREQUENCY_MAX_HZ:
        raise ValueError(f"frequency_hz is 6 to 12, not {frequency_hz!r} (the baud rate is always "
                         "230400)")
    return round(frequency_hz * 10) * 10


_lidars: weakref.WeakSet[Lidar] = weakref.WeakSet()


def _after_fork() -> None:
    """The driver's thread stayed with the parent, and may have held the lock."""
    for lidar in _lidars:
        lidar._changed = threading.Condition()
        lidar._is_inherited = lidar._closing = True
        lidar._scans.clear()
        lidar._drop_line()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)
