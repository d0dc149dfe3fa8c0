#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Compiles the port as ESP-IDF would, but with the stand-in for ESP-IDF's headers: for chips with
# Xtensa cores (with Debian's compiler for the ESP8266, the nearest one available) and for chips
# with RISC-V cores:
#
#   compile.sh xtensa|riscv
#
# Exit status: 0 clean, 1 not clean, 2 wrong usage, 77 the compiler is not installed.

set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)

case ${1:-} in
    xtensa)
        # The compiler does not search Debian's folders of the C library's headers by default.
        compiler="xtensa-lx106-elf-gcc -mlongcalls -isystem /usr/lib/xtensa-lx106-elf/include
            -isystem /usr/lib/picolibc/xtensa-lx106-elf/include -DMODEL_ESP32"
        ;;
    riscv) compiler="riscv64-unknown-elf-gcc --specs=picolibc.specs -march=rv32imac -mabi=ilp32" ;;
    *)
        sed -n '5,10s/^# \{0,1\}//p' "$0" >&2
        exit 2
        ;;
esac
if ! command -v "${compiler%% *}" >/dev/null; then
    echo "skipped: ${compiler%% *} is not installed"
    exit 77
fi
# shellcheck disable=SC2086 # the compiler is several words
if ! echo '#include <string.h>' | $compiler -E - >/dev/null 2>&1; then
    echo "skipped: ${compiler%% *} finds no C library"
    exit 77
fi
# shellcheck disable=SC2086
$compiler -Os -std=gnu17 -Wall -Wextra -Wconversion -Wsign-conversion -Wshadow \
    -Werror -I "$root/lib/include" -I "$root/port/esp32" -I "$root/test/port/esp32/esp_idf" \
    -c "$root/port/esp32/tmini_esp32.c" -o /dev/null
echo "compiled clean: $1"
