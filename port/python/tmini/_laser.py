# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Scans as the ROS node publishes them, by its own conversion: rays at equal angles,
counter-clockwise, from where the lidar begins its turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ._native import ffi, lib
from ._scan import POINT, Scan


@dataclass
class Rays:
    """The fields of a LaserScan of ROS; stamp_s is on the clock of the scan."""

    stamp_s: float
    angle_min: float
    angle_max: float
    angle_increment: float
    time_increment: float
    scan_time: float
    range_min: float
    range_max: float
    ranges: NDArray[np.float32]
    intensities: NDArray[np.float32]


class Laser:
    def __init__(self, rays: int, *, upside_down: bool) -> None:
        """`upside_down`: scans come from a mount that is."""
        self._rays, self._upside_down = rays, upside_down
        config = ffi.new("tmini_laser_config_t *", lib.tmini_laser_default)
        config.rays, config.is_mirrored = rays, upside_down
        self._native = ffi.new("tmini_laser_t *")
        lib.tmini_laser_init(self._native, config)

    def convert(self, scan: Scan) -> Rays:
        points = np.frombuffer(scan._points, POINT).copy()
        if self._upside_down:  # Back to the lidar's own sense of rotation: the conversion turns it.
            points["angle_q6"] = -points["angle_q6"].astype(int) % (360 * 64)
        memory = ffi.from_buffer("tmini_point_t[]", points)
        native = ffi.new("tmini_scan_t *", {
            "points": memory, "count": len(scan), "complete": scan.complete,
            "frequency_chz": round((scan.frequency_hz or 0) * 100),
            "end_ms": round((scan.end_s - scan.start_s) * 1000)})
        ranges, intensities = np.empty((2, self._rays), np.float32)
        fields = ffi.new("tmini_laser_fields_t *")
        lib.tmini_laser_of_scan(self._native, native, ffi.from_buffer("float[]", ranges),
                                ffi.from_buffer("float[]", intensities), fields)
        return Rays(scan.end_s + fields.stamp_us / 1e6, fields.angle_min, fields.angle_max,
                    fields.angle_increment, fields.time_increment, fields.scan_time,
                    fields.range_min, fields.range_max, ranges, intensities)
