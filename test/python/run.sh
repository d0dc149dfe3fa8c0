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

sdist=$("$here/sdist.sh" "$folder") || {
    status=$?
    echo "$sdist"
    exit "$status"
}
"$python" -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps \
    --no-build-isolation "$sdist"
cd "$here"
exec "$python" -m pytest -q -p no:cacheprovider "$@"
