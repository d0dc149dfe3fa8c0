# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""What a lidar has seen in one revolution, as NumPy arrays."""

from __future__ import annotations

import enum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._native import ffi, lib

_POINT = np.dtype([("angle_q6", "=u2"), ("distance_mm", "=u2"), ("intensity", "u1"), ("flag", "u1")])


class Fault(enum.IntFlag):
    """What may be wrong with a lidar; false when nothing is."""

    SENSOR = 1
    ENCODER = 2  # Rotor blocked?
    WIRELESS_POWER = 4
    PD = 8  # Laser feedback voltage.
    LD = 16  # Laser drive current.
    DATA = 32  # No range in a whole revolution: window covered?
    FREQUENCY = 64  # Another frequency than the wanted one.


class Scan:
    """One revolution. The arrays have an element per point, in the order of measurement; they are
    created when first used, and may be changed."""

    number: int  # Revolutions since the beginning, including this one; a step of 2: one was missed.
    complete: bool  # A full circle, with nothing missing.
    frequency_hz: float | None  # Measured by the lidar. None: unknown.
    faults: Fault | None  # None: unknown; Fault(0): healthy.
    packets: int
    gaps: int  # Places where bytes are missing.
    dropped: int  # Points that did not fit.
    checksum_errors: int
    start_s: float  # On the clock time.monotonic(); of a recording, since its beginning.

    def __init__(self, native: Any, number: int, faults: int, start_s: float) -> None:
        self.number = number
        self.complete = native.complete
        self.frequency_hz = native.frequency_chz / 100 if native.frequency_chz else None
        self.faults = None if faults == lib.TMINI_FAULTS_UNKNOWN else Fault(faults)
        self.packets = native.packets
        self.gaps = native.gaps
        self.dropped = native.dropped
        self.checksum_errors = native.checksum_errors
        self.start_s = start_s
        self._native = ffi.new("tmini_scan_t *", native)
        self._points = bytes(ffi.buffer(native.points, native.count * _POINT.itemsize))

    def __len__(self) -> int:
        return self._native.count

    def __repr__(self) -> str:
        return (f"<tmini.Scan {self.number}: {len(self)} points, "
                f"{'complete' if self.complete else 'incomplete'}>")

    @property
    def _table(self) -> NDArray[Any]:
        return np.frombuffer(self._points, _POINT)

    @cached_property
    def angles_deg(self) -> NDArray[np.float64]:
        """Clockwise seen from above, from the front: 0 to 359.984375. Exact."""
        return self._table["angle_q6"] / 64.0

    @cached_property
    def angles_rad(self) -> NDArray[np.float64]:
        """Counter-clockwise from the front, -pi to pi, as ROS has them: x = range * cos(angle) is
        ahead, y = range * sin(angle) to the left."""
        angles = self.angles_deg
        return np.deg2rad(np.where(angles <= 180, -angles, 360 - angles))

    @cached_property
    def ranges_m(self) -> NDArray[np.float64]:
        """Distances in metres; NaN where there is no valid range: neither near nor free."""
        ranges = self._table["distance_mm"] / 1000.0
        ranges[ranges == 0] = np.nan
        return ranges

    @cached_property
    def intensities(self) -> NDArray[np.uint8]:
        """0 to 255."""
        return self._table["intensity"].copy()

    @cached_property
    def flags(self) -> NDArray[np.uint8]:
        """As sent: 2 specular reflection, 3 ambient light."""
        return self._table["flag"].copy()

    @cached_property
    def times_s(self) -> NDArray[np.float64]:
        """When each point was measured, on the clock of start_s."""
        times = np.empty(len(self), np.uint32)
        self._native.points = ffi.from_buffer("tmini_point_t[]", self._points)
        lib.point_times_us(self._native, ffi.from_buffer("uint32_t[]", times))
        return self.start_s + times / 1e6
