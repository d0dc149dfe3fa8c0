# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Scans of a YDLIDAR T-mini Plus:

    with tmini.Lidar("/dev/ttyUSB0", frequency_hz=10) as lidar:
        for scan in lidar:
            print(numpy.nanmin(scan.ranges_m))

    for scan in tmini.read("room.tmini"):
        ...
"""

from importlib.metadata import version as _version

from ._find import find
from ._lidar import Info, Lidar, LidarError
from ._recording import read
from ._scan import Fault, Scan, Sector

__all__ = ["Fault", "Info", "Lidar", "LidarError", "Scan", "Sector", "find", "read"]
__version__ = _version("tmini")
