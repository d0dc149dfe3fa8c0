# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Makes the streams for the measurements: turns of the simulated lidar at 6 Hz."""

from lidar_bytes import decode
from targets import ROOT, run

TURNS = 20
SPIN_UP = 2  # The first turns, which are not of 6 Hz.
DAMAGE = ("drop=6e-4", "flip=7e-4", "insert=7e-4")  # Of one byte in 500.
FOLDERS = [ROOT / "test" / name for name in ("simulator", "support")]
SOURCES = [path for path in FOLDERS[0].glob("*.c")
           if not path.name.startswith("test_") and path.name != "sim_judge.c"]
SOURCES += [FOLDERS[1] / name for name in ("encoder.c", "random.c", "reference_decoder.c")]


def turns(simulator, count, *options):
    """A stream of that many turns, each from its start packet on, and the number of packets in it."""
    recording = simulator.with_suffix(".bin")
    run(simulator, "--write", recording, "--spin-up", 0, "--seconds", (count + SPIN_UP + 4) / 6, *options)
    stream = recording.read_bytes()
    starts, packets, at = [], decode(stream)[0], 0
    for number, packet in enumerate(packets):
        at = stream.index(packet, at)
        starts += [(at, number)] if packet[2] & 1 else []
        at += len(packet)
    (begin, first), (end, last) = starts[SPIN_UP], starts[SPIN_UP + count]
    return stream[begin:end], last - first


def make(folder):
    """All streams by name, and the number of packets in the clean one."""
    simulator = folder / "streams"
    run("cc", "-std=c99", "-O1", '-DTMINI_SIM_VERSION=""', *(f"-I{path}" for path in FOLDERS), *SOURCES,
        "-o", simulator)
    clean, packets = turns(simulator, TURNS)
    damage = [word for kind in DAMAGE for word in ("--fault", kind)]
    return {"clean": clean, "clean packets": packets, "corrupted": turns(simulator, TURNS, *damage)[0],
            "turn": turns(simulator, 2)[0], "faulty": turns(simulator, 4, "--health", 2)[0]}
