#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Packs the Arduino library, then builds the sketch Streaming with it for an Arduino Mega 2560, in the
# way of Arduino's builder and with its flags:  mega.sh CMAKE
# Exit status: 0 it links and fits, 1 not, 77 compiler or core is not installed.

set -eu

cmake=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
avr=/usr/share/arduino/hardware/arduino/avr
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if ! command -v avr-g++ >/dev/null || [ ! -e "$avr/cores/arduino/Arduino.h" ]; then
    echo "skipped: avr-g++ or arduino-core-avr is not installed"
    exit 77
fi

machine="-mmcu=atmega2560 -DF_CPU=16000000L -DARDUINO=10819 -DARDUINO_AVR_MEGA2560 -DARDUINO_ARCH_AVR"
common="-c -Os -ffunction-sections -fdata-sections $machine -I$avr/cores/arduino -I$avr/variants/mega"
# GCC before 6 does not name this in C++, but the core expects it.
common="$common -DDECIMAL_DIG=__DECIMAL_DIG__"
cflags="$common -std=gnu11"
cxxflags="$common -std=gnu++11 -fpermissive -fno-exceptions -fno-threadsafe-statics"

"$cmake" -D OUT="$work/tmini" -P "$root/port/arduino/pack.cmake"
mkdir "$work/core" "$work/library"

# shellcheck disable=SC2086 # the flags are several words
build_core() {
    cd "$work/core"
    avr-gcc $cflags -w "$avr"/cores/arduino/*.c
    avr-g++ $cxxflags -w "$avr"/cores/arduino/*.cpp
    avr-gcc -c -x assembler-with-cpp $machine "$avr"/cores/arduino/*.S
    avr-ar rcs "$work/core.a" ./*.o
}

# Our own code: with warnings, and those are errors.
# shellcheck disable=SC2086
build_library() {
    cd "$work/library"
    avr-gcc $cflags -Wall -Wextra -Werror -I "$work/tmini/src" "$work"/tmini/src/*.c
    avr-g++ $cxxflags -Wall -Wextra -Werror -I "$work/tmini/src" \
        "$work"/tmini/src/*.cpp
}

# shellcheck disable=SC2086
build_sketch() {
    sketch=$work/tmini/examples/Streaming/Streaming.ino
    avr-g++ $cxxflags -x c++ -include Arduino.h -I "$work/tmini/src" "$sketch" -o "$work/sketch.o"
    avr-gcc -Os -Wl,--gc-sections -mmcu=atmega2560 "$work/sketch.o" "$work"/library/*.o \
        "$work/core.a" -lm -o "$work/sketch.elf"
}

build_core
build_library
build_sketch
avr-size "$work/sketch.elf"

# Of 8192 bytes of RAM a quarter stays free for the stack.
used=$(avr-size "$work/sketch.elf" | awk 'NR == 2 { print $2 + $3 }')
[ "$used" -le 6144 ] || {
    echo "too much RAM: $used bytes"
    exit 1
}
echo "RAM: $used of 8192 bytes"
