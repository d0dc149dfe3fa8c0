# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Checks that menuconfig's default pins are free on each chip: not used for flash, console, USB or strapping, and
present in every package; and that the Arduino sketches' are, too, of which the lidar's are the same.

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
    "ESP32S3": (49, "0, 3, 45, 46, 26-37, 22-25, 19, 20, 43, 44"), "ESP32C2": (21, "8, 9, 11-17, 19, 20"),
    "ESP32C3": (22, "2, 8, 9, 11-17, 18, 19, 20, 21"), "ESP32C5": (29, "2, 3, 7, 25-28, 15-22, 13, 14, 11, 12"),
    "ESP32C6": (31, "4, 5, 8, 9, 15, 24-30, 10, 11, 14, 12, 13, 16, 17"),
    "ESP32C61": (30, "3, 4, 7-9, 14-17, 19-21, 12, 13, 10, 11"),
    "ESP32H2": (28, "2, 3, 8, 9, 25, 15-21, 6, 7, 26, 27, 23, 24"), "ESP32P4": (55, "34-38, 24, 25"),
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


def of_sketches():
    """The sketches' pins by chip, each a dictionary of lists by name; the key None is for chips that are not named."""
    result = {}
    for block in re.split(r"#(?:el)?if|#else", read("port/arduino/TMiniPins.h")):
        found = {name: [int(pin) for pin in numbers.split(",")]
                 for name, numbers in re.findall(r"#define TMINI_(\w+)_PINS? ([\d, ]+)", block)}
        for chip in re.findall(r"CONFIG_IDF_TARGET_(\w+)", block.splitlines()[0]) or [None]:
            if "RX1" in found:
                result[chip] = found
    return result


tx_pins, rx_pins, sketches = defaults("TMINI_ESP32_TX_PIN"), defaults("TMINI_ESP32_RX_PIN"), of_sketches()
complaints = []
for chip, (count, taken) in CHIPS.items():
    rx, tx = rx_pins.get(chip), tx_pins.get(chip)
    sketch = sketches.get(chip, sketches[None])
    used = sum(sketch.values(), [])
    for pin in (rx, tx, *used):
        if pin is None or pin >= count or pin in pins(taken):
            complaints.append("%s: GPIO%s is not free" % (chip, pin))
    if rx == tx or len(set(used)) != len(used):
        complaints.append("%s: one pin for two" % chip)
    if (sketch["RX1"], sketch["TX1"]) != ([rx], [tx]) or len(sketch["LED"]) < 4:
        complaints.append("%s: the sketches have other pins" % chip)
print("\n".join(complaints) or "%d chips have pins for a lidar" % len(CHIPS))
sys.exit(1 if complaints else 0)
