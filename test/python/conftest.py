# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The simulated lidar, and commands of the package."""

import os
import pathlib
import signal
import subprocess
import sys
import time

import pytest
from tmini.__main__ import main

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECORDINGS = ROOT / "test" / "recordings"
TOOL, SIM = os.environ["TMINI_TOOL"], os.environ["TMINI_SIM"]
sys.path.append(str(ROOT / "test" / "host"))  # lidar_bytes
for _number in (signal.SIGINT, signal.SIGHUP):  # Those that a background job, or nohup, ignores.
    if signal.getsignal(_number) == signal.SIG_IGN:
        signal.signal(_number, lambda *_: None)  # What is started does not inherit it.


def wait_until(condition, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


class Simulator:
    """tmini-sim on a pseudo-terminal whose name stays the same, as that of a USB adapter."""

    def __init__(self, folder):
        self.port = str(folder / "lidar")
        self.log = folder / "log"
        self.process = None

    def start(self, *options, line="--pty"):
        command = [SIM, *line.split(), "--log", str(self.log), *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        os.symlink(self.process.stdout.readline().strip(), self.port)
        return self.port

    def await_idle(self):
        """Fails unless the last thing that the lidar does is to stop."""
        wait_until(lambda: self.log.read_text().splitlines()[-1].endswith("idle"), 30)

    def stop(self):
        if self.process is not None:
            os.unlink(self.port)
            self.process.terminate()
            self.process.wait()
            self.process.stdout.close()
            self.process = None


@pytest.fixture
def simulator(tmp_path):
    simulated = Simulator(tmp_path)
    yield simulated
    simulated.stop()


@pytest.fixture
def run(capsys):
    """run(*words): `python -m tmini WORDS`, to its end; (exit status, output, errors)."""
    def call(*words):
        try:
            status = main(list(map(str, words)))
        except SystemExit as end:
            status = end.code
        return status, *capsys.readouterr()
    return call


@pytest.fixture
def command():
    """Starts the same as a program, after some Python; ends what still runs in the end."""
    started = []

    def start(*words, first="pass"):
        program = f"import runpy; {first}; runpy.run_module('tmini', run_name='__main__')"
        started.append(subprocess.Popen([sys.executable, "-c", program, *map(str, words)], text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        env={**os.environ, "PYTHONUNBUFFERED": ""}))
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.communicate()
