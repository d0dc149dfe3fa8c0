# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh

# The servers of this machine's own packages. To be sourced.

# mirror_of debian|ubuntu: prints that system's address in the machine's package sources. If these
# name only the other system, prints the neighbouring folder: a mirror of one often has both.
mirror_of() {
    cat /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | sed -n '
        s/^URIs: *\([^ ]*\/\)\(debian\|ubuntu\)\/* *$/\1'"$1"'/p
        s/^deb \(\[.*\] \)\{0,1\}\([^ ]*\/\)\(debian\|ubuntu\)\/* .*/\2'"$1"'/p' | head -n 1
}
