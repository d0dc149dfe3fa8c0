# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D RUNNER=runner.c -P ShortenRunner.cmake
#
# Empties the tests' names in a runner. Where strings are copied to RAM (AVR), names that are
# sentences would need most of it; the line number in the report still shows which test it is.

file(READ "${RUNNER}" text)
string(REGEX REPLACE
    "run_test\\(([a-zA-Z0-9_]+), \"[^\"]*\", "
    "run_test(\\1, \"\", " text "${text}")
file(WRITE "${RUNNER}" "${text}")
