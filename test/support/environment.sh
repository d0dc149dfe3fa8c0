# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh
# shellcheck disable=SC2154 # $root is the sourcing script's

# Shared by the scripts in test/. To be sourced with $root set to the project's folder.

# shellcheck source=test/support/packages.sh
. "$root/test/support/packages.sh"
# shellcheck source=test/support/cmock.sh
. "$root/test/support/cmock.sh"

need_test_tools() {
    need_build_tools
    because "to build the tests in less time"
    wish ninja ninja-build
    because "to generate the unit tests' mocks and main functions"
    need ruby ruby
    need_cmock
    because "to test the tool as a person uses it"
    need python3 python3
    for module in pytest pexpect pyte; do
        need "/usr/lib/python3/dist-packages/$module" "python3-$module"
    done
}

install_tools() {
    status=0
    install_missing || status=$?
    remove_cmock_download
    ! is_present ninja || export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"
    return "$status"
}

job_count() {
    nproc 2>/dev/null || echo 2
}

# Configures and builds a preset; its output is shown only if it fails.
build_preset() {
    quietly cmake --preset "$1"
    quietly cmake --build --preset "$1" --parallel "$(job_count)"
}
