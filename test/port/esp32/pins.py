# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that menuconfig's default pins are free on each chip: not used for flash, console, USB or strapping, and
present in every package. The sketch Scan must use the same pins.

    pins.py ROOT

The table is from the GPIO pages of ESP-IDF's documentation. Exit status: 0 all pins are free, 1 not.
"""

import os
import re
import sys

ROOT = sys.argv[1]


def pins(text):
    """The set of pins in a list: "1, 3-5" gives 1, 3, 4 and 5."""
    result = set()
    for part in text.split(","):
        first, _, last = part.strip().partition("-")
        result |= set(range(int(first), int(last or first) + 1))
    return result


# For each chip the number of its pins, and the pins that are not free.
CHIPS = {
    "ESP32": (40, "0, 2, 5, 12, 15, 6-11, 16, 17, 1, 3, 20, 24, 28-31, 34-39"),
    "ESP32S2": (47, "0, 45, 46, 26-32, 22-25, 19, 20, 43, 44, 39-42"),
    "ESP32S3": (49, "0, 3, 45, 46, 26-37, 22-25, 19, 20, 43, 44"),
    "ESP32C2": (21, "8, 9, 11-17, 19, 20"),
    "ESP32C3": (22, "2, 8, 9, 11-17, 18, 19, 20, 21"),
    "ESP32C5": (29, "2, 3, 7, 25-28, 15-22, 13, 14, 11, 12"),
    "ESP32C6": (31, "4, 5, 8, 9, 15, 24-30, 10, 11, 14, 12, 13, 16, 17"),
    "ESP32C61": (30, "3, 4, 7-9, 14-17, 19-21, 12, 13, 10, 11"),
    "ESP32H2": (28, "2, 3, 8, 9, 25, 15-21, 6, 7, 26, 27, 23, 24"),
    "ESP32P4": (55, "34-38, 24, 25"),
}


def read(name):
    with open(os.path.join(ROOT, name), encoding="utf-8") as file:
        return file.read()


def defaults(option):
    entry = read("Kconfig").split("config " + option + "\n")[1].split("config ")[0]
    result = {}
    for pin, condition in re.findall(r"default (\d+) if (.*)", entry):
        for chip in re.findall(r"IDF_TARGET_(\w+)", condition):
            result[chip] = int(pin)
    return result


def of_scan():
    """The sketch's pins (RX, TX) by chip; the key None is for chips that it does not name."""
    parts = re.findall(r"#(?:if|elif|else)(.*)\nstatic const int8_t RX_PIN = (\d+);.*\n"
                       r"static const int8_t TX_PIN = (\d+);",
                       read("examples/esp32_arduino/Scan/Scan.ino"))
    result = {}
    for condition, rx, tx in parts:
        for chip in re.findall(r"CONFIG_IDF_TARGET_(\w+)", condition) or [None]:
            result[chip] = (int(rx), int(tx))
    return result


tx_pins, rx_pins, scan = defaults("TMINI_ESP32_TX_PIN"), defaults("TMINI_ESP32_RX_PIN"), of_scan()
complaints = []
for chip, (count, taken) in CHIPS.items():
    rx, tx = rx_pins.get(chip), tx_pins.get(chip)
    for pin in (rx, tx):
        if pin is None or pin >= count or pin in pins(taken):
            complaints.append("%s: GPIO%s is no pin for a lidar" % (chip, pin))
    if rx == tx:
        complaints.append("%s: one pin for both" % chip)
    if scan.get(chip, scan.get(None)) != (rx, tx):
        complaints.append("%s: Scan has other pins" % chip)
print("\n".join(complaints) or "%d chips have pins for a lidar" % len(CHIPS))
sys.exit(1 if complaints else 0)
