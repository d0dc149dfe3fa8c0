# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""How long a buffer lasts is said by one rule everywhere, that of docs/footprint.md, "How often to
poll": a receive buffer (size - 129) / 23.04 ms, with DMA half of its size likewise, and any other
queue its size / 23.04.

    polling.py

Exit status: 0 all say the same, 1 not; every place that does not is told.
"""

import re
import sys

from documents import ROOT, documents, name

LINE_BYTES_A_MS = 23.04
WAITING = 129  # Of a packet that has not come as a whole.

TIME = r"(\d+(?:\.\d+)?) (m?s)\b"
SAYINGS = (
    # 1024 bytes last 38 ms; 2048 bytes for 89 ms
    re.compile(rf"(?P<size>\d+) bytes (?:last|hold|bear|for)(?: for)? {TIME}"),
    # 38 ms with 1024 bytes; 43 ms with a ring of 1024; 38 ms with `rx_buffer` of 1024
    re.compile(rf"{TIME}\W* (?:more )?with\s(?:[`\w]+\s){{0,2}}(?:of )?(?P<size>\d{{3,}})\b"),
    # 1024 bytes (44 ms)
    re.compile(rf"(?P<size>\d+) bytes,? \(?{TIME}"),
)


def allowed(size):
    """The milliseconds that may be said of a buffer, rounded as they are."""
    return [bytes_free / LINE_BYTES_A_MS for bytes_free in (
        size - WAITING, size // 2 - WAITING, size, size - 16)]


def is_right(size, text, unit):
    said = float(text) * (1000 if unit == "s" else 1)
    step = 10 ** -len(text.partition(".")[2]) * (1000 if unit == "s" else 1)
    return any(abs(said - true) <= step for true in allowed(size))


def texts():
    yield from documents()
    for pattern in ("lib/**/*.[ch]", "port/**/*.[ch]", "port/**/*.cpp", "examples/**/*.[ch]",
                    "Kconfig"):
        yield from sorted(ROOT.glob(pattern))


def main():
    complaints, count = [], 0
    for path in texts():
        text = re.sub(r"\s*\n[\s*]*", " ", path.read_text(encoding="utf-8")).replace("*", "")
        for saying in SAYINGS:
            for found in saying.finditer(text):
                count += 1
                size = int(found["size"])
                time = [group for group in found.groups() if group != found["size"]][:2]
                if not is_right(size, *time):
                    complaints.append(f"{name(path)}: {found[0]}")
    if count < 15:
        complaints.append(f"only {count} sayings have been found: is this check still one?")
    print("\n".join(complaints) or f"all of {count} sayings are by the rule")
    sys.exit(1 if complaints else 0)


main()
