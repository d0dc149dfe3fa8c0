# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Shows the lidar's scans live in Foxglove: open the address that is printed as a "Foxglove
WebSocket" connection; the topic is /scan."""

from __future__ import annotations

import argparse
import time

from ._command import add_lidar_arguments, load, open_lidar, scans_of
from ._laser import Laser

SUMMARY = "live in Foxglove"
_RAYS = 360


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_lidar_arguments(parser)
    parser.add_argument("--host", default="127.0.0.1", metavar="ADDRESS",
                        help="where to listen; 0.0.0.0: also for other computers")
    parser.add_argument("--tcp", type=int, default=8765, metavar="NUMBER",
                        help="the number of the TCP port; 0: any that is free (default: 8765)")
    parser.add_argument("--frame", default="laser", help="frame_id (default: laser)")


def run(arguments: argparse.Namespace) -> None:
    foxglove = load("foxglove", "foxglove")
    messages = load("foxglove.messages", "foxglove")
    channel = load("foxglove.channels", "foxglove").LaserScanChannel("/scan")
    laser = Laser(_RAYS, upside_down=arguments.upside_down)
    server = foxglove.start_server(name="tmini", host=arguments.host, port=arguments.tcp)
    try:
        print(f"ws://{arguments.host}:{server.port}", flush=True)
        with open_lidar(arguments) as lidar:
            for scan in scans_of(lidar):
                rays = laser.convert(scan)
                stamp_s = time.time() - time.monotonic() + rays.stamp_s
                channel.log(messages.LaserScan(
                    timestamp=messages.Timestamp.from_epoch_secs(stamp_s),
                    frame_id=arguments.frame, start_angle=rays.angle_min, end_angle=rays.angle_max,
                    ranges=rays.ranges.tolist(), intensities=rays.intensities.tolist()))
    finally:
        server.stop()
