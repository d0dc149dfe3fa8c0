# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh

# The simulator labwired, a Python package that models microcontrollers down to their registers, in a
# virtual environment of its own. To be sourced behind examples/support/packages.sh.

labwired_version=0.25.0

# What it takes to install it: Python with its module venv.
wish_for_labwired() {
    wish python3 python3
    python3 -c 'import ensurepip, venv' 2>/dev/null || wish python3-venv python3-venv
}

# have_labwired FOLDER
have_labwired() {
    [ -x "$1/bin/python" ] && [ "$("$1/bin/python" -c \
        'import importlib.metadata as m, labwired; print(m.version("labwired"))' 2>/dev/null)" = \
        "$labwired_version" ]
}

create_labwired() {
    rm -rf "$1"
    python3 -m venv "$1" &&
        "$1/bin/pip" install --quiet --disable-pip-version-check --retries 1 \
            "labwired==$labwired_version"
}

# prepare_labwired FOLDER: installs it there unless it is there; where that fails, tests do without.
prepare_labwired() {
    have_labwired "$1" && return
    echo "Installing: labwired $labwired_version (in $1)"
    if ! (create_labwired "$1") >/dev/null 2>&1 || ! have_labwired "$1"; then
        rm -rf "$1"
        echo "not available here, done without: labwired $labwired_version"
    fi
}
