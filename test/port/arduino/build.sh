#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Builds a sketch of the release's Arduino library with Arduino's own builder and AVR core:
#
#   build.sh CMAKE ARCHIVE SKETCH BOARD RAM
#
# for example: build.sh cmake tmini-1.0.0-arduino.zip Streaming mega:cpu=atmega2560 8192
# SKETCH may be a folder that contains a sketch of the same name. Environment variables: FIRMWARE
# (optional) names the file to which the program is copied; FLAGS are more compiler options.
# Exit status: 0 if it links, without a warning about our code, and leaves a quarter of the board's
# RAM for the stack; 1 if not; 77 if builder, compiler or core is not installed.

set -eu

cmake=$1 archive=$2 sketch=$3 board=$4 ram=$5
hardware=/usr/share/arduino/hardware
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for needed in arduino-builder arduino-ctags avr-g++; do
    if ! command -v "$needed" >/dev/null; then
        echo "skipped: $needed is not installed"
        exit 77
    fi
done
if [ ! -e "$hardware/arduino/avr/cores/arduino/Arduino.h" ]; then
    echo "skipped: arduino-core-avr is not installed"
    exit 77
fi

mkdir "$work/libraries" "$work/tools" "$work/build"
case $sketch in
*/*) folder=$sketch ;;
*) folder=$work/libraries/tmini/examples/$sketch ;;
esac
sketch=$(basename "$sketch")
# In the locale C, CMake 3.31 cannot unpack an archive whose path has accents.
cp "$archive" "$work/library.zip"
(cd "$work/libraries" && "$cmake" -E tar xf ../library.zip)

# Debian's path of the tool that finds a sketch's functions.
ctags='"{cmd.path}" -u --language-force=c++ -f - --c++-kinds=svpf --fields=KSTtzns'
ctags="$ctags --line-directives \"{source_file}\""

# GCC before version 6 does not define DECIMAL_DIG in C++, but the core needs it.
arduino-builder -compile -core-api-version 10819 -warnings all -fqbn "arduino:avr:$board" \
    -hardware "$hardware" -tools "$work/tools" -libraries "$work/libraries" \
    -prefs "tools.ctags.cmd.path=$(command -v arduino-ctags)" -prefs "tools.ctags.pattern=$ctags" \
    -prefs "compiler.cpp.extra_flags=-DDECIMAL_DIG=__DECIMAL_DIG__ ${FLAGS:-}" \
    -build-path "$work/build" "$folder/$sketch.ino" >"$work/log" 2>&1 || {
    cat "$work/log"
    exit 1
}
if grep "$work/libraries.*warning:" "$work/log"; then
    exit 1
fi
tail -n 2 "$work/log"

used=$(sed -n 's/^Global variables use \([0-9]*\) bytes.*/\1/p' "$work/log")
[ "$used" -le $((ram * 3 / 4)) ] || {
    echo "too much RAM: $used of $ram bytes"
    exit 1
}
[ -z "${FIRMWARE:-}" ] || cp "$work/build/$sketch.ino.elf" "$FIRMWARE"
