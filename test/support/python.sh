# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh

# Installs test tools that are Python packages. Each tool has its own virtual environment, and a
# requirements.txt with the versions and hashes of all packages. To be sourced after packages.sh.

# They are installed by Python and its module venv.
wish_for_python() {
    wish python3 python3
    python3 -c 'import ensurepip, venv' 2>/dev/null || wish python3-venv python3-venv
}

# install_requirements FOLDER REQUIREMENTS: makes the environment unless FOLDER already has it.
install_requirements() {
    ! cmp -s "$2" "$1/requirements.txt" || return 0
    rm -rf "$1"
    python3 -m venv "$1" &&
        "$1/bin/pip" install --quiet --disable-pip-version-check --retries 1 --require-hashes \
            --no-deps -r "$2" &&
        cp "$2" "$1/requirements.txt"
}

# prepare_python_packages FOLDER REQUIREMENTS: the same; if it fails, tests run without the tool.
prepare_python_packages() {
    ! cmp -s "$2" "$1/requirements.txt" || return 0
    echo "Installing Python packages in $1"
    if ! install_requirements "$@" >/dev/null 2>&1; then
        rm -rf "$1"
        echo "not available here, done without: $1"
    fi
}
