# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Finds a lidar by its serial number."""

from __future__ import annotations

import glob
import logging
import os
import re
import time
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from serial.tools.list_ports import comports

from ._line import Line, open_line
from ._native import ffi, lib

# The chips of lidars' USB adapters, as the tool knows them.
_CHIPS = {(0x10C4, 0xEA60), (0x1A86, 0x7523), (0x1A86, 0x55D4), (0x067B, 0x2303),
          (0x0403, 0x6001), (0x0403, 0x6015), (0x0483, 0x5740)}
_LISTEN_S = 0.4  # A lidar that scans sends a packet every 10 ms; after a stop, up to 0.3 s longer.
_HEARD_TIMES = 3  # Its serial number comes per turn, but a busy computer loses bytes.
_ASK_S = 0.7
_ASKED_TIMES = 3
_ASK_INFO = b"\xa5\x90"
_INFO = re.compile(rb"\xa5\x5a\x14\x00\x00\x00\x04.{4}([\x00-\x09]{16})", re.DOTALL)  # Section 4.
_log = logging.getLogger("tmini")


def find(serial: str = "", ports: Iterable[str] | None = None) -> str:
    """The port of the lidar whose serial number ends with `serial`; "" fits any. `ports`: where to
    look; None: on the USB adapters with a chip that lidars come with. Takes up to 4 s.

    A port that another program holds is left alone. A line that is silent, or falls silent after a
    lidar's packets, gets the question for the device information, and nothing else. A lidar that
    scans is not stopped: it is recognised if it reports its serial number while scanning, as some
    do at up to 8 Hz. Raises OSError if no lidar fits, or more than one; the text says what each
    port answered."""
    names: list[str] = sorted({port.device for port in comports() if (port.vid, port.pid) in _CHIPS}
                              if ports is None else ports)
    with ThreadPoolExecutor(max(1, len(names))) as threads:
        answers = dict(zip(names, threads.map(_look, names)))
    said = "; ".join(f"{name}: {answer}" for name, answer in answers.items())
    _log.info("looked for a lidar: %s", said)
    found = [name for name, answer in answers.items()
             if answer.isdigit() and answer.endswith(serial)]
    if len(found) == 1:
        return found[0]
    wanted = f"whose serial number ends with {serial}" if serial else "at all"
    raise OSError(f"{'several lidars' if found else 'no lidar'} {wanted}: "
                  f"{said or 'there is no USB adapter of a kind that lidars come with'}")


def resolve(port: str) -> str:
    """The port's own name if it is "serial:" and the end of a lidar's serial number."""
    return find(port[7:]) if port.startswith("serial:") else port


def _look(name: str) -> str:
    """The serial number, or why there is none."""
    if _is_held(name):
        return "in use by another program"
    try:
        line = open_line(name)
    except OSError as error:
        return str(error)
    try:
        return _recognise(line)
    except OSError as error:
        return str(error)
    finally:
        line.close()


def _recognise(line: Line) -> str:
    data = heard = _listen(line, _LISTEN_S)
    for _ in range(_HEARD_TIMES):
        if not heard:
            break  # Silent, perhaps after the tail of a lidar that was just stopped.
        serial, packets = _reported(data)
        if serial:
            return serial
        heard = _listen(line, _LISTEN_S)
        data += heard
    if heard or data and not packets:
        return "sends already, and was not asked"
    return _ask(line)


def _ask(line: Line) -> str:
    data = b""
    for _ in range(_ASKED_TIMES):
        line.write(_ASK_INFO)
        data += _listen(line, _ASK_S, _INFO)
        if info := _INFO.search(data):
            return "".join(map(str, info[1]))
    return "answers, but not as a lidar" if data else "no answer"


def _listen(line: Line, seconds: float, awaited: re.Pattern[bytes] | None = None) -> bytes:
    data, end = b"", time.monotonic() + seconds
    while True:
        is_over = time.monotonic() >= end  # Before the read: a busy computer may be away till then.
        data += b"".join(part or b"" for part in line.read())
        if is_over or awaited is not None and awaited.search(data):
            return data
        time.sleep(0.01)


def _reported(data: bytes) -> tuple[str, int]:
    """The serial number that a lidar reports while scanning, "" if unknown, and how many packets
    there are."""
    tape: Any = ffi.new("tape_t *")
    lib.tape_begin(tape, ffi.NULL, 0)
    while (found := lib.tape_next_scan(tape)) != lib.TAPE_END:
        if found == lib.TAPE_NEEDS_BYTES:
            data = data[lib.tape_feed(tape, data, len(data)):]
    info = ffi.new("tmini_ct_info_t *")
    lib.tmini_ct_read(ffi.addressof(tape.stream.decoder.ct), info)
    is_known = info.known & lib.TMINI_KNOWN_SERIAL
    serial = f"{info.year:04}{info.month:02}{info.day:02}{info.number:08}" if is_known else ""
    return serial, tape.stream.packets


def _is_held(name: str) -> bool:
    """True if a program has this port open; of other users' programs only root sees it."""
    device = os.path.realpath(name)
    for link in glob.iglob("/proc/[0-9]*/fd/*"):
        try:
            if os.readlink(link) == device:
                return True
        except OSError:
            continue  # Closed meanwhile, or not ours to see.
    return False
