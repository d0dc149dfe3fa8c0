#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Measures how much of lib/ the unit tests reach, in build-coverage/, and fails unless that is every
# line and every branch. build-coverage/report/index.html shows the sources with what was reached.

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=test/support/environment.sh
. "$root/test/support/environment.sh"

# The library as it is, and as tests of its races build it; campaigns have copies of their own.
report() {
    mkdir -p build-coverage/report
    gcovr --root "$root" --filter lib/ --exclude-throw-branches \
        --html-details build-coverage/report/index.html \
        --txt --print-summary --fail-under-line 100 --fail-under-branch 100 \
        build-coverage/lib build-coverage/test/unit
}

need gcc gcc
need gcovr gcovr
need_test_tools
install_tools

cd "$root"
build_preset coverage
# Counts of earlier runs would hide what is no longer reached.
find build-coverage -name '*.gcda' -exec rm -f {} +
quietly ctest --preset coverage --parallel "$(job_count)"
report
