# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Runs the simulated lidar in an emulator's time, and keeps the bytes that it sends."""

import subprocess


class Lidar:
    """A process that runs tmini-sim with the given options."""

    def __init__(self, program, *options):
        self.process = subprocess.Popen([program, "--lines", *options], text=True, stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE)
        self.sent = b""

    def exchange(self, now_us, received):
        """Passes the received bytes to the lidar, and returns the bytes that it has sent by now."""
        self.process.stdin.write(f"{now_us} {received.hex()}\n")
        self.process.stdin.flush()
        new = bytes.fromhex(self.process.stdout.readline())
        self.sent += new
        return new

    def end(self):
        self.process.communicate()
