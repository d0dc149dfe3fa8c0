# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh

# Finds what a script needs, and installs what is missing if Debian's package tools are available.
# To be sourced by POSIX shell scripts:
#
#   . "$root/test/support/packages.sh"
#   because "to build the library"         # the reason for what follows
#   need cmake cmake                       # a command, and the packages that bring it
#   need /usr/include/stdio.h libc6-dev    # or a file
#   wish clang clang                       # the same, but optional
#   install_missing
#
# install_missing says what it will install, and why; then it calls apt-get once for all, and fails
# if something needed is still missing. It does not touch the configured package sources. Only sudo
# may ask a question: for a password.

required_packages=
optional_packages=
required_checks=
reason=
announcement=
finders= # Functions to call once apt's package lists are up to date.
index_is_fresh=false

apt_options="-o DPkg::Lock::Timeout=300 -o APT::Install-Recommends=false"

# is_present COMMAND|FILE
is_present() {
    case $1 in
        /*) [ -e "$1" ] ;;
        *) command -v "$1" >/dev/null 2>&1 ;;
    esac
}

have_apt() {
    is_present apt-get
}

# is_settled COMMAND|FILE: nothing has to be installed for it. Paths of files are those of Debian's
# packages; on other systems the compiler will report what is missing.
is_settled() {
    is_present "$1" && return
    case $1 in
        /*) ! have_apt ;;
        *) false ;;
    esac
}

# because REASON
because() {
    reason=$1
}

# announce PACKAGE…: adds the packages to the line of the current reason.
announce() {
    case $announcement in
        *"
  $reason:"*) announcement="$announcement $*" ;;
        *)
            announcement="$announcement
  $reason: $*"
            ;;
    esac
}

# need COMMAND|FILE PACKAGE…
need() {
    is_settled "$1" && return
    required_checks="$required_checks $1"
    shift
    required_packages="$required_packages $*"
    announce "$@"
}

# wish COMMAND|FILE PACKAGE…
wish() {
    is_settled "$1" && return
    shift
    optional_packages="$optional_packages $*"
    announce "$@"
}

can_install() {
    have_apt && { [ "$(id -u)" -eq 0 ] || is_present sudo; }
}

# Without a terminal no one can answer: sudo must then work without a password.
as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@" </dev/null
    elif [ -t 0 ]; then
        sudo "$@"
    else
        sudo -n "$@" </dev/null
    fi
}

apt_get() {
    # shellcheck disable=SC2086 # the options are several words
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq $apt_options "$@"
}

# Runs a command silently; its output is shown if it fails.
quietly() {
    output=$("$@" 2>&1) && return
    printf '%s\n' "$output" >&2
    return 1
}

# Brings apt's package lists up to date, once; if that fails, the old ones may still do.
refresh_index() {
    $index_is_fresh && return
    index_is_fresh=true
    quietly apt_get update || echo "apt-get update failed; trying with the lists at hand" >&2
}

# is_available PACKAGE|FILE.deb
is_available() {
    case $1 in
        /*) [ -e "$1" ] ;;
        *) apt-cache show --no-all-versions "$1" >/dev/null 2>&1 ;;
    esac
}

# Reduces the optional packages to those that apt knows, and reports the others.
drop_unavailable() {
    available=
    for package in $optional_packages; do
        if is_available "$package"; then
            available="$available $package"
        else
            echo "not available here, done without: $package"
        fi
    done
    optional_packages=$available
}

# An optional package that fails must not prevent the installation of the required ones.
install_separately() {
    # shellcheck disable=SC2086
    [ -z "$required_packages" ] || quietly apt_get install -y $required_packages || return 1
    for package in $optional_packages; do
        quietly apt_get install -y "$package" || echo "not installed, done without: $package"
    done
}


install_with_apt() {
    how="apt-get installs it now"
    [ "$(id -u)" -eq 0 ] || how="$how, by sudo, which may ask for your password"
    echo "Missing here; $how:$announcement"
    refresh_index
    for finder in $finders; do
        "$finder" || true
    done
    drop_unavailable
    [ -n "$required_packages$optional_packages" ] || return 0
    # shellcheck disable=SC2086
    quietly apt_get install -y $required_packages $optional_packages || install_separately
}

# Succeeds if everything needed is present; otherwise reports what is missing.
check_required() {
    missing=
    for item in $required_checks; do
        is_present "$item" || missing="$missing $item"
    done
    [ -z "$missing" ] && return
    echo "Missing:$missing. Please install (names of Debian's packages):$required_packages" >&2
    return 1
}

install_missing() {
    if [ -z "$required_packages$optional_packages" ]; then
        return 0
    elif can_install; then
        install_with_apt || true
    elif [ -n "$optional_packages" ]; then
        echo "Not installed, done without:$optional_packages"
    fi
    check_required
}

need_build_tools() {
    because "to build the library and the tool"
    is_present cc || need gcc gcc
    need /usr/include/stdio.h libc6-dev
    need cmake cmake
    is_present ninja || need make make
}

need_drawing() {
    because "to draw with the tool's command plot"
    need pkg-config pkg-config
    need /usr/include/cairo/cairo.h libcairo2-dev
}
