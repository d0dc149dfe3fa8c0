# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Recordings: raw bytes as the lidar sent them, or, in a file of `tmini record`, in chunks with
time stamps."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Sequence
from typing import Any

from ._mount import Mount
from ._native import ffi, lib
from ._scan import Scan

_BLOCK = 16384


def read(path: str | os.PathLike[str], *, front: float = 0, upside_down: bool = False,
         mask: Sequence[tuple[int, int]] = (), offset_mm: int = 0) -> Iterator[Scan]:
    """The scans of a recording, one after the other: of a file of `tmini record` or of the viewer
    (.tmini), or of bytes as they came (.bin). Other parameters: see Mount. Raises ValueError if the
    file holds no packets of a lidar. Of a damaged recording the intact parts are read, with a
    RuntimeWarning."""
    mount = Mount(front, upside_down, mask, offset_mm)
    tape = ffi.new("tape_t *")
    lib.tape_begin(tape, mount.native, 0)
    data = b""
    with open(path, "rb") as file:
        while (found := lib.tape_next_scan(tape)) != lib.TAPE_END:
            if found == lib.TAPE_NEEDS_BYTES:
                data = data or file.read(_BLOCK)
                data = data[lib.tape_feed(tape, data, len(data)):]
            else:
                yield _scan(tape.stream)
    _judge(path, tape)


def _scan(stream: Any) -> Scan:
    native = stream.scan
    faults = lib.stream_faults(ffi.addressof(stream))
    return Scan(native, stream.number, faults, native.start_ms / 1000)


def _judge(path: str | os.PathLike[str], tape: Any) -> None:
    name = os.fspath(path)
    if tape.chunks.version > lib.CHUNK_VERSION:
        raise ValueError(f"{name} is of version {tape.chunks.version}: too new for this package")
    if tape.bytes == 0:
        raise ValueError(f"{name} is empty: nothing was recorded")
    if tape.stream.packets == 0:
        raise ValueError(f"{name} holds no lidar packet in {tape.bytes} bytes: another device, or "
                         "another baud rate than 230400, or the lidar did not scan")
    if tape.chunks.damages > 0:
        places = f"{tape.chunks.damages} place{'s' if tape.chunks.damages > 1 else ''}"
        warnings.warn(f"{name} is damaged in {places}: bytes are missing or wrong there",
                      RuntimeWarning, stacklevel=3)
