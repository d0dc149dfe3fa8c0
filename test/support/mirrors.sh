# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh

# Where this machine's own packages come from. To be sourced.

# mirror_of debian|ubuntu: prints the address that the machine's package sources name for it. A
# mirror of the one often has the other beside it, which is where it is looked for on a machine of
# the other kind.
mirror_of() {
    cat /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | sed -n '
        s/^URIs: *\([^ ]*\/\)\(debian\|ubuntu\)\/* *$/\1'"$1"'/p
        s/^deb \(\[.*\] \)\{0,1\}\([^ ]*\/\)\(debian\|ubuntu\)\/* .*/\2'"$1"'/p' | head -n 1
}
