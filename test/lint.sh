#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Reads the sources without running them: formatting, static analysis, and strict compilation for
# each target of test/compile.sh. Does all checks, then fails if any has found something.
#
#   test/lint.sh [--fix]       --fix puts the formatting right in place first

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=test/support/environment.sh
. "$root/test/support/environment.sh"

need clang-format clang-format
need clang-tidy clang-tidy
need cppcheck cppcheck
need shellcheck shellcheck
need_build_tools
install_tools

cd "$root"
failed=

# check NAME COMMAND…
check() {
    name=$1
    shift
    if "$@"; then
        echo "clean: $name"
    else
        echo "NOT CLEAN: $name"
        failed="$failed $name"
    fi
}

# The files of this project, not those of its build folders; also without git.
find_files() {
    find . -name 'build*' -prune -o -name '.git' -prune -o -type f \( "$@" \) -print
}

# format OPTION…
format() {
    find_files -name '*.c' -o -name '*.h' -o -name '*.cpp' | xargs clang-format "$@"
}

check_tidy() {
    quietly cmake -S . -B build-lint -DTMINI_BUILD_TESTS=OFF -DTMINI_BUILD_EXAMPLES=OFF || return 1
    # Findings are on standard output, the count of what was suppressed on the other.
    clang-tidy -p build-lint --quiet lib/src/*.c 2>build-lint/tidy.log && return
    grep 'error:' build-lint/tidy.log >&2
    return 1
}

# Suppressed: cppcheck tries a configuration without any compiler's primitives, which is an #error by
# design; it takes the smaller of two values for equal to one of them; it sees no users of structures'
# members; and its newer versions tell how thorough they are.
check_cppcheck() {
    cppcheck --quiet --std=c99 --enable=warning,style,performance,portability --inline-suppr \
        --suppress=preprocessorErrorDirective --suppress=knownConditionTrueFalse \
        --suppress=missingIncludeSystem --suppress=unusedStructMember \
        --suppress=normalCheckLevelMaxBranches --error-exitcode=1 \
        -I lib/include lib/src
}

check_scripts() {
    find_files -name '*.sh' -o -path './.ci/run' | xargs shellcheck -x
}

# An absent compiler is said by compile.sh, and is no finding.
check_compile() {
    status=0
    test/compile.sh "$1" || status=$?
    [ "$status" -eq 0 ] || [ "$status" -eq 77 ]
}

[ "${1:-}" != --fix ] || format -i
check clang-format format --dry-run -Werror
check clang-tidy check_tidy
check cppcheck check_cppcheck
check shellcheck check_scripts
for target in gcc clang c++ cortex-m0 avr rv32imc powerpc; do
    check "compile.$target" check_compile "$target"
done

if [ -n "$failed" ]; then
    echo "Not clean:$failed"
    exit 1
fi
echo "All clean."
