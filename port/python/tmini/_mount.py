# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""How the lidar is mounted on the robot."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import Any

from ._native import ffi


class Mount:
    """`front`: the lidar's angle that points to the robot's front, clockwise in degrees.
    `upside_down`: the lidar is upside down. `mask`: arcs (from, to) in which the lidar sees the
    robot itself, clockwise in whole degrees from the robot's front: their ranges become NaN.
    `offset_mm`: added to each range. `tmini calibrate` of the C tool finds all of them."""

    def __init__(self, front: float, upside_down: bool, mask: Sequence[tuple[int, int]],
                 offset_mm: int) -> None:
        self._arcs = ffi.new("tmini_arc_t[]", [(int(begin), int(end)) for begin, end in mask])
        self.native: Any = ffi.new("tmini_mount_t *", {
            "front_q6": round(front * 64), "upside_down": upside_down,
            "offset_mm": operator.index(offset_mm), "masked": self._arcs,
            "masked_count": len(self._arcs)})
