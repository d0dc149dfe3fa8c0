# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Shows the lidar's scans live in Foxglove: open the address that is printed as a "Foxglove
WebSocket" connection; the topic is /scan."""

from __future__ import annotations

import argparse
import math
import time

from ._command import add_lidar_arguments, load, open_lidar, scans_of

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
    server = foxglove.start_server(name="tmini", host=arguments.host, port=arguments.tcp)
    try:
        print(f"ws://{arguments.host}:{server.port}", flush=True)
        with open_lidar(arguments) as lidar:
            for scan in scans_of(lidar):
                ranges, intensities = scan._rays(_RAYS)
                ended_s = time.time() - time.monotonic() + scan.end_s
                channel.log(messages.LaserScan(
                    timestamp=messages.Timestamp.from_epoch_secs(ended_s),
                    frame_id=arguments.frame, start_angle=0.0,
                    end_angle=2 * math.pi * (_RAYS - 1) / _RAYS, ranges=ranges.tolist(),
                    intensities=intensities.tolist()))
    finally:
        server.stop()
