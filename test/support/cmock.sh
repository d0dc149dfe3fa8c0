# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh

# need_cmock: the package `cmock` (CMock with Unity), to be installed by install_missing of
# packages.sh, which is to be sourced first.
#
# Debian 12 does not have it, but the package of the next release is architecture-independent and
# runs there. It is fetched from where the machine gets its own packages, through a configuration of
# apt that exists for this one download: the machine's own stays as it is.

cmock_script=/usr/share/cmock/lib/cmock.rb

# Prints "ID CODENAME" of the system, such as "debian bookworm".
system_name() {
    # shellcheck disable=SC1091
    (. /etc/os-release 2>/dev/null && echo "${ID:-} ${VERSION_CODENAME:-}") || true
}

# Prints the stanzas of a deb822 file that name the suite bookworm, with trixie in its place.
# All else in them is kept: addresses, keys, options.
convert_deb822() {
    awk '
        function flush() {
            if (types && main && suite && !disabled) print stanza "\n"
            stanza = ""; types = main = suite = disabled = 0
        }
        /^[ \t]*$/ { flush(); next }
        /^#/ { next }
        tolower($1) == "types:" { types = / deb( |$)/; $0 = "Types: deb" }
        tolower($1) == "components:" { main = / main( |$)/; $0 = "Components: main" }
        tolower($1) == "suites:" { suite = / bookworm( |$)/; $0 = "Suites: trixie" }
        tolower($1) == "enabled:" { disabled = tolower($2) == "no" }
        { stanza = stanza $0 "\n" }
        END { flush() }
    ' "$1"
}

# The same for a file with one source a line: deb [options] URI bookworm main …
convert_one_line() {
    sed -n 's/^[ \t]*deb[ \t]\(.*\)[ \t]bookworm[ \t].*\bmain\b.*$/deb \1 trixie main/p' "$1"
}

# Writes trixie counterparts of the machine's bookworm sources into the folder $1.
write_trixie_sources() {
    number=0
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/*; do
        number=$((number + 1))
        case $file in
            *.sources) convert_deb822 "$file" >"$1/$number.sources" ;;
            *.list) [ ! -e "$file" ] || convert_one_line "$file" >"$1/$number.list" ;;
        esac
    done
}

# apt_aside DIR …: apt-get with trixie's sources, and lists and caches in DIR.
apt_aside() {
    dir=$1
    shift
    apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$dir/sources" \
        -o Dir::State::Lists="$dir/lists" -o Dir::Cache="$dir/cache" \
        -o Acquire::Languages=none -o APT::Sandbox::User=root "$@" </dev/null
}

# Prints the path of trixie's cmock package, downloaded into the folder $1.
download_cmock() {
    mkdir -p "$1/sources" "$1/lists/partial" "$1/cache/archives/partial"
    write_trixie_sources "$1/sources"
    apt_aside "$1" update >"$1/log" 2>&1 || true
    if ! (cd "$1" && apt_aside "$1" download cmock >>log 2>&1); then
        cat "$1/log" >&2
        return 1
    fi
    ls "$1"/cmock_*.deb
}

cmock_dir=

remove_cmock_download() {
    [ -z "$cmock_dir" ] || rm -rf "$cmock_dir"
}

need_cmock_from_trixie() {
    cmock_dir=$(mktemp -d)
    chmod 755 "$cmock_dir" # apt reads it as a user of its own.
    if package=$(download_cmock "$cmock_dir"); then
        need "$cmock_script" "$package"
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
