#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Runs the tests with GCC's address and undefined-behaviour sanitizers, in build-sanitizers/; any
# finding fails its test. Options are passed to ctest. Left to the build without sanitizers: the
# explorer and other long runs of virtual lidars, whose short forms are here, a kernel at other tick
# rates, what takes its time because real time passes, and what builds anew.

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=test/support/environment.sh
. "$root/test/support/environment.sh"

need gcc gcc
need_test_tools
install_tools

cd "$root"
build_preset sanitizers
long='^(campaign|soak|stories\.all|explore\..*|test_ros_lidar|test_survey'
long="$long|test_port_freertos_.*|test_port_zephyr_3_2|arduino\.sketches|esp32\.component"
long="$long|host\.(bridge|calibrate|check|device)|host_without_cairo|host_share)\$"
exec ctest --preset sanitizers --parallel "$(job_count)" --exclude-regex "$long" "$@"
