# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Instructions a byte on this computer, counted by callgrind."""

import re

from targets import HERE, LIB_SOURCES, ROOT, BenchError, run

# What the compiler makes of copies: counted too, but these functions differ between computers.
COPIES = re.compile(r"mem(cpy|move|set)")


def build(folder):
    """The host's program with the library at -O2."""
    program = folder / "host"
    run("cc", "-std=c99", "-O2", "-g", f"-ffile-prefix-map={ROOT}=.", "-I",
        ROOT / "lib" / "include", HERE / "host" / "main.c", *LIB_SOURCES, "-o", program)
    return program


def read_profile(text):
    """Instructions spent in the library's own sources, and in copies, from callgrind's output."""
    names = {}

    def full(compressed):
        number, _, name = compressed.partition(" ")
        if name:
            names[number] = name
        return names[number]

    own = copies = 0
    file = function = ""
    called = False
    for line in text.splitlines():
        key, equals, value = line.partition("=")
        if equals and key in ("fl", "fi", "fe"):
            file = full("f" + value)
        elif equals and key == "fn":
            function = full("n" + value)
        elif equals and key in ("cfi", "cfl"):
            full("f" + value)
        elif equals and key == "cfn":
            full("n" + value)
        elif key == "calls":
            called = True  # The next line's cost is the callee's.
        elif re.match(r"[+*\-\d]", line):
            cost = 0 if called else int(line.split()[1])
            called = False
            if "lib/src/" in file or "lib/include/" in file:
                own += cost
            elif COPIES.search(function):
                copies += cost
    return own, copies


def count(program, feed, recording, folder):
    """(packets found, the library's own instructions, instructions in copies)."""
    out = folder / f"callgrind.{feed}"
    printed = run("valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", "-q", program,
                  feed, recording)
    own, copies = read_profile(out.read_text())
    if own == 0:
        raise BenchError("callgrind's output shows none of the library's sources")
    return int(printed), own, copies


def measure(program, recording, folder):
    """Instructions a byte by way of feeding: the library's own and those of copies."""
    size = recording.stat().st_size
    results = {}
    for feed in ("bytes", "blocks", "decode"):
        packets, own, copies = count(program, feed, recording, folder)
        results[feed] = {"packets": packets, "own": own / size, "copies": copies / size}
    return results
