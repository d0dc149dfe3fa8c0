#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Tests the Python package as a user gets it: installs the source distribution in a separate
# environment in FOLDER, and tests it with the tool and the simulated lidar. Its extras are tested
# if their packages can be installed.
#
#   run.sh FOLDER TMINI TMINI_SIM [ARGUMENT OF PYTEST…]
#
# Exit status: pytest's, or 77 if Python's packages are not available.

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
if ! cmp -s "$here/extras.txt" "$folder/venv/extras.txt"; then
    "$python" -m pip install --quiet --disable-pip-version-check --retries 1 --require-hashes \
        --no-deps -r "$here/extras.txt" && cp "$here/extras.txt" "$folder/venv" ||
        echo "the extras' packages are not available: their tests are skipped"
fi
cd "$here"
# Four at a time, because they mostly wait for a lidar's motor. A test that hangs fails.
exec "$python" -m pytest -q -p no:cacheprovider -n 4 -o faulthandler_timeout=120 \
    -o faulthandler_exit_on_timeout=true "$@"
