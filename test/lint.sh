#!/bin/sh
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# Checks the sources without running them: formatting, static analysis, and strict compilation for
# most targets of test/compile.sh. Runs all checks, then fails if any has found something.
#
#   test/lint.sh [--fix]       --fix first corrects the formatting of the files

set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=test/support/environment.sh
. "$root/test/support/environment.sh"

need clang-format clang-format
need clang-tidy clang-tidy
need cppcheck cppcheck
need gcc gcc
need shellcheck shellcheck
need_build_tools
need_drawing
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

# The files of this project, without those in build folders; also works without git.
find_files() {
    find . -name 'build*' -prune -o -name '.git' -prune -o -type f \( "$@" \) -print
}

# format OPTION…
format() {
    find_files -name '*.c' -o -name '*.h' -o -name '*.cpp' | xargs clang-format "$@"
}

# Checks the length of all lines except in documents, where a paragraph may be one line.
check_lengths() {
    found=0
    find_files \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.ino' -o -name '*.sh' \
        -o -name '*.cmake' -o -name 'CMakeLists.txt' -o -name '*.ld' -o -name '*.yml' \
        -o -name 'Kconfig*' -o -path './.ci/run' -o -path './.ci/release' \) |
        LC_ALL=C.UTF-8 xargs grep -nE '^.{101,}' && found=1
    find_files \( -name '*.py' -o -name '*.js' \) |
        LC_ALL=C.UTF-8 xargs grep -nE '^.{121,}' && found=1
    return "$found"
}

# tidy FILE… -- FLAG…: prints findings on standard output. The number of suppressed ones, on
# standard error, goes into a log.
tidy() {
    clang-tidy --quiet --header-filter="^$root/(lib|port|examples)/" "$@" 2>>build-lint/tidy.log
}

# Firmware is compiled as in its tests, with the stand-ins for its platforms. There, addresses of
# registers are integers converted to pointers.
tidy_firmware() {
    tidy --checks=-performance-no-int-to-ptr "$@" -std=c99 -I lib/include -I examples/common \
        -I examples/obstacle_stop
}

