# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# cmake -D RUNNER=runner.c -P ShortenRunner.cmake
#
# Removes the tests' names from a runner. AVR copies strings to RAM, and names that are sentences
# would fill most of it. The line number in the report still identifies the test.

file(READ "${RUNNER}" text)
string(REGEX REPLACE
    "run_test\\(([a-zA-Z0-9_]+), \"[^\"]*\", "
    "run_test(\\1, \"\", " text "${text}")
file(WRITE "${RUNNER}" "${text}")
