#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Shows the library at work on any computer, without a lidar: builds the host tool and a simulated
# lidar, connects them by a pseudo-terminal as by a serial port, and draws the room. Needs a C
# compiler, CMake and cairo, and installs them if they are missing.

set -eu

if [ $# -gt 0 ]; then
    sed -n '5,7s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=test/support/packages.sh
. "$root/test/support/packages.sh"

need_build_tools
need_drawing
install_missing

build=$root/build-demo
tmini=$build/bin/tmini

bold="" dim="" plain=""
if [ -t 1 ] && [ -z "${NO_COLOR:-}" ]; then
    bold=$(printf '\033[1m') dim=$(printf '\033[2m') plain=$(printf '\033[0m')
fi

# say TEXT: prints what comes next.
say() {
    printf '\n%s\n' "$bold$*$plain"
}

# show COMMAND…: runs one of the tool's commands, and shows it as a user would type it.
show() {
    printf '%s\n' "$dim\$ tmini $*$plain"
    "$tmini" "$@"
}

# Starts the simulated lidar; its first line of output names the port. It ends if there is none.
start_lidar() {
    "$build/bin/tmini-sim" --pty >"$build/lidar.port" &
    lidar=$!
    trap 'kill "$lidar" 2>/dev/null || true' EXIT
    trap 'exit 1' INT TERM HUP PIPE
    while kill -0 "$lidar" 2>/dev/null; do
        port=$(head -n 1 "$build/lidar.port")
        [ -z "$port" ] || return 0
        sleep 0.1
    done
    wait "$lidar" || [ $? -eq 1 ] || exit 1 # 1: an error that it has reported.
    return 1
}

# Runs the commands that need a lidar on a port.
show_live() {
    echo "A simulated T-mini Plus in a simulated room is on $port."

    say "Which lidar is it, and is it well?"
    show info -p "$port"
    show health -p "$port"

    say "Live scans, while its motor comes up to speed"
    show scan -p "$port" -n 6

    say "Two seconds of raw bytes, recorded and decoded"
    show record -p "$port" "$build/room.bin" --seconds 2 --quiet
}

# Some containers have no pseudo-terminals (no /dev/pts).
show_without_port() {
    echo "There are no pseudo-terminals here: no live part."
    echo "The simulated lidar writes a recording instead."
    "$build/bin/tmini-sim" --write "$build/room.bin" --seconds 4 >/dev/null
}

say "Building in $build"
quietly cmake -S "$root" -B "$build" -DTMINI_BUILD_TESTS=OFF
quietly cmake --build "$build" --target tmini_tool tmini-sim --parallel 2
if start_lidar; then
    show_live
else
    show_without_port
fi
show decode "$build/room.bin"

say "The last complete scan as a picture"
show plot "$build/room.bin" -o "$build/room.png"

say "The picture: $build/room.png"
echo "The tool is $tmini. With a lidar of your own, try: $tmini view -p /dev/ttyUSB0"
