#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Measures flash, RAM, stack and instructions of the library, prints the tables, and fails when a
# budget (budgets.txt) is exceeded:
#
#   test/qa/bench/run.sh [--update | --current]
#
# --update rewrites the tables in docs/footprint.md, README.md and its translation, --current fails
# if they have other figures. With other compilers than theirs, the budgets are a tenth higher.
# `test/run.sh --all bench` installs the tools.
# Exit status: 0 within the budgets, 1 not, 2 wrong usage, 77 a tool is missing.

set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
work=$root/build/bench
# shellcheck source=test/support/compilers.sh
. "$root/test/support/compilers.sh"
# shellcheck source=test/support/python.sh
. "$root/test/support/python.sh"

skip() {
    echo "skipped: $1"
    exit 77
}

for program in cc clang valgrind python3; do
    command -v "$program" >/dev/null || skip "$program is not installed"
done
need_compiler arm-none-eabi-gcc --specs=nano.specs
need_compiler riscv64-unknown-elf-gcc --specs=picolibc.specs

# The emulator gets a virtual environment of its own, the Python package that of its tests.
mkdir -p "$work"
install_requirements "$work/venv" "$root/test/qa/bench/requirements.txt" \
    >"$work/install.log" 2>&1 ||
    skip "the emulator cannot be installed; see $work/install.log"
install_requirements "$root/build/test/python/venv" "$root/test/python/requirements.txt" \
    >"$work/install.log" 2>&1 ||
    skip "what the Python package needs cannot be installed; see $work/install.log"

export PYTHONDONTWRITEBYTECODE=1
exec "$work/venv/bin/python" "$root/test/qa/bench/bench.py" "$work" "$@"
