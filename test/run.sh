#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Installs what the tests need, builds in build/ and runs tests:
#
#   test/run.sh                 the short run: minutes
#   test/run.sh --all           the long run: also installs a browser, and compilers and emulators
#                               for other machines
#   test/run.sh [--all] LABEL … all tests with these labels; builds only what they need
#   test/run.sh … -- OPTION …   passes options to ctest, for example -R ring
#
# test/CMakeLists.txt lists the labels. Tests whose tools are missing are skipped and reported.

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=test/support/environment.sh
. "$root/test/support/environment.sh"

all=no labels=
while [ $# -gt 0 ]; do
    case $1 in
        --all) all=yes ;;
        --)
            shift
            break
            ;;
        -*)
            sed -n '5,13s/^# \{0,1\}//p' "$0" >&2
            exit 2
            ;;
        *) labels="$labels $1" ;;
    esac
    shift
done

need_test_tools
need_drawing
if [ "$all" = yes ]; then
    # shellcheck source=test/support/optional.sh
    . "$root/test/support/optional.sh"
    wish_for_everything
fi
install_tools
if [ "$all" = yes ]; then
    # Downloads, while the tests are built.
    prepare_everything &
fi

# targets: prints the build targets.
targets() {
    if [ -n "$labels" ]; then
        # shellcheck disable=SC2086 # labels are several words
        printf 'tests-%s\n' $labels
    elif [ "$all" = yes ]; then
        echo tests-all
    else
        echo tests
    fi
}

# check_labels: ends the script if a label does not exist.
check_labels() {
    known=$(ctest --test-dir "$root/build" -C All --print-labels | sed -n 's/^  //p')
    for label in $labels; do
        if ! echo "$known" | grep -qx -- "$label"; then
            # shellcheck disable=SC2086 # the labels fit on a line
            echo "no such label: $label. There are:" $known >&2
            exit 2
        fi
    done
}

# Output is shown only if a step fails.
echo "Building in $root/build"
quietly cmake -S "$root" -B "$root/build" -DTMINI_BUILD_TESTS=ON \
    -DTMINI_BUILD_EXAMPLES=ON -DTMINI_WERROR=ON -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
check_labels
# shellcheck disable=SC2046 # targets are several words
quietly cmake --build "$root/build" --parallel "$(job_count)" --target $(targets)
wait

cd "$root/build"
if [ -n "$labels" ]; then
    set -- -L "^($(echo "${labels# }" | tr ' ' '|'))\$" "$@"
fi
if [ "$all" = yes ] || [ -n "$labels" ]; then
    set -- -C All "$@"
fi
# One more than there are cores, because many tests mostly wait.
exec ctest --output-on-failure --no-tests=error --parallel "$(($(job_count) + 1))" "$@"
