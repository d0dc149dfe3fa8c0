#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Runs the README's two commands, examples/demo.sh and test/run.sh, on bare systems. Each system is
# made by debootstrap, from the mirror of this machine's own packages. It gets the release's source
# archive, in a folder whose name has spaces and accents. The user there is not root, but may use
# sudo. Prints a table.
#
#   test/qa/systems.sh [NAME …]    debian-12 debian-13 ubuntu-24.04 debian-12-i386; default: all
#
# Needs root, debootstrap, 12 GB of disk space, and a quarter of an hour per system. All files are
# in build-systems/. The logs are NAME.demo.log and NAME.tests.log. A system is deleted after its
# run; its packages are kept in cache/ for the next one.
# Exit status: 0 all green, 1 not, 2 wrong usage, 77 it cannot be done here.

set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
all_systems="debian-12 debian-13 ubuntu-24.04 debian-12-i386"
work=$root/build-systems
folder="/home/user/Ein Ordner mit Umläuten and spaces and a rather long name/tmini"
table=$work/table.md

usage() {
    sed -n '5,15s/^# \{0,1\}//p' "$0" >&2
    exit 2
}

# mirror_of debian|ubuntu: prints that system's address in the machine's package sources. If these
# name only the other system, prints the neighbouring folder: a mirror of one often has both.
mirror_of() {
    cat /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | sed -n '
        s/^URIs: *\([^ ]*\/\)\(debian\|ubuntu\)\/* *$/\1'"$1"'/p
        s/^deb \(\[.*\] \)\{0,1\}\([^ ]*\/\)\(debian\|ubuntu\)\/* .*/\2'"$1"'/p' | head -n 1
}

# describe NAME: sets the variables for debootstrap and apt.
describe() {
    architecture=amd64 components=main script="" personality=linux64
    mirror=$(mirror_of debian)
    case $1 in
        debian-12) suite=bookworm ;;
        debian-13) suite=trixie ;;
        debian-12-i386) suite=bookworm architecture=i386 personality=linux32 ;;
        ubuntu-24.04)
            # debootstrap uses this script for all Ubuntu releases since 2007.
            suite=noble components="main universe" script=gutsy
            mirror=$(mirror_of ubuntu)
            ;;
        *) usage ;;
    esac
}

# Without the distribution's keys here, the first packages cannot be verified; the system is deleted
# afterwards.
verification() {
    keys=/usr/share/keyrings/ubuntu-archive-keyring.gpg
    [ "$suite" != noble ] || [ -e "$keys" ] || echo --no-check-gpg
}

# make_system NAME: makes a minimal system with sudo and this machine's network settings.
make_system() {
    mkdir -p "$work/cache/$1"
    # shellcheck disable=SC2046 # one option or none
    debootstrap --variant=minbase --arch="$architecture" --cache-dir="$work/cache/$1" \
        --include=ca-certificates,sudo $(verification) "$suite" "$system" "$mirror" \
        ${script:+"/usr/share/debootstrap/scripts/$script"} || return 1
    for pocket in "$suite" "$suite-updates"; do
        echo "deb $mirror $pocket $components"
    done >"$system/etc/apt/sources.list"
    apt-config dump | grep '^Acquire::\(http\|Check\)' \
        >"$system/etc/apt/apt.conf.d/99machine" || true
    cp -L /etc/resolv.conf /etc/hosts "$system/etc/"
    cp /etc/ssl/certs/ca-certificates.crt "$system/etc/ssl/certs/"
    [ ! -e /etc/pip.conf ] || cp /etc/pip.conf "$system/etc/"
    chroot "$system" useradd --create-home user
    echo 'user ALL=(ALL) NOPASSWD: ALL' >"$system/etc/sudoers.d/user"
}

