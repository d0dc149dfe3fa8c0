# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""How the lidar sits on the robot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ._native import ffi


class Mount:
    """`front`: the lidar's angle, clockwise in whole degrees, that looks to the robot's front.
    `upside_down`: it hangs. `mask`: arcs (from, to), clockwise in whole degrees as the robot counts
    them, in which it sees itself: their ranges become NaN."""

    def __init__(self, front: int, upside_down: bool, mask: Sequence[tuple[int, int]]) -> None:
        self._arcs = ffi.new("tmini_arc_t[]", [(int(begin), int(end)) for begin, end in mask])
        self.native: Any = ffi.new("tmini_mount_t *", {
            "front_deg": int(front), "upside_down": upside_down, "masked": self._arcs,
            "masked_count": len(self._arcs)})
