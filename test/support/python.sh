# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors
# shellcheck shell=sh
# shellcheck disable=SC2034 # the packages' names are for the sourcing script

# Test tools that are Python packages, each in a virtual environment of its own. To be sourced
# after packages.sh.

# Models microcontrollers down to their registers.
labwired_packages="labwired==0.25.0"

# PlatformIO's core, and the build tool that it would otherwise download.
platformio_packages="platformio==6.2.0 scons==4.11.1"

# Packs components for ESP-IDF.
component_packages="idf-component-manager==3.1.2"

# What it takes to install them: Python with its module venv.
wish_for_python() {
    wish python3 python3
    python3 -c 'import ensurepip, venv' 2>/dev/null || wish python3-venv python3-venv
}

# have_python_packages FOLDER NAME==VERSION…
have_python_packages() {
    python=$1/bin/python
    shift
    [ -x "$python" ] && "$python" - "$@" <<'EOF' 2>/dev/null
import importlib.metadata, sys
for wanted in sys.argv[1:]:
    name, version = wanted.split("==")
    if importlib.metadata.version(name) != version:
        sys.exit(1)
EOF
}

# create_python_environment FOLDER NAME==VERSION…
create_python_environment() {
    folder=$1
    shift
    rm -rf "$folder"
    python3 -m venv "$folder" &&
        "$folder/bin/pip" install --quiet --disable-pip-version-check --retries 1 "$@"
}

# prepare_python_packages FOLDER NAME==VERSION…: installs them there unless they are there; where
# that fails, tests do without.
prepare_python_packages() {
    have_python_packages "$@" && return
    echo "Installing Python packages in $*"
    if ! (create_python_environment "$@") >/dev/null 2>&1 || ! have_python_packages "$@"; then
        rm -rf "$1"
        echo "not available here, done without: $*"
    fi
}
