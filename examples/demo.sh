#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Shows the library at work, on any computer and without a lidar: builds the host tool, decodes a
# recording of a simulated lidar, and draws what it saw. Needs a C compiler and CMake, and installs
# them where they are missing.

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=examples/support/packages.sh
. "$root/examples/support/packages.sh"

need_build_tools
install_missing

build=$root/build-demo
tmini=$build/bin/tmini
recording=$root/test/recordings/sim-6hz.bin
picture=$build/room.png

echo "Building in $build …"
quietly cmake -S "$root" -B "$build" -DTMINI_BUILD_TESTS=OFF
quietly cmake --build "$build" --target tmini_tool --parallel 2

echo
echo "A recording of 2 s, decoded:"
"$tmini" decode "$recording"

"$tmini" plot "$recording" -o "$picture"
echo
echo "Its last complete scan as a picture: $picture"
