# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Runs the tool's commands in README.md unchanged and in order, with the simulated lidar instead of a real one.
Each must succeed.

    tool_runs.py BUILD

Exit status: 0 all commands have succeeded, 1 not.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from documents import ROOT, parse

NOT_RUN = {"view": "wants a terminal; test_view.py has one"}


def commands():
    """The commands in README.md, without their comments."""
    for block in parse(ROOT / "README.md")[0]:
        for line in block.text.splitlines():
            if block.language == "sh" and re.match(r"build/bin/tmini ", line):
                yield line.split(" #")[0].strip()


def main():
    build = Path(sys.argv[1]).resolve()
    failed, done = False, 0
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "build").symlink_to(build, target_is_directory=True)
        simulator = subprocess.Popen([build / "bin" / "tmini-sim", "--tcp", "0"], text=True,
                                     stdout=subprocess.PIPE)
        try:
            address = simulator.stdout.readline().strip()
            lidar = dict(os.environ, TMINI_PORT="tcp:" + address)
            for command in commands():
                name = command.split()[1]
                if name in NOT_RUN:
                    print(f"not run: {command}: {NOT_RUN[name]}")
                    continue
                result = subprocess.run(command.split(), cwd=folder, env=lidar, text=True,
                                        timeout=60, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        check=False)
                if "was built without cairo" in result.stdout:
                    print(f"not run: {command}: this build has no cairo")
                    continue
                print(f"{'FAILED' if result.returncode else 'done'}: {command}")
                failed = failed or result.returncode != 0
                if result.returncode:
                    print(result.stdout)
                done += 1
        finally:
            simulator.kill()
            simulator.wait()
    if done < 3:
        print("hardly any commands have been found: is this check still one?")
    sys.exit(1 if failed or done < 3 else 0)


main()
