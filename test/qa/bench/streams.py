# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The streams that go through the library, made by the independent encoder."""

import subprocess

from targets import HERE, ROOT, run

SUPPORT = ROOT / "test" / "support"
REVOLUTIONS = 20
PACKETS_A_REVOLUTION = 18  # 667 points: a start packet of one, 16 of 40, one of 26.

POINTS = 667  # A revolution at 6 Hz: 4000 samples per second (section 1).


def make(folder):
    """All streams by name, and how many packets the clean one has."""
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
    streams["clean packets"] = REVOLUTIONS * PACKETS_A_REVOLUTION
    return streams
