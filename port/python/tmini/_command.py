# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""What the commands of `python -m tmini` share. A command is a module with SUMMARY,
add_arguments(parser) and run(arguments)."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import importlib
import signal
import sys
import time
from collections.abc import Iterator
from typing import Any

from ._lidar import Lidar
from ._scan import Scan

_REMARK_S = 3.0


class CommandError(Exception):
    """The command has failed; the text says why."""


def load(module: str, extra: str) -> Any:
    """Imports a module of an extra's package."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise CommandError(
            f"this needs {error.name}; in the checkout of the project, this installs it:\n"
            f"    pip install './port/python[{extra}]'") from error


def add_mount_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--front", type=float, default=0.0, metavar="DEG",
                        help="the lidar's angle that points to the robot's front")
    parser.add_argument("--upside-down", action="store_true", help="the lidar hangs upside down")
    parser.add_argument("--offset", type=int, default=0, metavar="MM", dest="offset_mm",
                        help="added to each range")
    parser.add_argument("--mask", type=_arc, action="append", default=[], metavar="FROM:TO",
                        help="where it sees the robot itself, in degrees clockwise from the front")


def add_port_argument(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("port", metavar="PORT", help="/dev/ttyUSB0, COM3, serial:END (the end of "
                        "the lidar's serial number) or tcp:HOST:PORT")


def add_lidar_arguments(parser: argparse.ArgumentParser) -> None:
    add_port_argument(parser)
    add_frequency_argument(parser)
    add_mount_arguments(parser)


def add_frequency_argument(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--frequency", type=float, metavar="HZ", help="6 to 12")


def _arc(text: str) -> tuple[int, int]:
    begin, colon, end = text.partition(":")
    if not colon:
        raise ValueError
    return int(begin), int(end)


def mount(arguments: argparse.Namespace) -> dict[str, Any]:
    return {name: getattr(arguments, name) for name in ("front", "upside_down", "mask", "offset_mm")}


def _signals(*names: str) -> Iterator[int]:
    """Those that this system has. One that is ignored (`nohup`) stays ignored."""
    numbers = (getattr(signal, name, None) for name in names)
    return (number for number in numbers
            if number is not None and signal.getsignal(number) != signal.SIG_IGN)


def watch_signals() -> None:
    """Ctrl-C, SIGTERM and SIGHUP become KeyboardInterrupt, which ends a `with` and so stops the
    lidar."""
    for number in _signals("SIGTERM", "SIGHUP"):
        signal.signal(number, signal.default_int_handler)


def on_signal(loop: asyncio.AbstractEventLoop) -> asyncio.Event:
    """The same in a loop of asyncio: set by such a signal."""
    over = asyncio.Event()
    with contextlib.suppress(NotImplementedError):  # Windows has Ctrl-C alone.
        for number in _signals("SIGINT", "SIGTERM", "SIGHUP"):
            loop.add_signal_handler(number, over.set)
    return over


def open_lidar(arguments: argparse.Namespace, backlog: int = 1) -> Lidar:
    watch_signals()
    return Lidar(arguments.port, arguments.frequency, backlog=backlog, **mount(arguments))


def scans_of(lidar: Lidar, seconds: float | None = None) -> Iterator[Scan]:
    """The lidar's scans for some seconds. Remarks when there are none, and when they come again."""
    end = None if seconds is None else time.monotonic() + seconds
    is_lost = False
    while end is None or time.monotonic() < end:
        left = _REMARK_S if end is None else min(_REMARK_S, end - time.monotonic())
        scan = lidar.read(left)
        if scan is not None:
            yield scan
        is_silent = scan is None and left == _REMARK_S
        if is_silent and not is_lost:
            print(f"no scans from {lidar.port}; waiting for it", file=sys.stderr)
        elif scan is not None and is_lost:
            print("the lidar is back", file=sys.stderr)
        is_lost = scan is None and (is_lost or is_silent)
