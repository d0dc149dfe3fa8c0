# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Counts instructions per byte on this computer with callgrind: those of the library, of the C library's copy
functions, of the port, and of the program's loop around them."""

import re

from targets import HERE, LIB_SOURCES, ROOT, BenchError, run

PACKET = 131  # Bytes per block: about a packet, or 10 ms.


def build(folder):
    program = folder / "host"
    run("cc", "-std=c99", "-O2", "-g", f"-ffile-prefix-map={ROOT}=.", "-I", ROOT / "lib" / "include",
        "-I", HERE, HERE / "host" / "main.c", HERE / "emulated" / "main.c", *LIB_SOURCES, "-o", program)
    return program


def count(program, way, recording, block, folder):
    """The instructions per byte in one way of decoding, and the number of packets found."""
    out = folder / f"callgrind.{way}"
    packets = run("valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", "-q",
                  "--collect-atstart=no", "--toggle-collect=counted_run*", program, way, recording,
                  block)
    total = re.search(r"^(?:summary|totals): (\d+)", out.read_text(), re.MULTILINE)
    if total is None or int(total[1]) == 0:
        raise BenchError("callgrind has counted nothing")
    return int(total[1]) / recording.stat().st_size, int(packets)


def measure(folder, clean, packets, blocks):
    """The instructions per byte by way of feeding and by number of bytes per poll."""
    program = build(folder)
    recording = folder / "clean.bin"
    recording.write_bytes(clean)

    def cost(way, block=PACKET):
        each, found = count(program, way, recording, block, folder)
        if found != packets:
            raise BenchError(f"{way}: {found} packets are found instead of {packets}")
        return each

    return {"bytes": cost("bytes"), "blocks": cost("blocks"), "decode": cost("decode"),
            "per poll": {block: {way: cost(way, block) for way in ("bytes", "blocks")}
                         for block in blocks}}
