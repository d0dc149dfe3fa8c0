# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh
# shellcheck disable=SC2154 # $root is the sourcing script's

# need_cmock: registers the package `cmock` (CMock with Unity) for install_missing. Source
# packages.sh first.
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

# Replaces the package's name by the file that was downloaded from the next release.
take_cmock_from_trixie() {
    cmock_dir=$(mktemp -d)
    chmod 755 "$cmock_dir" # apt reads it as its own user.
    download_from_trixie "$cmock_dir" cmock || return
    file=$(ls "$cmock_dir"/cmock_*.deb)
    required_packages=$(echo "$required_packages" | sed "s|\\<cmock\\>|$file|")
}

# Ubuntu has the package, but not in the component that is always there.
find_cmock() {
    if is_present "$cmock_script" || is_available cmock; then
        return
    elif system_name | grep -q '^ubuntu'; then
        echo "The package cmock is in Ubuntu's component \"universe\". Please add it:
sudo add-apt-repository universe && sudo apt-get update" >&2
    elif ! take_cmock_from_trixie; then
        echo "There is no package cmock here, and that of Debian 13 could not be had (why: above).
Please install CMock by hand and name its folder: CMOCK_ROOT=DIR test/run.sh" >&2
    fi
}

need_cmock() {
    if [ -z "${CMOCK_ROOT:-}" ] && can_install; then
        need "$cmock_script" cmock
        finders="$finders find_cmock"
    fi # Otherwise CMake downloads CMock.
}
