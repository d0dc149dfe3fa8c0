#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Measures flash, RAM, stack and instructions of the library, prints the tables, and fails when a
# budget (budgets.txt) is exceeded:
#
#   test/qa/bench/run.sh [--update] [--no-install]
#
# --update rewrites the tables in docs/footprint.md and README.md. With other compilers than those
# of these tables, the budgets are a tenth higher. Installs missing tools, unless --no-install is
# given. Exit status: 0 within the budgets, 1 not, 2 wrong usage, 77 a tool is missing.

set -eu

root=$(cd "$(dirname "$0")/../../.." && pwd)
work=$root/build/bench
python=$work/venv/bin/python
# shellcheck source=test/support/environment.sh
. "$root/test/support/environment.sh"
# shellcheck source=test/support/python.sh
. "$root/test/support/python.sh"

install=yes update=
for word in "$@"; do
    case $word in
        --no-install) install=no ;;
        --update) update=--update ;;
        *)
            sed -n '5,13s/^# \{0,1\}//p' "$0"
            exit 2
            ;;
    esac
done

skip() {
    echo "skipped: $1"
    exit 77
}

wish_for_bench_tools() {
    wish cc gcc
    wish python3 python3
    python3 -c 'import ensurepip' 2>/dev/null || wish python3-venv python3-venv
    wish arm-none-eabi-gcc gcc-arm-none-eabi
    wish /usr/lib/arm-none-eabi/newlib libnewlib-arm-none-eabi
    wish riscv64-unknown-elf-gcc gcc-riscv64-unknown-elf
    wish /usr/lib/picolibc/riscv64-unknown-elf picolibc-riscv64-unknown-elf
    wish clang clang
    wish valgrind valgrind
    install_missing
}

# has_library COMPILER OPTION…: succeeds if the compiler finds its C library's headers.
has_library() {
    command -v "$1" >/dev/null && echo '#include <string.h>' | "$@" -E - >/dev/null 2>&1
}

[ "$install" = no ] || wish_for_bench_tools
is_present cc || skip "there is no C compiler"
is_present clang || skip "Clang is not installed"
is_present valgrind || skip "valgrind is not installed"
is_present python3 || skip "Python 3 is not installed"
has_library arm-none-eabi-gcc --specs=nano.specs ||
    skip "arm-none-eabi-gcc or newlib is not installed"
has_library riscv64-unknown-elf-gcc --specs=picolibc.specs ||
    skip "riscv64-unknown-elf-gcc or picolibc is not installed"

# The emulator gets a virtual environment of its own, the Python package that of its tests.
mkdir -p "$work"
install_requirements "$work/venv" "$root/test/qa/bench/requirements.txt" \
    >"$work/install.log" 2>&1 ||
    skip "the emulator cannot be installed; see $work/install.log"
install_requirements "$root/build/test/python/venv" "$root/test/python/requirements.txt" \
    >"$work/install.log" 2>&1 ||
    skip "what the Python package needs cannot be installed; see $work/install.log"

# shellcheck disable=SC2086 # $update is one word or none
export PYTHONDONTWRITEBYTECODE=1
exec "$python" "$root/test/qa/bench/bench.py" "$work" $update
