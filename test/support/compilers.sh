# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh

# What scripts ask of compilers. To be sourced.

# need_compiler COMPILER FLAG…: skips the test if it is not installed, or its C library is missing,
# which for some targets is a separate package.
need_compiler() {
    if ! command -v "$1" >/dev/null; then
        echo "skipped: $1 is not installed"
        exit 77
    fi
    if ! echo '#include <string.h>' | "$@" -E - >/dev/null 2>&1; then
        echo "skipped: $1 finds no C library"
        exit 77
    fi
}

# headers_of GCC FLAG…: the folder of its C library's headers, which Clang does not find.
headers_of() {
    echo '#include <string.h>' | "$@" -E - 2>/dev/null |
        sed -n 's|^# 1 "\(.*\)/string\.h".*|\1|p' | head -n 1
}
