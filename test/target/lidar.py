# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Runs the simulated lidar in an emulator's time, and reads its own record of what it sent."""

import csv
import subprocess


class Lidar:
    """A process that runs tmini-sim with the given options."""

    def __init__(self, program, truth, *options):
        self.truth = truth
        self.process = subprocess.Popen([program, "--lines", "--truth", truth, *options], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def exchange(self, now_us, received):
        """Passes the received bytes to the lidar, and returns the bytes that it has sent by now."""
        self.process.stdin.write(f"{now_us} {received.hex()}\n")
        self.process.stdin.flush()
        return bytes.fromhex(self.process.stdout.readline())

    def end(self):
        """The packets that were sent, by number: each is a list of samples, dicts of numbers."""
        self.process.communicate()
        packets = {}
        with open(self.truth, encoding="ascii") as file:
            for row in csv.DictReader(file):
                sample = {name: int(value) for name, value in row.items()}
                packets.setdefault(sample["packet"], []).append(sample)
        return packets
