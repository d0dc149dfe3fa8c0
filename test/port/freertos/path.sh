#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The example is told where the kernel is after it has been configured in vain:
#
#   path.sh CMAKE

set -eu

example=$(cd "$(dirname "$0")/../../../examples/freertos" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
: >"$work/this_computer.cmake"

# missing KERNEL: succeeds if the example complains that it does not know the kernel.
missing() {
    FREERTOS_KERNEL_PATH=$1 "$cmake" -S "$example" -B "$work/build" \
        -D CMAKE_TOOLCHAIN_FILE="$work/this_computer.cmake" >"$work/log" 2>&1 || true
    grep -q "Set FREERTOS_KERNEL_PATH" "$work/log"
}

cmake=$1
mkdir -p "$work/kernel/include"
: >"$work/kernel/include/FreeRTOS.h"
missing "" || { echo "no kernel, and no complaint" && exit 1; }
! missing "$work/kernel" || { cat "$work/log" && exit 1; }
