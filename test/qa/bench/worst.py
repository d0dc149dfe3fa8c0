# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Searches for the bytes that make one poll as long as possible: mixes ingredients, and keeps the worst mix.

A poll ends at a limit for its estimated effort. Each ingredient costs more than the driver's estimate, and a poll may
begin its largest packet just before the limit.
"""

import random

from lidar_bytes import packet

SIZE = 4096  # The largest ring in the tables.
TRIALS = 1200
STARTS = 12  # First mixes; each gets an equal share of the trials.
MS = (1, 10, 100)


def points(parameter):
    """A packet of 1 to 80 samples with LSA just below FSA, so that its angles wrap. From parameter 80 on, the
    samples have ranges and a flag."""
    samples = 1 + parameter % 80
    first = 6400
    last = first if samples == 1 else first - 1
    return packet([(10901, 1, 3) if parameter >= 80 else (0, 0, 0)] * samples, first, last)


def header(parameter):
    """A false header for 1 to 80 samples, cut off after 2 to 12 bytes."""
    return bytes([0xAA, 0x55, 0, 1 + parameter % 80, 1, 1, 1, 1, 1, 1, 1, 1])[:2 + parameter % 11]


INGREDIENTS = {
    "marks": lambda _: b"\xAA\x55",
    "firsts": lambda _: b"\xAA",
    "zeros": bytes,
    "header": header,
    "points": points,
}


def any_part(source):
    return (source.choice(list(INGREDIENTS)), source.randrange(160), source.randrange(1, 160))


def any_mix(source):
    """A random mix: its position in the ring, the pause before it in ms, and its parts."""
    return (source.randrange(SIZE), source.choice(MS), [any_part(source) for _ in range(3)])


def changed(mix, source):
    """A mix that differs a little."""
    begin, pause_ms, parts = mix
    parts = list(parts)
    at = source.randrange(len(parts))
    name, parameter, count = parts[at]
    kind = source.randrange(6)
    if kind == 0:
        parts[at] = any_part(source)
    elif kind == 1:
        parts[at] = (name, source.randrange(160), count)
    elif kind == 2:
        begin = (begin + source.choice((-64, -8, -1, 1, 8, 64, SIZE // 2))) % SIZE
    elif kind == 3:
        pause_ms = source.choice(MS)
    else:
        parts[at] = (name, parameter, max(1, count + source.choice((-16, -4, -1, 1, 4, 16))))
    return begin, pause_ms, parts


def stream_of(mix):
    """A mix as bytes. It begins with a start packet, so that the scan has room for points."""
    stream = packet([(0, 0, 0)], 0, 0, ct=1)
    for name, parameter, count in mix[2]:
        stream += INGREDIENTS[name](parameter) * count
    return stream.ljust(SIZE, b"\0")[:SIZE]


def search(cost):
    """The highest cost(mix) found, and the mix."""
    source = random.Random(1)
    first = (0, 10, [("marks", 0, 120), ("points", 79, 1), ("zeros", 1, 1)])
    worst = (0, None)
    for start in range(STARTS):
        mix = any_mix(source) if start > 0 else first
        best = (cost(mix), mix)
        for _ in range(TRIALS // STARTS):
            other = changed(best[1], source)
            best = max(best, (cost(other), other), key=lambda pair: pair[0])
        worst = max(worst, best, key=lambda pair: pair[0])
    return worst
