#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Shows the room live in a window, with the front up: live.py PORT (needs matplotlib)."""

import signal
import sys

import matplotlib.pyplot as plt
import numpy as np

import tmini


def main(port: str) -> None:
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: sys.exit())  # Ends the `with`: the lidar stops.
    axes = plt.subplot(projection="polar", theta_offset=np.pi / 2)
    points = axes.scatter([], [], s=3, c=[], cmap="viridis", vmin=0, vmax=255)
    with tmini.Lidar(port, frequency_hz=6) as lidar:
        for scan in lidar:
            if not plt.get_fignums():
                break  # The window was closed.
            points.set_offsets(np.column_stack([scan.angles_rad, scan.ranges_m]))
            points.set_array(scan.intensities)
            axes.set_ylim(0, np.nanmax(scan.ranges_m, initial=1.0))
            axes.set_title("" if scan.complete else "incomplete")
            plt.pause(0.001)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
