# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh

# Packages of Debian 13 (trixie) for Debian 12, which lacks them. They are fetched from the server
# of the machine's own packages, with a temporary configuration of apt: the machine's own stays as
# it is. To be sourced.

# Prints "ID CODENAME" of the system, such as "debian bookworm".
system_name() {
    # shellcheck disable=SC1091
    (. /etc/os-release 2>/dev/null && echo "${ID:-} ${VERSION_CODENAME:-}") || true
}

# apt_aside DIR …: apt-get with trixie's sources, and lists and caches in DIR.
apt_aside() {
    dir=$1
    shift
    apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$dir/sources" \
        -o Dir::State::Lists="$dir/lists" -o Dir::Cache="$dir/cache" \
        -o Acquire::Languages=none -o APT::Sandbox::User=root "$@" </dev/null
}

# download_from_trixie DIR PACKAGE…: into the folder DIR. The sources are the machine's, with
# trixie's suites in the place of bookworm's; addresses, keys and options are kept. What other
# servers do not have for trixie is done without.
download_from_trixie() {
    dir=$1
    shift
    mkdir -p "$dir/sources" "$dir/lists/partial" "$dir/cache/archives/partial"
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/*; do
        [ ! -f "$file" ] || sed 's/bookworm/trixie/g' "$file" >"$dir/sources/${file##*/}"
    done
    apt_aside "$dir" update >"$dir/log" 2>&1 || true
    if ! (cd "$dir" && apt_aside "$dir" download "$@" >>log 2>&1); then
        cat "$dir/log" >&2
        return 1
    fi
}
