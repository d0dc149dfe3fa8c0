#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Makes the Python package's source distribution in FOLDER/dist, with the tools of requirements.txt
# in FOLDER/venv, and prints its name.
#
#   sdist.sh FOLDER
#
# Exit status: 0 made, 1 not, 77 if Python's packages are not available.

set -eu

folder=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=test/support/python.sh
. "$root/test/support/python.sh"

skip() {
    echo "SKIPPED: $1"
    exit 77
}

python3 -c 'import ensurepip, venv' 2>/dev/null || skip "python3-venv is not installed"
install_requirements "$folder/venv" "$root/test/python/requirements.txt" >&2 ||
    skip "Python's packages cannot be installed here"
rm -rf "$folder/dist"
"$folder/venv/bin/python" -m build --quiet --sdist --no-isolation --outdir "$folder/dist" \
    "$root/port/python" >&2
echo "$folder"/dist/tmini-*.tar.gz
