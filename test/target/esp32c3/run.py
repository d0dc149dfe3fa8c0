# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Builds the firmware and runs it on a simulated ESP32-C3 whose UART is wired to the simulated lidar.

    run.py TMINI_SIM WORK_FOLDER

Both use virtual time: every run gives the same bytes. Compares the results in the firmware's memory, every point
among them, with what test/host/lidar_bytes.py reads in the bytes that the lidar sent; and the bytes that the firmware
sent. Exit status: 0 as expected, 1 not, 77 the compiler is not installed.
"""

import glob
import os
import pathlib
import shutil
import struct
import subprocess
import sys

import labwired

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "test" / "target"), str(ROOT / "test" / "host")]
from lidar import Lidar  # pylint: disable=wrong-import-position
from lidar_bytes import decode, points  # pylint: disable=wrong-import-position

PROCESSOR_HZ = 20_000_000  # The chip's frequency after reset; TICKS_PER_MS in main.c relies on it.
SLICE_US = 250  # About six byte times.
END_US = 4_000_000
SCANS, POINTS_OF_A_SCAN = 4, 800

# The manual's command codes. The lidar's state is unknown: the first command is a stop. Before the start, the driver
# reads the frequency (11 Hz), raises it by 1 Hz and reads it again.
COMMANDS = bytes(byte for code in (0x65, 0x90, 0x92, 0x0D, 0x0B, 0x0D, 0x60, 0x65) for byte in (0xA5, code))

# The firmware's variables: format, and value.
RESULTS = {
    "info": ("4B16B", (151, 2, 1, 1, 2, 0, 2, 6, 0, 3, 1, 7, 0, 0, 0, 1, 2, 3, 4, 5)),
    "turn": ("<H10xI", (0b10111000111010, 12345)),  # Indices 1, 3, 4, 5, 9, 10, 11 and 13 are known.
    "harm": ("<I", (0,)),
    "health": ("<BxH", (0, 0)),
    "frequency_chz": ("<I", (1200,)),
    "overflows": ("<I", (0,)),
    "incomplete": ("<I", (0,)),
    "unexpected": ("<I", (0,)),
    "finished": ("<I", (1,)),  # All that was asked for was done.
}

# GCC 12 needs the extension zicsr for the CSR instructions, but finds no C library built with that name. In edition
# 2.2 of the instruction set (-misa-spec) they are part of the base set.
COMPILER = ["riscv64-unknown-elf-gcc", "--specs=picolibc.specs", "-march=rv32imc", "-misa-spec=2.2", "-mabi=ilp32",
            "-std=c99", "-Os", "-ffunction-sections", "-fdata-sections", "-Wall", "-Wextra", "-Wconversion", "-Werror",
            "-Wl,--gc-sections", "-Wl,--defsym=__flash=0x42000000", "-Wl,--defsym=__flash_size=0x100000",
            "-Wl,--defsym=__ram=0x3FC80000", "-Wl,--defsym=__ram_size=0x50000"]


def build(firmware):
    sources = [ROOT / "test/target/esp32c3/main.c", *glob.glob(f"{ROOT}/lib/src/*.c")]
    subprocess.run([*COMPILER, "-I", ROOT / "lib/include", *sources, "-o", firmware], check=True)


def run(firmware, system, lidar):
    """Runs the firmware to its end. Returns what it has sent, and a function that reads a variable."""
    sent = b""
    with labwired.Sim(firmware, system=system, uart="uart0") as sim:
        for now_us in range(SLICE_US, END_US, SLICE_US):
            sim.run_for(f"{SLICE_US}us")
            new = sim.read_uart_bytes()
            sent += new
            received = lidar.exchange(now_us, new)
            if received:
                sim.send_bytes(received)
            if sim.read_u32(sim.symbol("finished")):
                break
        print(f"{now_us / 1e6} s on the simulated chip, {sim.cycles} cycles")
        return sent, {name: sim.read_memory(sim.symbol(name), size) for name, size in (
            *((name, struct.calcsize(kind)) for name, (kind, _) in RESULTS.items()),
            ("counts", 4 * SCANS), ("kept", 6 * POINTS_OF_A_SCAN * SCANS))}


def scans_in(memory):
    kept = list(struct.iter_unpack("<HHBB", memory["kept"]))
    for number, (count,) in enumerate(struct.iter_unpack("<I", memory["counts"])):
        yield kept[number * POINTS_OF_A_SCAN:][:count]


def turns_in(stream):
    """The points of each turn after the first start packet."""
    turns = []
    for content in decode(stream)[0]:
        if content[2] & 1:
            turns.append([])
        if turns:
            turns[-1] += points(content)
    return turns


def main():
    lidar_program, work = sys.argv[1:]
    if shutil.which(COMPILER[0]) is None:
        print(f"skipped: {COMPILER[0]} is not installed")
        sys.exit(77)
    firmware, system = os.path.join(work, "esp32c3.elf"), os.path.join(work, "system.yaml")
    build(firmware)
    chip = pathlib.Path(labwired.__file__).parent / "configs" / "chips" / "esp32c3.yaml"
    pathlib.Path(system).write_text(f'name: "esp32c3-reset"\nchip: "{chip}"\ncpu_hz: {PROCESSOR_HZ}\n'
                                    "external_devices: []\nboard_io: []\n", encoding="ascii")
    lidar = Lidar(lidar_program, "--frequency", "11")
    sent, memory = run(firmware, system, lidar)
    lidar.end()
    wrong = [f"{name}: {found}, expected {value}" for name, (kind, value) in RESULTS.items()
             if (found := struct.unpack(kind, memory[name])) != value]
    if sent != COMMANDS:
        wrong.append(f"sent {sent.hex(' ')}, expected {COMMANDS.hex(' ')}")
    wrong += [f"scan {number} of {len(scan)} points is not turn {number} of {len(turn)}"
              for number, (scan, turn) in enumerate(zip(scans_in(memory), turns_in(lidar.sent)), 1) if scan != turn]
    print("\n".join(wrong) or "every point is the lidar's, in its place")
    sys.exit(1 if wrong else 0)


main()
