#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Compiles each sketch with the stand-in for Arduino's API, as on several boards:
#
#   sketches.sh C++-COMPILER

set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)

# compile SKETCH NAME=VALUE…
compile() {
    sketch=$1
    shift
    echo "$sketch $*"
    # shellcheck disable=SC2046 # one option for each name
    printf '#include <Arduino.h>\n#include "%s"\n' "$sketch" |
        "$compiler" -std=c++11 -Wall -Wextra -Werror -fsyntax-only -I "$root/lib/include" \
            -I "$root/port/arduino" -I "$root/test/port/arduino/arduino_stub" \
            $(printf -- '-D%s ' ARDUINO=10819 "$@") -x c++ -
}

compiler=$1
for sketch in "$root"/examples/esp32_arduino/*/*.ino; do
    compile "$sketch"
    compile "$sketch" ARDUINO_ARCH_RP2040
    compile "$sketch" CORE_TEENSY __IMXRT1062__
    for chip in ESP32 ESP32S3 ESP32C3; do
        # A C3 has no third serial port.
        case $sketch$chip in *TwoLidars.inoESP32C3) continue ;; esac
        compile "$sketch" ESP32 "CONFIG_IDF_TARGET_$chip=1"
    done
done
