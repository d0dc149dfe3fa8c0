# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh

# Test tools that are Python packages, each with a requirements.txt that names all of them,
# with versions and hashes, in a virtual environment of its own. To be sourced after packages.sh.

# What it takes to install them: Python with its module venv.
wish_for_python() {
    wish python3 python3
    python3 -c 'import ensurepip, venv' 2>/dev/null || wish python3-venv python3-venv
}

# install_requirements FOLDER REQUIREMENTS: makes the environment unless it is there as required.
install_requirements() {
    ! cmp -s "$2" "$1/requirements.txt" || return 0
    rm -rf "$1"
    python3 -m venv "$1" &&
        "$1/bin/pip" install --quiet --disable-pip-version-check --retries 1 --require-hashes \
            --no-deps -r "$2" &&
        cp "$2" "$1/requirements.txt"
}

# prepare_python_packages FOLDER REQUIREMENTS: where that fails, tests do without.
prepare_python_packages() {
    ! cmp -s "$2" "$1/requirements.txt" || return 0
    echo "Installing Python packages in $1"
    if ! install_requirements "$@" >/dev/null 2>&1; then
        rm -rf "$1"
        echo "not available here, done without: $1"
    fi
}
