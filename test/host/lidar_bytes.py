# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Bytes as the lidar sends them, and what they mean: written from docs/protocol.md alone."""

import binascii
import functools
import operator
import random
import struct

MAGIC = b"\x89tmini\x02\n"  # Of a timed stream or recording.

# The reply to A5 90: model 151, firmware 1.2, hardware 1, and a serial number.
INFORMATION = bytes.fromhex("A55A140000000497020101" "02000206000301070000000102030405")

# A receiver with the wrong baud rate receives other bytes than were sent, and no packet.
NOISE = bytes.fromhex("334CF800806699E61E")


FULL_TURN_Q6 = 360 * 64


def checksum(content):
    """Of a packet whose own checksum is ignored. Intensities are words whose high byte is 0."""
    samples = (content[at:at + 3] for at in range(10, len(content), 3))
    words = content[:8] + b"".join(bytes([sample[0], 0]) + sample[1:] for sample in samples)
    return functools.reduce(operator.xor, struct.unpack(f"<{len(words) // 2}H", words))


def packet(samples, first_q6, last_q6, ct=0):
    """A packet; its samples are (distance_mm, intensity, flag)."""
    content = b"".join(struct.pack("<BH", intensity, distance << 2 | flag) for distance, intensity, flag in samples)
    head = struct.pack("<HBBHH", 0x55AA, ct, len(samples), first_q6 << 1 | 1, last_q6 << 1 | 1)
    return head + struct.pack("<H", checksum(head + b"\0\0" + content)) + content


def turn(samples, ct=121):
    """A turn at 6 Hz with samples at 0, 90, 180 and 270 degrees, and the beginning of the next."""
    start = packet(samples[:1], 0, 0, ct)
    return start + packet(samples[1:], 90 * 64, 270 * 64) + start


def chunk(delta_us, content, version=2):
    """A chunk of it, this many microseconds after the one before."""
    head = struct.pack("<IH", delta_us, len(content))
    crc = struct.pack("<H", binascii.crc_hqx(head + content, 0xFFFF))
    return (b"\xA7\xC3" + head + crc if version == 2 else head) + content


def timed(*chunks, version=2):
    """A timed recording of (microseconds since the one before, bytes)."""
    return MAGIC[:6] + bytes([version]) + MAGIC[7:] + b"".join(chunk(*one, version) for one in chunks)


def chunks(content, step_us=10000, size=131):
    """Chunks of what a scanning lidar sends."""
    return [chunk(step_us, content[at:at + size]) for at in range(0, len(content), size)]


def decode(stream, max_samples=80):
    """The packets in a stream, as plainly as can be, and what the tool counts."""
    packets, counts, at = [], {"checksum_errors": 0, "bytes": len(stream), "bytes_skipped": 0}, 0
    while at < len(stream):
        head = stream[at:at + 10]
        content = stream[at:at + 10 + 3 * head[3]] if len(head) == 10 else b""
        is_packet = len(head) == 10 and head[:2] == b"\xAA\x55" and 1 <= head[3] <= max_samples and \
            head[4] & head[6] & 1 and (head[3] == 1 or not head[2] & 1) and len(content) == 10 + 3 * head[3]
        if is_packet and checksum(content) == int.from_bytes(head[8:10], "little"):
            packets.append(content)
            at += len(content)
        else:
            counts["checksum_errors"] += 1 if is_packet else 0
            counts["bytes_skipped"] += 1
            at += 1
    return packets, {"packets": len(packets), "start_packets": sum(content[2] & 1 for content in packets),
                     "points": sum(content[3] for content in packets), **counts}


def points(content):
    """A packet's points: (angle_q6, distance_mm, intensity, flag). Angles are rounded, halves up."""
    first, last = ((word >> 1) % FULL_TURN_Q6 for word in struct.unpack("<HH", content[4:8]))
    steps = max(content[3] - 1, 1)
    for i, (intensity, word) in enumerate(struct.iter_unpack("<BH", content[10:])):
        moved = (last - first) % FULL_TURN_Q6 * i
        angle = (2 * (first * steps + moved) + steps) // (2 * steps) % FULL_TURN_Q6
        yield angle, word >> 2, intensity, word & 3


def damaged(stream, faults, seed):
    """The stream as a bad line makes it: bytes lost, changed and added, also such as look like headers."""
    draw, stream = random.Random(seed), bytearray(stream)
    garbage = lambda count: bytes(draw.choice(b"\xAA\x55\xAA\x55\xA5\x5A\0\1\2\3\x28\x81" + draw.randbytes(12))
                                  for _ in range(count))
    for _ in range(faults):
        if not stream:
            break
        at, few, some = draw.randrange(len(stream)), draw.randint(2, 32), draw.randint(2, 200)
        removed, added = draw.choice([(1, b""), (some, b""), (0, garbage(1)), (0, garbage(few)), (few, garbage(few)),
                                      (1, bytes([stream[at] ^ 1 << draw.randrange(8)]))])
        stream[at:at + removed] = added
    return bytes(stream)
