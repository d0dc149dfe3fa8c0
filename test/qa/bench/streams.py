# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Makes the streams for the measurements, with the independent encoder."""

import subprocess

from targets import HERE, ROOT, run

SUPPORT = ROOT / "test" / "support"
REVOLUTIONS = 20
PACKETS_PER_REVOLUTION = 18  # 667 points: one start packet with 1 point, 16 packets with 40, one with 26.

POINTS = 667  # Points per revolution at 6 Hz, with 4000 samples per second (section 1).


def make(folder):
    """All streams by name, and the number of packets in the clean one."""
    maker = folder / "streams"
    run("cc", "-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-I", SUPPORT,
        HERE / "streams.c", SUPPORT / "encoder.c", SUPPORT / "corrupt.c", SUPPORT / "random.c",
        "-o", maker)

    def made(*words):
        return subprocess.run([maker, *map(str, words)], capture_output=True, check=True).stdout

    streams = {
        "clean": made("clean", REVOLUTIONS, POINTS),
        "corrupted": made("corrupted", REVOLUTIONS, POINTS),
        "turn": made("clean", 2, POINTS),
        "faulty": made("faulty", 4, POINTS),
    }
    streams["clean packets"] = REVOLUTIONS * PACKETS_PER_REVOLUTION
    return streams
