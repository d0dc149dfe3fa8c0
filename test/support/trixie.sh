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

# The same for a file with one source per line: deb [options] URI bookworm main …
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

# download_from_trixie DIR PACKAGE…: into the folder DIR.
download_from_trixie() {
    dir=$1
    shift
    mkdir -p "$dir/sources" "$dir/lists/partial" "$dir/cache/archives/partial"
    write_trixie_sources "$dir/sources"
    apt_aside "$dir" update >"$dir/log" 2>&1 || true
    if ! (cd "$dir" && apt_aside "$dir" download "$@" >>log 2>&1); then
        cat "$dir/log" >&2
        return 1
    fi
}
