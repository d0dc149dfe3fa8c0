# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh
# shellcheck disable=SC2154 # $root is the sourcing script's

# need_cmock: the package `cmock` (CMock with Unity), to be installed by install_missing of
# packages.sh, which is to be sourced first.
#
# Debian 12 does not have it, but the package of the next release is architecture-independent and
# runs there.

cmock_script=/usr/share/cmock/lib/cmock.rb

# shellcheck source=test/support/trixie.sh
. "$root/test/support/trixie.sh"

cmock_dir=

remove_cmock_download() {
    [ -z "$cmock_dir" ] || rm -rf "$cmock_dir"
}

need_cmock_from_trixie() {
    cmock_dir=$(mktemp -d)
    chmod 755 "$cmock_dir" # apt reads it as a user of its own.
    if download_from_trixie "$cmock_dir" cmock; then
        need "$cmock_script" "$(ls "$cmock_dir"/cmock_*.deb)"
        return
    fi
    remove_cmock_download
    cat >&2 <<'EOF'
This Debian has no package cmock, and that of the next release could not be had from the machine's
own package sources (why: above). Please install CMock by hand and name its folder:
CMOCK_ROOT=DIR test/run.sh
EOF
    return 1
}

need_cmock() {
    if [ -n "${CMOCK_ROOT:-}" ] || is_present "$cmock_script" || ! can_install; then
        return 0 # What cannot be installed here, CMake downloads.
    fi
    refresh_index
    if is_available cmock; then
        need "$cmock_script" cmock
    elif [ "$(system_name)" = "debian bookworm" ]; then
        need_cmock_from_trixie
    fi
}
