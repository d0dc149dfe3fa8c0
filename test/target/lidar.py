# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""The simulated lidar in an emulator's time, and its own account of what it sent."""

import csv
import subprocess


class Lidar:
    """tmini-sim with these options, a process of its own."""

    def __init__(self, program, truth, *options):
        self.truth = truth
        self.process = subprocess.Popen([program, "--lines", "--truth", truth, *options], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def exchange(self, now_us, received):
        """Gives it what it has received by now, and returns what has left it."""
        self.process.stdin.write(f"{now_us} {received.hex()}\n")
        self.process.stdin.flush()
        return bytes.fromhex(self.process.stdout.readline())

    def end(self):
        """Returns the truth: each packet by its number, a list of its samples as named numbers."""
        self.process.communicate()
        packets = {}
        with open(self.truth, encoding="ascii") as file:
            for row in csv.DictReader(file):
                sample = {name: int(value) for name, value in row.items()}
                packets.setdefault(sample["packet"], []).append(sample)
        return packets
