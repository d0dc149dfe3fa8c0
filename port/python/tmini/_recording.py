# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Recordings: raw bytes as the lidar sent them, or, in a file of `tmini record`, in chunks with
time stamps (examples/host/recording.h)."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator, Sequence
from typing import BinaryIO

from ._mount import Mount
from ._native import ffi, lib
from ._scan import Scan

_MAGIC = b"\x89tmini\x01\n"
_MAGIC_2 = b"\x89tmini\x02\n"
_BLOCK = 2048  # With the largest packet waiting for its last byte, this still fits in the ring.
_RING = 4096
_POINTS = 8192  # More than any revolution has.
_PAUSE_MS = 1000  # After so long without a packet any number of revolutions may be missing.


def _timed(file: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """Chunks: a header of microseconds since the chunk before and of bytes that follow."""
    at_us = 0
    while len(head := file.read(6)) == 6:
        passed_us, count = struct.unpack("<IH", head)
        at_us += passed_us
        yield at_us // 1000, file.read(count)


def _timed_2(file: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """The same with a marker before and a CRC after the header; damage is not looked for."""
    at_us = 0
    while len(head := file.read(10)) == 10:
        passed_us, count = struct.unpack("<2xIH2x", head)
        at_us += passed_us
        yield at_us // 1000, file.read(count)


def _blocks(file: BinaryIO) -> Iterator[tuple[int | None, bytes]]:
    """Bytes, and when they came in milliseconds; None: as 4000 samples per second do."""
    begun = file.read(len(_MAGIC))
    if begun == _MAGIC:
        yield from _timed(file)
        return
    if begun == _MAGIC_2:
        yield from _timed_2(file)
        return
    while begun:
        yield None, begun
        begun = file.read(65536)


class _Decoder:
    """Bytes to scans, as `tmini decode` makes them."""

    def __init__(self, mount: Mount) -> None:
        self._mount = mount
        self._memory = ffi.new("uint8_t[]", _RING)
        self._points = ffi.new("tmini_point_t[]", _POINTS)
        self._ring = ffi.new("tmini_ring_t *")
        self._parser = ffi.new("tmini_parser_t *")
        self._packet = ffi.new("tmini_packet_t *")
        self._ct = ffi.new("tmini_ct_t *")
        self._builder = ffi.new("tmini_builder_t *")
        lib.tmini_ring_init(self._ring, self._memory, _RING, False)
        lib.tmini_parser_init(self._parser, self._ring, 0)
        lib.tmini_ct_init(self._ct)
        lib.tmini_builder_init(self._builder, self._points, _POINTS, 0)
        self._samples = 0
        self._starts = 0
        self._packet_ms: int | None = None

    def feed(self, data: bytes, at_ms: int | None) -> Iterator[Scan]:
        for begin in range(0, len(data), _BLOCK):
            block = data[begin:begin + _BLOCK]
            lib.tmini_ring_write(self._ring, block, len(block))
            yield from self._parse(at_ms)

    def end(self, at_ms: int | None) -> Iterator[Scan]:
        """No more bytes come: what waits for more is examined, and the open scan ends."""
        while lib.tmini_parser_pending(self._parser) > 0:
            lib.tmini_parser_abandon(self._parser)
            yield from self._parse(at_ms)
        if self._builder.open:
            yield self._scan()

    def _parse(self, at_ms: int | None) -> Iterator[Scan]:
        while (frame := lib.tmini_parser_next(self._parser)) != lib.TMINI_FRAME_NONE:
            if frame == lib.TMINI_FRAME_PACKET:
                scan = self._take(self._samples // 4 if at_ms is None else at_ms)
                if scan is not None:
                    yield scan

    def _take(self, now_ms: int) -> Scan | None:
        packet, builder, scan = self._packet, self._builder, None
        lib.tmini_packet_open(packet, lib.tmini_parser_frame(self._parser))
        if self._packet_ms is not None and now_ms - self._packet_ms > _PAUSE_MS:
            packet.gap = lib.TMINI_GAP_UNKNOWN
        self._packet_ms = now_ms
        self._samples += packet.count
        if lib.tmini_ct_add(self._ct, packet) == lib.TMINI_CT_REFUTED:
            lib.tmini_builder_refute(builder)
        if lib.tmini_builder_add(builder, packet, now_ms):
            scan = self._scan()
            lib.tmini_builder_add(builder, packet, now_ms)
        if packet.ct & 1:
            self._starts += 1
        return scan

    def _scan(self) -> Scan:
        native = self._builder.scan
        lib.tmini_mount_step(self._mount.native, ffi.addressof(native))
        return Scan(native, self._starts, lib.tmini_ct_faults(self._ct), native.start_ms / 1000)


def read(path: str | os.PathLike[str], *, front: int = 0, upside_down: bool = False,
         mask: Sequence[tuple[int, int]] = ()) -> Iterator[Scan]:
    """The scans of a recording, one after the other: of a file of `tmini record` or of the viewer
    (.tmini), or of bytes as they came (.bin). The rest: see Mount."""
    with open(path, "rb") as file:
        decoder = _Decoder(Mount(front, upside_down, mask))
        at_ms: int | None = None
        for at_ms, data in _blocks(file):
            yield from decoder.feed(data, at_ms)
        yield from decoder.end(at_ms)
