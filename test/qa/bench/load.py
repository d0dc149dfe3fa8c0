# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""What the counts mean for a board: the processor's load, and how often to poll."""

# Assumed generously: loads, branches and flash wait states make two cycles of an instruction, and
# an interrupt's entry and exit take 40.
CYCLES_AN_INSTRUCTION = 2
CYCLES_AN_INTERRUPT = 40
POLLS_A_SECOND = 1000

RINGS = (256, 512, 1024, 2048, 4096)
LINE_BYTES_A_MS = 23.04
FULL_PACKET = 130

BOARDS = (("8 MHz Cortex-M0", "cortex-m0", 8), ("72 MHz Cortex-M3", "cortex-m3", 72),
          ("168 MHz Cortex-M4", "cortex-m4", 168), ("160 MHz ESP32-C3", "rv32imc", 160))


# At 6 Hz: samples, headers and one LastCRC per revolution of 667 points in 18 packets.
BYTES_A_SECOND = (667 * 3 + 18 * 10 + 1) * 6


def percent(figures, megahertz, feed):
    """Load at 6 Hz, polled once per millisecond. By bytes each byte has an interrupt of its own; DMA
    has one every 128 bytes (half of a small buffer)."""
    rate = BYTES_A_SECOND
    interrupts = rate if feed == "bytes" else rate / 128
    instructions = rate * sum(figures["costs"][feed])
    if feed == "bytes":
        instructions = rate * figures["per poll"][13]["bytes"]
    else:
        instructions += POLLS_A_SECOND * figures["idle poll"][1]
    cycles = instructions * CYCLES_AN_INSTRUCTION + interrupts * CYCLES_AN_INTERRUPT
    return 100 * cycles / (megahertz * 1e6)


def longest_pause_ms(ring, dma):
    """How long a buffer lasts between polls, whatever the line does: what is left of it (of its
    half, with DMA) beside an incomplete packet, filled at the line's full rate."""
    usable = (ring // 2 if dma else ring) - (FULL_PACKET - 1)
    return max(0.0, usable / LINE_BYTES_A_MS)