# Uses cmake's list of commands, and one process per processor.
tidy_programs() {
    quietly cmake -S . -B build-lint -DTMINI_BUILD_TESTS=OFF || return 1
    # shellcheck disable=SC2016 # expanded in the inner shell
    printf '%s\n' lib/src/*.c port/posix/*.c examples/host/*.c examples/obstacle_stop/*.c \
        examples/bridge/core/*.c examples/bridge/pc/*.c |
        xargs -n 8 -P "$(job_count)" sh -c \
            'exec clang-tidy --quiet -p build-lint --header-filter="$0" "$@" 2>/dev/null' \
            "^$root/(lib|port|examples)/"
}

check_tidy() {
    clean=0
    tidy_programs || clean=1
    tidy_firmware port/template/*.c examples/common/*.c -- -I port/template || clean=1
    tidy_firmware port/stm32/*.c examples/stm32_cube/*.c -- -I port/stm32 -I examples/stm32_cube \
        -isystem test/port/stm32/stm32_model -isystem test/support || clean=1
    tidy_firmware port/esp32/*.c examples/esp32_idf/main/*.c examples/bridge/main/main.c \
        examples/bridge/main/web.c -- -I port/esp32 -I port/posix -I examples/bridge/core \
        -isystem test/port/esp32/esp_idf || clean=1
    tidy_firmware port/pico/*.c examples/pico/*.c -- -I port/pico -D_DEFAULT_SOURCE \
        -isystem test/port/pico/sdk_stub || clean=1
    tidy_firmware port/zephyr/*.c examples/zephyr/src/*.c -- -I port/zephyr -DZEPHYR_ASYNC \
        -isystem test/port/zephyr/zephyr_stub || clean=1
    tidy_firmware port/freertos/*.c examples/freertos/*.c -- -I port/freertos -I examples/freertos \
        -isystem test/port/freertos/kernel_stub || clean=1
    tidy_firmware examples/stm32f405_baremetal/*.c -- -I port/stm32 || clean=1
    # In C++ unused parameters have no name. A positive number may be rounded by adding a half.
    tidy --checks=-readability-named-parameter,-bugprone-incorrect-roundings \
        port/arduino/*.cpp -- -std=c++11 -I lib/include -isystem test/port/arduino/arduino_stub \
        -DARDUINO=10819 -DESP32 -DESP_ARDUINO_VERSION_MAJOR=3 || clean=1
    tidy port/ros2/src/settings.cpp port/ros2/src/report.cpp port/ros2/src/lidar.cpp -- \
        -std=c++17 -I lib/include -I port/posix -I port/ros2/src || clean=1
    tidy_firmware port/ros2/src/*.c examples/micro_ros/*.c -- -I port/ros2/src \
        -isystem test/port/micro_ros/micro_ros_stub || clean=1
    return "$clean"
}

# Suppressed, because cppcheck
# - tries a configuration without any compiler's primitives, an intended #error;
# - assumes that the smaller of two values is always the same one of them;
# - does not find the users of structures' members and of private functions;
# - does not know the symbols that a linker script defines;
# - demands that constructors fill buffers;
# - criticises where a variable is declared, a matter of taste;
# - miscounts the arguments of formats made of macros, which compilers check better;
# - believes that a structure written through a pointer is read;
# - takes the library's headers for C++ where a C++ source includes them, and loops for algorithms;
# - reports, in newer versions, how thorough it was.
check_cppcheck() {
    cppcheck --quiet --std=c99 --enable=warning,style,performance,portability --inline-suppr \
        --suppress=preprocessorErrorDirective --suppress=knownConditionTrueFalse \
        --suppress=missingIncludeSystem --suppress=unusedStructMember \
        --suppress=unusedPrivateFunction --suppress=comparePointers \
        --suppress=uninitMemberVar --suppress=variableScope --suppress=badBitmaskCheck \
        --suppress=wrongPrintfScanfArgNum \
        --suppress=zerodivcond --suppress=ctuuninitvar \
        --suppress='cstyleCast:lib/*' --suppress=useStlAlgorithm \
        --suppress=normalCheckLevelMaxBranches --error-exitcode=1 \
        -I lib/include -I examples/common -I examples/obstacle_stop lib/src port examples
}

# Only the rules listed in test/misra.txt, each with a reason, may be broken.
check_misra() {
    broken=$(cppcheck --addon=misra --quiet --std=c99 --enable=style \
        --template='{id} {file}:{line}' --suppress=missingIncludeSystem \
        --suppress=preprocessorErrorDirective -D__GNUC__=12 -U__AVR__ \
        -UTMINI_ATOMIC_HEADER -I lib/include lib/src 2>&1 |
        sed -n 's/^misra-c2012-\([0-9.]*\) /\1 /p' | sort -u)
    [ -n "$broken" ] || { echo "cppcheck's MISRA addon says nothing at all"; return 1; }
    ! printf '%s\n' "$broken" | awk '
        FILENAME != "-" { if ($1 ~ /^[0-9]/) known[$1] = 1; next }
        !($1 in known) { print "rule " $1 ", not in test/misra.txt: " $2; found = 1 }
        END { exit !found }' test/misra.txt -
}

# analyse FLAG… FILE…: GCC's own analyser.
analyse() {
    gcc -std=c99 -O2 -fanalyzer -Werror -Ilib/include -Iexamples/common -Iexamples/obstacle_stop \
        -S -o /dev/null "$@"
}

# Firmware is compiled with the stand-ins, as above. In examples/host the analyser overlooks the
# only branch that closes a file, and believes that finding an existing entry may fail.
check_analyzer() {
    clean=0
    for source in lib/src/*.c port/posix/*.c port/template/*.c examples/common/*.c \
        examples/obstacle_stop/obstacle*.c; do
        analyse -Iport/template "$source" || clean=1
    done
    for source in examples/host/*.c; do
        # shellcheck disable=SC2046 # flags are several words
        analyse -Iport/posix $(pkg-config --cflags cairo) -Wno-analyzer-file-leak \
            -Wno-analyzer-malloc-leak -Wno-analyzer-null-dereference "$source" || clean=1
    done
    for source in port/stm32/*.c examples/stm32_cube/*.c; do
        analyse -Iport/stm32 -Iexamples/stm32_cube -isystem test/port/stm32/stm32_model \
            -isystem test/support "$source" ||
            clean=1
    done
    for source in port/esp32/*.c examples/esp32_idf/main/*.c; do
        analyse -Iport/esp32 -isystem test/port/esp32/esp_idf "$source" || clean=1
    done
    for source in port/pico/*.c examples/pico/*.c; do
        analyse -Iport/pico -D_DEFAULT_SOURCE -isystem test/port/pico/sdk_stub "$source" || clean=1
    done
    for source in port/zephyr/*.c examples/zephyr/src/*.c; do
        analyse -Iport/zephyr -DZEPHYR_ASYNC -isystem test/port/zephyr/zephyr_stub "$source" ||
            clean=1
    done
    for source in port/ros2/src/*.c; do
        analyse "$source" || clean=1
    done
    for source in port/freertos/*.c examples/freertos/*.c; do
        analyse -Iport/freertos -Iexamples/freertos -isystem test/port/freertos/kernel_stub \
            "$source" || clean=1
    done
    return "$clean"
}

check_scripts() {
    find_files -name '*.sh' -o -path './.ci/run' -o -path './.ci/release' | xargs shellcheck -x
}

# compile.sh reports a missing compiler, which is not a finding.
check_compile() {
    status=0
    test/compile.sh "$1" || status=$?
    [ "$status" -eq 0 ] || [ "$status" -eq 77 ]
}

[ "${1:-}" != --fix ] || format -i
check clang-format format --dry-run -Werror
check line-lengths check_lengths
check clang-tidy check_tidy
check cppcheck check_cppcheck
check misra check_misra
check gcc-analyzer check_analyzer
check shellcheck check_scripts
for target in gcc clang c++ cortex-m0 avr rv32imc powerpc; do
    check "compile.$target" check_compile "$target"
done

if [ -n "$failed" ]; then
    echo "Not clean:$failed"
    exit 1
fi
echo "All clean."
