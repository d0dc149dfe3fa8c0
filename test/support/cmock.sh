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
    if download_from_trixie "$cmock_dir" cmock; then
        file=$(ls "$cmock_dir"/cmock_*.deb)
        required_packages=$(echo "$required_packages" | sed "s|\\<cmock\\>|$file|")
        return
    fi
    cat >&2 <<'END'
This Debian has no package cmock, and that of the next release could not be had from the machine's
own package sources (why: above). Please install CMock by hand and name its folder:
CMOCK_ROOT=DIR test/run.sh
END
}

is_ubuntu() {
    grep -q '^ID=ubuntu' "${OS_RELEASE:-/etc/os-release}" 2>/dev/null
}

# Ubuntu has the package, but not in the component that is always there.
ask_for_universe() {
    cat >&2 <<'END'
The package cmock is in Ubuntu's component "universe", which this computer does not use. Please
add it:
sudo add-apt-repository universe && sudo apt-get update
END
}

find_cmock() {
    if is_present "$cmock_script" || is_available cmock; then
        return
    elif is_ubuntu; then
        ask_for_universe
    else
        take_cmock_from_trixie
    fi
}

need_cmock() {
    if [ -z "${CMOCK_ROOT:-}" ] && can_install; then
        need "$cmock_script" cmock
        finders="$finders find_cmock"
    fi # Otherwise CMake downloads CMock.
}