# Unpacks the release's source archive in the system.
unpack_project() {
    python3 -B "$root/.ci/pack.py" --allow-placeholder "$work/release" >/dev/null
    mkdir -p "$system$folder"
    tar xzf "$work"/release/*-source.tar.gz -C "$system$folder" --strip-components=1
    chroot "$system" chown -R user: /home/user
}

# as_user NAME COMMAND…: runs the command in the project's folder, with a login's environment and
# the network's settings. The mounts disappear with the last process.
as_user() {
    name=$1
    shift
    # shellcheck disable=SC2016 # expanded in the inner shell
    unshare --mount --propagation private sh -c '
        system=$1 cache=$2 personality=$3 folder=$4
        shift 4
        mount -t proc proc "$system/proc"
        mount --rbind /dev "$system/dev"
        mount --bind "$cache" "$system/var/cache/apt/archives"
        exec "$personality" chroot --userspec=user:user "$system" env -i \
            HOME=/home/user USER=user PATH=/usr/local/bin:/usr/bin:/bin \
            ${PIP_CERT:+"PIP_CERT=$PIP_CERT"} \
            sh -c '"'"'cd "$1" && shift && exec "$@"'"'"' sh "$folder" "$@"
    ' sh "$system" "$work/cache/$name/archives" "$personality" "$folder" "$@" </dev/null
}

# count STATUS LOG: prints the number of ctest's lines with this status.
count() {
    grep -c "^ *[0-9]*/[0-9]* Test *#.*$1" "$2" || true
}

# reasons NAME: prints the tests that failed, and why others were skipped.
reasons() {
    failed=$(sed -n 's/.* - \(.*\) (\(Failed\|Timeout\|Not Run\|SEGFAULT\)).*$/\1/p' \
        "$work/$1.tests.log" | head -n 8 | tr '\n' ' ')
    skipped=$(sed -n 's/^SKIPPED: /skipped: /; /^skipped: /p' "$work/$1.last.log" | sort -u |
        tr '\n' ';')
    [ -z "$failed" ] || printf 'failed: %s ' "$failed"
    printf '%s' "${skipped%;}"
}

# run_system NAME: runs both commands and adds a row to the table.
run_system() {
    describe "$1"
    system=$work/$1
    rm -rf "$system"
    mkdir -p "$work/cache/$1/archives/partial"
    begin=$(date +%s)
    if ! make_system "$1" >"$work/$1.make.log" 2>&1; then
        echo "| $1 | could not be made: $(tail -n 1 "$work/$1.make.log") | | | | | |" >>"$table"
        return 1
    fi
    unpack_project
    made=$(date +%s)
    demo=green tests=0
    as_user "$1" examples/demo.sh >"$work/$1.demo.log" 2>&1 || demo="**RED**"
    shown=$(date +%s)
    as_user "$1" test/run.sh >"$work/$1.tests.log" 2>&1 || tests=$?
    end=$(date +%s)
    # Only this log has the reasons why tests were skipped.
    : >"$work/$1.last.log"
    cp "$system$folder/build/Testing/Temporary/LastTest.log" "$work/$1.last.log" || true
    [ "$(grep -c '^Total Test time' "$work/$1.tests.log")" -eq 1 ] || tests=1
    echo "| $1 | $demo | $(count ' Passed ' "$work/$1.tests.log") |" \
        "$(count '\*\*\*\(Failed\|Timeout\|Not Run\|Exception\)' "$work/$1.tests.log") |" \
        "$(count '\*\*\*Skipped' "$work/$1.tests.log") | $(reasons "$1") |" \
        "$((made - begin)) + $((shown - made)) + $((end - shown)) s |" >>"$table"
    rm -rf "$system"
    [ "$demo" = green ] && [ "$tests" -eq 0 ]
}

[ "$(id -u)" -eq 0 ] || { echo "skipped: debootstrap needs root"; exit 77; }
command -v debootstrap >/dev/null || { echo "skipped: debootstrap is not installed"; exit 77; }
# shellcheck disable=SC2086 # several words
[ $# -gt 0 ] || set -- $all_systems
for name in "$@"; do
    describe "$name"
done

mkdir -p "$work"
{
    echo "| system | demo | passed | failed | skipped | why | made + demo + tests |"
    echo "|---|---|---:|---:|---:|---|---|"
} >"$table"
status=0
for name in "$@"; do
    echo "$name …"
    run_system "$name" || status=1
done
cat "$table"
exit "$status"
