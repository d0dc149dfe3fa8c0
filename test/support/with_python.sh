#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Runs a Python script in a virtual environment that test/run.sh has made (python.sh):
#
#   with_python.sh ENVIRONMENT MODULE SCRIPT ARGUMENT…
#
# Exit status: the script's, or 77 when the environment lacks the module.

set -eu

python=$1/bin/python module=$2
shift 2
if ! "$python" -c "import $module" 2>/dev/null; then
    echo "skipped: no Python package with $module (test/run.sh installs it where that can be done)"
    exit 77
fi
exec "$python" "$@"
