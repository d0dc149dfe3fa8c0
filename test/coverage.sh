#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Measures the coverage of lib/ by the unit tests, in build-coverage/, and fails unless they reach
# every line and every branch. build-coverage/report/index.html shows the sources with the coverage.

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=test/support/environment.sh
. "$root/test/support/environment.sh"

# Counts the library, and the copies that tests of interrupts compile; not those of campaigns.
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
# Counts of earlier runs would hide lines that are no longer reached.
find build-coverage -name '*.gcda' -exec rm -f {} +
quietly ctest --preset coverage --parallel "$(job_count)"
report
