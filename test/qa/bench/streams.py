# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The streams that go through the library, made by the independent encoder."""

import subprocess

from targets import HERE, ROOT, run

SUPPORT = ROOT / "test" / "support"
REVOLUTIONS = 20
PACKETS_A_REVOLUTION = 18  # 667 points: a start packet of one, 16 of 40, one of 26.

# Points a revolution at each scan frequency: 4000 samples a second (section 1).
POINTS = {6: 667, 8: 500, 10: 400, 12: 333}

# Bytes that an attacker could send: enough for a steady state, too few to be taken for a loss.
HOSTILE_SIZE = 8000
HEADER_STEPS = range(2, 13)

# What else makes a poll long: packets of so many samples, and so many AA before a long skip.
POINTS_A_PACKET = (1, 2, 3, 4, 6, 8, 12, 20, 40, 80)
MARKS = (68, 136)


def make(folder):
    """All streams by name, and how many packets the clean one has."""
    maker = folder / "streams"
    run("cc", "-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-I", SUPPORT,
        HERE / "streams.c", SUPPORT / "encoder.c", SUPPORT / "corrupt.c", SUPPORT / "random.c",
        "-o", maker)

    def made(*words):
        return subprocess.run([maker, *map(str, words)], capture_output=True, check=True).stdout

    streams = {
        "clean": made("clean", REVOLUTIONS, POINTS[6]),
        "corrupted": made("corrupted", REVOLUTIONS, POINTS[6]),
        "turn": made("clean", 2, POINTS[6]),
        "faulty": made("faulty", 4, POINTS[6]),
        "random": made("random", HOSTILE_SIZE, 0),
    }
    for frequency, points in POINTS.items():
        streams[f"{frequency} Hz"] = made("clean", REVOLUTIONS, points)
    for step in HEADER_STEPS:
        streams[f"headers {step}"] = made("headers", HOSTILE_SIZE, step)
    for count in POINTS_A_PACKET:
        streams[f"points {count}"] = made("points", HOSTILE_SIZE, count)
    for count in MARKS:
        streams[f"marks {count}"] = made("marks", HOSTILE_SIZE, count)
    streams["clean packets"] = REVOLUTIONS * PACKETS_A_REVOLUTION
    return streams
