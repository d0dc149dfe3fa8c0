#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Builds the firmware and runs it:  run.sh LABWIRED_FOLDER TMINI_SIM WORK_FOLDER
# Exit status: 0 no difference found, 1 differences, 77 compiler or simulator is not installed.

set -eu

python=$1/bin/python
lidar=$2
work=$3
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../../..
compiler=riscv64-unknown-elf-gcc

if ! command -v "$compiler" >/dev/null; then
    echo "skipped: $compiler is not installed"
    exit 77
fi
if ! "$python" -c 'import labwired' 2>/dev/null; then
    echo "skipped: no Python package labwired in $1 (test/run.sh installs it)"
    exit 77
fi

# GCC 12 needs the extension zicsr for the CSR instructions, but finds no C library built with that
# name. In edition 2.2 of the instruction set (-misa-spec) they are part of the base set.
"$compiler" --specs=picolibc.specs -march=rv32imc -misa-spec=2.2 -mabi=ilp32 \
    -std=c99 -Os -ffunction-sections -fdata-sections -Wall -Wextra -Wconversion -Werror -DEMULATED \
    -I "$root/lib/include" "$here/board.c" "$here/main.c" "$root"/lib/src/*.c \
    -nostartfiles -Wl,--gc-sections -T "$here/esp32c3.ld" -o "$work/esp32c3.elf"
riscv64-unknown-elf-size "$work/esp32c3.elf"
exec "$python" "$here/run.py" "$work/esp32c3.elf" "$lidar"
