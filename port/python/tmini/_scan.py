# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""What a lidar has seen in one revolution, as NumPy arrays."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._native import ffi, lib

POINT = np.dtype([("angle_q6", "=u2"), ("distance_mm", "=u2"), ("intensity", "u1"), ("flag", "u1")])
_PARTS_MAX = 65535


class Fault(enum.IntFlag):
    """What may be wrong with a lidar; false when nothing is."""

    SENSOR = 1
    ENCODER = 2  # Rotor blocked?
    WIRELESS_POWER = 4
    PD = 8  # Laser feedback voltage.
    LD = 16  # Laser drive current.
    DATA = 32  # No range in a whole revolution: window covered?
    FREQUENCY = 64  # Another frequency than the wanted one.


@dataclass(frozen=True)
class Sector:
    """The nearest point in a part of the circle. A sector without a valid range is blind, which
    does not mean free: nearest_m and angle_deg are NaN."""

    nearest_m: float
    angle_deg: float
    points: int
    ranges: int  # How many of the points have a range.

    @property
    def is_blind(self) -> bool:
        return self.ranges == 0

    def is_free(self, distance_m: float) -> bool:
        """Not blind, and nothing nearer was seen. If the scan is not complete, do not trust it."""
        return self.nearest_m >= distance_m


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
    end_s: float
    period_s: float | None  # How long the whole revolution took. None: unknown.

    def __init__(self, native: Any, number: int, faults: int, start_s: float) -> None:
        period_ms = lib.tmini_scan_period_ms(ffi.addressof(native))
        self.number = number
        self.complete = native.complete
        self.frequency_hz = native.frequency_chz / 100 if native.frequency_chz else None
        self.faults = None if faults == lib.TMINI_FAULTS_UNKNOWN else Fault(faults)
        self.packets = native.packets
        self.gaps = native.gaps
        self.dropped = native.dropped
        self.checksum_errors = native.checksum_errors
        self.start_s = start_s
        self.end_s = start_s + ((native.end_ms - native.start_ms) & 0xFFFFFFFF) / 1000
        self.period_s = period_ms / 1000 if period_ms else None
        self._points = bytes(ffi.buffer(native.points, native.count * POINT.itemsize))
        times_us = ffi.new("uint32_t[]", native.count)
        lib.point_times_us(ffi.addressof(native), times_us)
        self._times_us = bytes(ffi.buffer(times_us))

    def __len__(self) -> int:
        return len(self._points) // POINT.itemsize

    def __repr__(self) -> str:
        return (f"<tmini.Scan {self.number}: {len(self)} points, "
                f"{'complete' if self.complete else 'incomplete'}>")

    @property
    def _table(self) -> NDArray[Any]:
        return np.frombuffer(self._points, POINT)

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
        return _metres(self._table["distance_mm"])

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
        return self.start_s + np.frombuffer(self._times_us, np.uint32) / 1e6

    def bins(self, count: int = 360) -> NDArray[np.float64]:
        """The nearest distance in each of `count` equal parts of the circle, in metres; NaN where
        there is none. Bin i is centred on i * 360 / count degrees, clockwise as in angles_deg: of
        360, bin 0 is ahead, bin 90 to the right."""
        return _metres(np.array([sector.nearest_mm for sector in self._sectors(count)]))

    def sectors(self, count: int = 8) -> list[Sector]:
        """The nearest point in each of `count` equal parts of the circle, as in bins()."""
        return [Sector(sector.nearest_mm / 1000 if sector.ranges else math.nan,
                       sector.angle_q6 / 64 if sector.ranges else math.nan,
                       sector.points, sector.ranges) for sector in self._sectors(count)]

    def _sectors(self, count: int) -> Any:
        if not 1 <= count <= _PARTS_MAX:
            raise ValueError(f"{count} parts of a circle: 1 to {_PARTS_MAX} are possible")
        sectors, array = ffi.new("tmini_sectors_t *"), ffi.new("tmini_sector_t[]", count)
        lib.tmini_sectors_init(sectors, array, count, 0)
        points = ffi.from_buffer("tmini_point_t[]", self._points)
        lib.tmini_sectors_add_scan(
            sectors, ffi.new("tmini_scan_t *", {"points": points, "count": len(self)}))
        return array


def _metres(distances_mm: NDArray[Any]) -> NDArray[np.float64]:
    metres = distances_mm / 1000.0
    metres[metres == 0] = np.nan
    return metres
