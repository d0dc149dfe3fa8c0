# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Converts a recording, or writes what a lidar sends, to an MCAP file: messages
sensor_msgs/msg/LaserScan on /scan, for ROS 2 and Foxglove. Live times are those of this computer;
those of a recording count from its beginning."""

from __future__ import annotations

import argparse
import itertools
import os
import time
from collections.abc import Iterator
from typing import Any

from ._command import (CommandError, add_frequency_argument, add_mount_arguments, load, mount,
                       open_lidar, scans_of)
from ._laser import Laser, Rays
from ._recording import read
from ._scan import Scan

SUMMARY = "into a file for ROS 2 and Foxglove"
_BACKLOG = 100
_DEFINITION = """std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("port", metavar="SOURCE",
                        help="a recording, or the lidar's port: see `python -m tmini live --help`")
    parser.add_argument("file", metavar="FILE", help="the MCAP file to write")
    parser.add_argument("--force", action="store_true", help="overwrites it")
    parser.add_argument("--seconds", type=float, metavar="N", help="of a lidar: until Ctrl-C or N")
    parser.add_argument("--complete", action="store_true", help="leaves incomplete scans out")
    parser.add_argument("--rays", type=_even, default=360, metavar="N",
                        help="in each message, an even number (default: 360)")
    parser.add_argument("--frame", default="laser", help="frame_id (default: laser)")
    add_frequency_argument(parser)
    add_mount_arguments(parser)


def _even(text: str) -> int:
    number = int(text)
    if not 2 <= number <= 65534 or number % 2:
        raise ValueError
    return number


def run(arguments: argparse.Namespace) -> None:
    writer = load("mcap_ros2.writer", "mcap")
    if os.path.exists(arguments.file) and not arguments.force:
        raise CommandError(f"{arguments.file} exists; --force overwrites it")
    if os.path.isfile(arguments.port):
        scans = read(arguments.port, **mount(arguments))
        _write(arguments, writer, scans, 0.0)
    else:
        with open_lidar(arguments, _BACKLOG) as lidar:
            _write(arguments, writer, scans_of(lidar, arguments.seconds),
                   time.time() - time.monotonic())


def _write(arguments: argparse.Namespace, writer: Any, scans: Iterator[Scan],
           epoch_s: float) -> None:
    first = list(itertools.islice(scans, 1))  # Without a scan no file is made.
    written = incomplete = 0
    laser = Laser(arguments.rays, upside_down=arguments.upside_down)
    with open(arguments.file, "wb") as file, writer.Writer(file) as mcap:
        schema = mcap.register_msgdef("sensor_msgs/msg/LaserScan", _DEFINITION)
        try:
            for scan in itertools.chain(first, scans):
                incomplete += not scan.complete
                if scan.complete or not arguments.complete:
                    rays = laser.convert(scan)
                    stamp_ns = round((epoch_s + rays.stamp_s) * 1e9)
                    mcap.write_message("/scan", schema,
                                       message_of(rays, stamp_ns, arguments.frame), stamp_ns)
                    written += 1
        except KeyboardInterrupt:
            pass  # The usual end of a live recording.
    left_out = ", left out" if arguments.complete and incomplete else ""
    print(f"{arguments.file}: {written} scans; {incomplete} incomplete{left_out}")


def message_of(rays: Rays, stamp_ns: int, frame: str) -> dict[str, Any]:
    fields = {name: value for name, value in vars(rays).items() if name != "stamp_s"}
    stamp = {"sec": stamp_ns // 10**9, "nanosec": stamp_ns % 10**9}
    return {**fields, "header": {"stamp": stamp, "frame_id": frame},
            "ranges": rays.ranges.tolist(), "intensities": rays.intensities.tolist()}
