#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Checks what the documents claim, as far as a machine can: the README's program compiles, and every
# link to a file of the project leads somewhere.

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
cd "$root"
failed=

# The first block of C in a document.
first_program() {
    awk '/^```c$/ { inside = 1; next } /^```$/ { if (inside) exit } inside' "$1"
}

check_program() {
    first_program "$1" | grep -q tmini_poll || { echo "$1: no program found"; failed=1; return; }
    first_program "$1" | ${CC:-cc} -std=c99 -Wall -Wextra -Werror -fsyntax-only -Ilib/include \
        -include test/support/readme_board.h -x c - || { echo "$1: does not compile"; failed=1; }
}

# Targets of [text](target) that are not on the web, without #fragments.
links() {
    grep -o '](\([^)]*\))' "$1" | sed 's/^](//; s/)$//; s/#.*//' | grep -v '^[a-z]*:' || true
}

check_links() {
    for link in $(links "$1"); do
        [ -e "$(dirname "$1")/$link" ] || { echo "$1: no such file: $link"; failed=1; }
    done
}

check_program README.md
documents=$(find . -name 'build*' -prune -o -name '*.md' -print) # No name has a blank.
for document in $documents; do
    check_links "$document"
done
[ -z "$failed" ] || exit 1
echo "documents are in order"
