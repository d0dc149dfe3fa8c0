#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Counts the memory barriers in the machine code that puts a byte into the ring and looks for one:
# an ESP32-C3 and an RP2040 with two cores need them, a single Cortex-M4 needs none.
#
#   test/barriers.sh esp32-c3|rp2040|cortex-m4
#
# Removing a barrier from the header must change the result. Exit status 77: no such compiler.

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=test/support/compilers.sh
. "$root/test/support/compilers.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

arm="arm-none-eabi-gcc -mthumb"
case ${1:-} in
    esp32-c3)
        compiler="riscv64-unknown-elf-gcc --specs=picolibc.specs -march=rv32imc -mabi=ilp32"
        barrier=fence
        ;;
    rp2040) compiler="$arm -mcpu=cortex-m0plus -DTMINI_SINGLE_CORE=0" barrier=dmb ;;
    cortex-m4) compiler="$arm -mcpu=cortex-m4" barrier=dmb ;;
    *)
        sed -n '5,10s/^# \{0,1\}//p' "$0" >&2
        exit 2
        ;;
esac
# shellcheck disable=SC2086 # a command of several words
need_compiler $compiler

# assembly INCLUDE_FOLDER: prints the machine code of both sides of the ring, a function each.
assembly() {
    $compiler -std=c99 -Os -I"$1" -S -o - -x c - <<'END'
#include "tmini/parts/tmini_ring.h"
void put(tmini_ring_t *ring) { tmini_ring_put(ring, 1); }
size_t look(tmini_ring_t *ring) { return tmini_ring_unread(ring); }
END
}

# barriers INCLUDE_FOLDER: prints how many barriers put() and look() have, such as "1 1".
barriers() {
    assembly "$1" | awk -v barrier="$barrier" '
        /^(put|look):/ { name = substr($1, 1, length($1) - 1) }
        $1 == barrier { count[name]++ }
        END { print count["put"] + 0, count["look"] + 0 }'
}

right=$(barriers "$root/lib/include")
echo "$1: $barrier in put and in look: $right"
if [ "$1" = cortex-m4 ]; then
    [ "$right" = "0 0" ]
    exit
fi
case $right in
    "0 "* | *" 0") exit 1 ;;
esac
cp -R "$root/lib/include" "$work/include"
for order in RELEASE ACQUIRE; do
    sed "s/__ATOMIC_$order/__ATOMIC_RELAXED/" "$root/lib/include/tmini/tmini_atomic.h" \
        >"$work/include/tmini/tmini_atomic.h"
    if [ "$(barriers "$work/include")" = "$right" ]; then
        echo "without $order the machine code has the same barriers"
        exit 1
    fi
done
