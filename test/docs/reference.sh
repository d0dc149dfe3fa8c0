#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Checks that every public symbol is documented: doxygen reads the headers of the library and of
# the ports without a warning. Writes the reference to the given folder:
#
#   test/docs/reference.sh [FOLDER]

set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
folder=${1:-$root/build-reference}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

command -v doxygen >/dev/null || { echo "SKIPPED: doxygen is not installed"; exit 77; }

rm -rf "$folder/html"
cd "$root"
complaints=$({
    cat docs/Doxyfile
    echo "OUTPUT_DIRECTORY = \"$folder\""
} | doxygen - 2>&1) || true
if [ -n "$complaints" ]; then
    printf '%s\n' "$complaints"
    exit 1
fi

# Check that doxygen has read the headers: without them, there would be no warning either.
for symbol in tmini_poll tmini_ranges_of_scan tmini_stm32_hal_start TMiniLidar; do
    grep -qr "$symbol" "$folder/html" || { echo "not in the reference: $symbol"; exit 1; }
done
echo "every public symbol is documented"
