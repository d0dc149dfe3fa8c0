# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Runs the firmware on a simulated ESP32-C3 whose UART is wired to the simulated lidar.

    run.py FIRMWARE.elf TMINI_SIM

Both use virtual time: every run gives the same bytes. Compares what the lidar measured with what the firmware
reports, and checks the bytes that the firmware sent.
"""

import pathlib
import sys
import tempfile
import time

import labwired

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from lidar import Lidar  # pylint: disable=wrong-import-position

PROCESSOR_HZ = 20_000_000  # The chip's frequency after reset; TICKS_PER_MS in board.c relies on it.
SLICE_US = 250  # About six byte times.
END_US = 4_000_000

# The manual's command codes. The lidar's state is unknown: the first command is a stop. Before the
# start, the driver reads the frequency (11 Hz), raises it by 1 Hz and reads it again.
EXPECTED_COMMANDS = [0x65, 0x90, 0x92, 0x0D, 0x0B, 0x0D, 0x60, 0x65]
EXPECTED_FACTS = {
    "model": ["151"],
    "firmware_major": ["1"],
    "firmware_minor": ["2"],
    "serial": ["2026031700012345"],
    "faults": ["0"],
    "frequency_chz": ["1200"],
    "started": [""],
    "stopped": [""],
    "turn_known": [str(0b10111000111010)],  # Indices 1, 3, 4, 5, 9, 10, 11 and 13.
    "turn_number": ["12345"],
    "complete": ["1", "1", "1", "1"],
    "checksum_errors": ["0"],
    "bytes_overrun": ["0"],
    "losses": ["0"],
    "timeouts": ["0"],
    "fifo_overflows": ["0"],
}
SCANS = 4


def system_description():
    """The packaged chip at the processor frequency after reset."""
    chip = pathlib.Path(labwired.__file__).parent / "configs" / "chips" / "esp32c3.yaml"
    return (f'name: "esp32c3-reset"\nchip: "{chip}"\ncpu_hz: {PROCESSOR_HZ}\n'
            "external_devices: []\nboard_io: []\n")


def revolutions_of(packets):
    revolutions = {}
    for packet in packets.values():
        revolutions.setdefault(packet[0]["revolution"], []).extend(
            tuple(sample[name] for name in ("angle_q6", "distance_mm", "intensity", "flag"))
            for sample in packet)
    return revolutions


def run(sim, lidar):
    """Runs the firmware to its end; returns the bytes that it sent and the time, or fails."""
    sent = bytearray()
    finished = sim.symbol("finished")
    for now_us in range(SLICE_US, END_US, SLICE_US):
        sim.run_for(f"{SLICE_US}us")
        new = sim.read_uart_bytes()
        sent += new
        received = lidar.exchange(now_us, new)
        if received:
            sim.send_bytes(received)
        if sim.read_u32(finished):
            return bytes(sent), now_us
    sys.exit(f"FAILED: not finished after {END_US / 1e6} s; log:\n" + read_log(sim)[-2000:])


def read_log(sim):
    length = sim.read_u32(sim.symbol("log_length"))
    return sim.read_memory(sim.symbol("log_text"), length).decode("ascii")


def split_log(text):
    """The log's facts (a list of values for each name) and its scans."""
    facts = {}
    scans = []
    for line in text.splitlines():
        name, _, value = line.partition(" ")
        if name == "scan":
            scans.append([])
        if name == "point":
            scans[-1].append(tuple(map(int, value.split())))
        else:
            facts.setdefault(name, []).append(value)
    return facts, scans


def compare(facts, scans, truth, sent):
    wrong = []
    for name, expected in EXPECTED_FACTS.items():
        if facts.get(name) != expected:
            wrong.append(f"{name}: {facts.get(name)}, expected {expected}")
    if "unexpected_event" in facts:
        wrong.append(f"unexpected events: {facts['unexpected_event']}")
    expected_sent = bytes(b for code in EXPECTED_COMMANDS for b in (0xA5, code))
    if sent != expected_sent:
        wrong.append(f"sent {sent.hex(' ')}, expected {expected_sent.hex(' ')}")
    if len(scans) != SCANS:
        wrong.append(f"{len(scans)} scans, expected {SCANS}")
    for number, scan in enumerate(scans, start=1):
        if scan != truth[number]:
            wrong.append(f"scan {number} is not revolution {number}: {scan[:3]} ... of "
                         f"{len(scan)}, expected {truth[number][:3]} ... of {len(truth[number])}")
    return wrong


def main():
    elf, lidar_program = sys.argv[1:]
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        lidar = Lidar(lidar_program, f"{folder}/truth.csv", "--frequency", "11")
        system = pathlib.Path(folder) / "system.yaml"
        system.write_text(system_description())
        with labwired.Sim(elf, system=str(system), uart="uart0") as sim:
            sent, end_us = run(sim, lidar)
            log = read_log(sim)
            cycles = sim.cycles
        truth = revolutions_of(lidar.end())
    facts, scans = split_log(log)
    wrong = compare(facts, scans, truth, sent)
    print("".join(line + "\n" for line in log.splitlines() if not line.startswith("point")), end="")
    print(f"sent: {sent.hex(' ')}")
    print(f"{sum(map(len, scans))} points in {len(scans)} scans; {cycles} cycles, "
          f"{end_us / 1e6} s on the simulated chip, {time.monotonic() - began:.1f} s here")
    if wrong:
        sys.exit("FAILED:\n" + "\n".join(wrong))
    print("every point is the lidar's, in its place")


main()
