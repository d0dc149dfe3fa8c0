# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Makes the streams for the measurements, with the independent encoder."""

import subprocess

from targets import HERE, ROOT, run

SUPPORT = ROOT / "test" / "support"
REVOLUTIONS = 20
PACKETS_PER_REVOLUTION = 18  # 667 points: one start packet with 1 point, 16 packets with 40, one with 26.


def make(folder):
    """All streams by name, and the number of packets in the clean one."""
    maker = folder / "streams"
    run("cc", "-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-I", SUPPORT,
        HERE / "streams.c", SUPPORT / "encoder.c", SUPPORT / "corrupt.c", SUPPORT / "random.c",
        "-o", maker)

    def made(*words):
        return subprocess.run([maker, *map(str, words)], capture_output=True, check=True).stdout

    encoder_fault = 2
    return {"clean": made(REVOLUTIONS), "clean packets": REVOLUTIONS * PACKETS_PER_REVOLUTION,
            "corrupted": made(REVOLUTIONS, 0, 500), "turn": made(2), "faulty": made(4, encoder_fault)}
