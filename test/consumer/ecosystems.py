# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""What docs/ecosystems.md claims: its programs compile, and the tests that it names exist.

    ecosystems.py BUILD COMPILER [C++-COMPILER]

BUILD is a configured build folder. Exit status: 0 all is true, 1 not; every mistake is told.
"""

import os
import re
import subprocess
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
DOCUMENT = os.path.join(ROOT, "docs", "ecosystems.md")

# How the programs of a section are compiled; paths are relative to the project.
C = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-Ilib/include"]
CXX = ["-std=c++11", "-Wall", "-Wextra", "-Werror", "-Ilib/include"]
BOARD = ["-include", "test/support/readme_board.h"]
STAND_INS = {
    "Any C compiler": C + BOARD,
    "STM32Cube": C + ["-Iport/stm32", "-Itest/port/stm32/stm32_model", "-DSTM32_MODEL_SR",
                      "-DSTM32_MODEL_STREAMS", "-DSTM32_MODEL_YEAR=2024"],
    "Arduino": CXX + ["-Iport/arduino", "-Itest/port/arduino/arduino_stub", "-DARDUINO=10819",
                      "-DESP32", "-DESP_ARDUINO_VERSION_MAJOR=3"],
    "ESP-IDF": C + ["-Iport/esp32", "-Itest/port/esp32/esp_idf", *BOARD],
    "Zephyr": C + ["-Iport/zephyr", "-Itest/port/zephyr/zephyr_stub", *BOARD],
    "FreeRTOS": C + ["-Iport/freertos", "-Itest/port/freertos/kernel_stub", *BOARD],
    "Raspberry Pi Pico": C + ["-Iport/pico", "-Itest/port/pico/sdk_stub", "-std=gnu99",
                              *BOARD],
    "micro-ROS": C + ["-Iexamples/micro_ros", "-Itest/port/micro_ros/micro_ros_stub"],
}
LANGUAGES = {"c": "c", "cpp": "c++"}

complaints = []


def programs(text):
    """Yields section, language and text of each block of C or C++."""
    for section in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        heading = section.split("\n", 1)[0]
        for language, program in re.findall(r"^```(c|cpp)\n(.*?)^```", section,
                                            re.MULTILINE | re.DOTALL):
            yield heading, language, program


def check_program(heading, language, program, compilers):
    flags = STAND_INS.get(heading)
    if flags is None:
        complaints.append("%s: nothing to compile its program with" % heading)
        return
    compiler = compilers.get(language)
    if not compiler:
        return
    result = subprocess.run(
        [compiler, "-fsyntax-only"] + flags + ["-x", LANGUAGES[language], "-"],
        input=program, text=True, cwd=ROOT, stderr=subprocess.PIPE, check=False)
    if result.returncode != 0:
        complaints.append("%s: does not compile:\n%s" % (heading, result.stderr))


def tests_of(build):
    listing = subprocess.run(["ctest", "-N"], cwd=build, text=True, stdout=subprocess.PIPE,
                             check=True).stdout
    return set(re.findall(r"Test +#\d+: (\S+)", listing))


def check_table(text, tests):
    rows = re.findall(r"^\| \[.*\|$", text, re.MULTILINE)
    headings = re.findall(r"^## (.*)$", text, re.MULTILINE)
    linked = [re.match(r"\| \[[^]]*\]\(#([^)]*)\)", row).group(1) for row in rows]
    anchors = [heading.lower().replace(" ", "-") for heading in headings]
    if linked != anchors:
        complaints.append("the table's links are %s, the sections %s" % (linked, anchors))
    for row in rows:
        named = re.findall(r"`([^`]*)`", row.split("|")[3])
        if not named:
            complaints.append("no test: %s" % row)
        for name in named:
            if name not in tests:
                complaints.append("there is no test %s" % name)


def main():
    with open(DOCUMENT, encoding="utf-8") as file:
        text = file.read()
    compilers = {"c": sys.argv[2], "cpp": sys.argv[3] if len(sys.argv) > 3 else None}
    for heading, language, program in programs(text):
        check_program(heading, language, program, compilers)
    check_table(text, tests_of(sys.argv[1]))
    print("\n".join(complaints) or "docs/ecosystems.md is right")
    sys.exit(1 if complaints else 0)


main()
