# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""python -m tmini COMMAND: a lidar in programs that exist."""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence

from ._command import CommandError
from ._lidar import LidarError

_COMMANDS = ("live", "mcap", "serve")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tmini",
                                     description="Scans of a YDLIDAR T-mini Plus in other programs.",
                                     epilog="Ctrl-C ends a command and stops the lidar. Exit "
                                     "status: 0 success, 1 failure, 2 wrong usage.")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for name in _COMMANDS:
        module = importlib.import_module(f"tmini._{name}")
        command = commands.add_parser(name, help=module.SUMMARY, description=module.__doc__)
        module.add_arguments(command)
        command.set_defaults(run=module.run)
    return parser


def main(words: Sequence[str] | None = None) -> int:
    """Returns the exit status."""
    arguments = _parser().parse_args(words)
    try:
        arguments.run(arguments)
    except KeyboardInterrupt:
        pass
    except (CommandError, LidarError, OSError, ValueError) as error:
        print(f"tmini: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
