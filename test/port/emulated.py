#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Runs an example's firmware on QEMU's lm3s6965evb against the simulated lidar.

The board's first UART is the console; the lidar is on the second. The firmware must print the lidar's model
and then, once per second, the number of scans and what was lost. The test passes if there are enough scans and
nothing was lost. It is tried up to three times: on a busy computer the emulator may be too slow for the lidar.

Exit status: 0 as expected, 1 not.
"""

import argparse
import re
import subprocess
import sys
import threading

INFO = re.compile(r"model 151, firmware \d+\.\d+, hardware 1, serial \d{16}")
LINE = re.compile(r"(\d+) scans, .* lost: (\d+) checksums, (\d+) bytes, (\d+) gaps")
TRIES = 3
MOST_SECONDS = 60


def run(args):
    sim = subprocess.Popen([args.sim, "--tcp", "0"], stdout=subprocess.PIPE)
    address = sim.stdout.readline().decode().strip()
    qemu = subprocess.Popen(
        [args.qemu, "-M", "lm3s6965evb", "-display", "none", "-monitor", "none", "-serial", "stdio",
         "-serial", f"tcp:{address}", "-kernel", args.firmware],
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    watchdog = threading.Timer(MOST_SECONDS, qemu.kill)
    watchdog.start()
    try:
        return watch(qemu, args.scans)
    finally:
        watchdog.cancel()
        for process in (qemu, sim):
            process.kill()
            process.wait()


def watch(qemu, scans):
    """Waits for a console line with this many scans. Returns its numbers of losses; None if the console ends first."""
    has_info = False
    for line in qemu.stdout:
        text = line.decode("ascii", "replace").strip()
        print(text, flush=True)
        has_info = has_info or INFO.search(text) is not None
        numbers = LINE.search(text)
        if numbers is not None and int(numbers[1]) >= scans:
            return [int(number) for number in numbers.groups()[1:]] if has_info else None
    return None


def main():
    parser = argparse.ArgumentParser()
    for name in ("--sim", "--qemu", "--firmware"):
        parser.add_argument(name, required=True)
    parser.add_argument("--scans", type=int, default=15)
    args = parser.parse_args()
    for _ in range(TRIES):
        lost = run(args)
        if lost == [0, 0, 0]:
            return 0
        print(f"not as expected: {lost}", flush=True)
    return 1


if __name__ == "__main__":
    sys.exit(main())
