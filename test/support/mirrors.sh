# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh

# Where this machine's own packages come from. To be sourced.

# mirror_of debian|ubuntu: prints the address for it in the machine's package sources. A mirror of
# Debian often has Ubuntu in the neighbouring folder, and vice versa: if the sources name only the
# other system, that folder is printed.
mirror_of() {
    cat /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | sed -n '
        s/^URIs: *\([^ ]*\/\)\(debian\|ubuntu\)\/* *$/\1'"$1"'/p
        s/^deb \(\[.*\] \)\{0,1\}\([^ ]*\/\)\(debian\|ubuntu\)\/* .*/\2'"$1"'/p' | head -n 1
}
