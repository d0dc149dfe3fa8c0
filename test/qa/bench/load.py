# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Calculates from the counts a board's processor load and the longest time between two polls."""

# Cautious assumptions: with flash wait states an instruction takes two cycles; an interrupt's entry and exit take 40.
CYCLES_PER_INSTRUCTION = 2
CYCLES_PER_INTERRUPT = 40
POLLS_PER_SECOND = 1000

RINGS = (256, 512, 1024, 2048, 4096)
LINE_BYTES_PER_MS = 23.04
FULL_PACKET = 130

BOARDS = (("8 MHz Cortex-M0", "cortex-m0", 8), ("72 MHz Cortex-M3", "cortex-m3", 72),
          ("168 MHz Cortex-M4", "cortex-m4", 168), ("160 MHz ESP32-C3", "rv32imc", 160))


# At 6 Hz: samples, headers and one LastCRC per revolution of 667 points in 18 packets.
BYTES_PER_SECOND = (667 * 3 + 18 * 10 + 1) * 6


def percent(figures, megahertz, feed):
    """The load in percent at 6 Hz with one poll per millisecond, and one interrupt per byte, or with DMA per 128
    bytes (half of a small buffer)."""
    rate = BYTES_PER_SECOND
    interrupts = rate if feed == "bytes" else rate / 128
    instructions = rate * sum(figures["costs"][feed])
    if feed == "bytes":
        instructions = rate * figures["per poll"][13]["bytes"]
    else:
        instructions += POLLS_PER_SECOND * figures["idle poll"][1]
    cycles = instructions * CYCLES_PER_INSTRUCTION + interrupts * CYCLES_PER_INTERRUPT
    return 100 * cycles / (megahertz * 1e6)


def longest_pause_ms(ring, dma):
    """The longest safe time between two polls: the buffer (with DMA, half of it) already holds an incomplete packet,
    and the line fills the rest at its full rate."""
    usable = (ring // 2 if dma else ring) - (FULL_PACKET - 1)
    return max(0.0, usable / LINE_BYTES_PER_MS)
