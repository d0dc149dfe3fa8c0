#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The Python package as a user gets it: the source distribution, installed in an environment of its
# own in FOLDER, tried against the tool and the simulated lidar.
#
#   run.sh FOLDER TMINI TMINI_SIM [ARGUMENT OF PYTEST…]
#
# Exit status: pytest's, or 77 when Python's packages are not to be had here.

set -eu

folder=$1
export TMINI_TOOL="$2" TMINI_SIM="$3" PYTHONDONTWRITEBYTECODE=1
shift 3
here=$(cd "$(dirname "$0")" && pwd)
python=$folder/venv/bin/python

skip() {
    echo "SKIPPED: $1"
    exit 77
}

install() {
    "$python" -m pip install --quiet --disable-pip-version-check --retries 1 "$@"
}

python3 -c 'import ensurepip, venv' 2>/dev/null || skip "python3-venv is not installed"
if ! "$python" -c 'import build, cffi, numpy, pytest, serial, wheel' 2>/dev/null; then
    rm -rf "$folder/venv"
    python3 -m venv "$folder/venv"
    install --upgrade build cffi numpy pyserial pytest setuptools wheel ||
        skip "Python's packages cannot be installed here"
fi
rm -rf "$folder/dist"
"$python" -m build --quiet --sdist --no-isolation --outdir "$folder/dist" "$here/../../port/python"
install --force-reinstall --no-deps --no-build-isolation "$folder"/dist/tmini-*.tar.gz
cd "$here"
exec "$python" -m pytest -q -p no:cacheprovider "$@"
